#include "mapping/render/placed_vertices.h"

#include "mapping/base/math/vectorised.h"

namespace loci::mapping::render_detail {
namespace {

constexpr double kSlack = 1e-6;    // pixels
constexpr int32_t kBig = 1 << 24;  // larger than any image

inline double held(double value, double limit) {
  value = value > -2 ? value : -2;
  return value < limit ? value : limit;
}

}  // namespace

LOCI_VECTORISED
void place_vertices(const float* x, const float* y, const float* z, size_t count,
                    const Projection& projection, PlacedVertices& placed) {
  const auto& m = projection.m;
  const double cx = projection.cx, cy = projection.cy;
  const double u_limit = projection.u_limit, v_limit = projection.v_limit;
  int32_t u_first[Cluster::kVertices], u_last[Cluster::kVertices];
  int32_t v_first[Cluster::kVertices], v_last[Cluster::kVertices];
  for (size_t i = 0; i < count; ++i) {
    const double a = static_cast<double>(x[i]), b = static_cast<double>(y[i]), c = static_cast<double>(z[i]);
    const double px = m[0][0] * a + m[0][1] * b + m[0][2] * c + m[0][3];
    const double py = m[1][0] * a + m[1][1] * b + m[1][2] * c + m[1][3];
    const double pz = m[2][0] * a + m[2][1] * b + m[2][2] * c + m[2][3];
    const double w = 1 / pz;
    placed.x[i] = px;
    placed.y[i] = py;
    placed.z[i] = pz;
    placed.w[i] = w;
    const double u = held(px * w + cx, u_limit), v = held(py * w + cy, v_limit);
    // A conversion rounds positive numbers down: big - int(big - x) is the smallest integer from x on.
    u_first[i] = kBig - static_cast<int32_t>(kBig - (u - kSlack));
    u_last[i] = static_cast<int32_t>(kBig + (u + kSlack)) - kBig;
    v_first[i] = kBig - static_cast<int32_t>(kBig - (v - kSlack));
    v_last[i] = static_cast<int32_t>(kBig + (v + kSlack)) - kBig;
  }
  for (size_t i = 0; i < count; ++i)
    placed.reach[i] = PixelReach{static_cast<int16_t>(u_first[i]), static_cast<int16_t>(-u_last[i]),
                                 static_cast<int16_t>(v_first[i]), static_cast<int16_t>(-v_last[i])};
}

}  // namespace loci::mapping::render_detail
