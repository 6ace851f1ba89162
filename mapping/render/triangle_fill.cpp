#include "mapping/render/triangle_fill.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "mapping/base/math/vectorised.h"

namespace loci::mapping::render_detail {

using Eigen::Vector3d;

namespace {

// What is marked so becomes part of fill() and is compiled for the same processors as it.
#define LOCI_PART_OF_FILL [[gnu::always_inline]] inline

constexpr int kSmallWidth = 8;  ///< triangles at most this wide are tested pixel by pixel
constexpr int kLanes = 4;       ///< pixels of a row at a time

using Lanes [[gnu::vector_size(kLanes * sizeof(double))]] = double;
using Mask [[gnu::vector_size(kLanes * sizeof(int64_t))]] = int64_t;
using Floats [[gnu::vector_size(kLanes * sizeof(float))]] = float;
using Ints [[gnu::vector_size(kLanes * sizeof(int32_t))]] = int32_t;

}  // namespace

/// A·u + B·v + C over pixel offsets from the principal point. Evaluated by the same operations wherever a
/// pixel is, so that two triangles that share an edge get exactly opposite values for it: that is what makes
/// surfaces watertight.
struct TriangleFill::Edge {
  double a, b, c;
  double
      limit;  ///< inside means value > limit: 0, or the number just below it where the edge itself is owned

  Edge(const Vector3d& from, const Vector3d& to, double sign)
      : a(sign * (from.y() * to.z() - from.z() * to.y())),
        b(sign * (from.z() * to.x() - from.x() * to.z())),
        c(sign * (from.x() * to.y() - from.y() * to.x())),
        limit(a > 0 || (a == 0 && b > 0) ? -std::numeric_limits<double>::denorm_min() : 0) {}
};

/// 1/z over the image. Within a triangle it lies between those of its corners; slivers, whose plane is
/// badly determined, are held to that.
struct TriangleFill::Plane {
  double a, b, c;
  double low, high;
  bool clipped;
  uint64_t id;

  /// `scale`: one over the determinant, with the edges' sign.
  Plane(const Edge* edges, double scale, const PlacedTriangle& triangle)
      : a((edges[0].a + edges[1].a + edges[2].a) * scale),
        b((edges[0].b + edges[1].b + edges[2].b) * scale),
        c((edges[0].c + edges[1].c + edges[2].c) * scale),
        low(triangle.w_low),
        high(triangle.w_high),
        clipped(triangle.clipped),
        id(triangle.id) {}
};

/// Whether the pixel shows the triangle now.
LOCI_PART_OF_FILL bool TriangleFill::write(const Plane& plane, double row_w, int u, float* inverse_depth,
                                           uint64_t* id) const {
  double w = plane.a * (u - camera_.cx) + row_w;
  if (plane.clipped) {
    if (!(w >= w_far_ && w <= w_near_)) return false;
  } else {
    w = std::min(std::max(w, plane.low), plane.high);
    if (w < w_far_) return false;
  }
  const float value = static_cast<float>(w);
  const bool nearer = value > inverse_depth[u] || (value == inverse_depth[u] && plane.id < id[u]);
  if (!nearer) return false;
  inverse_depth[u] = value;
  id[u] = plane.id;
  return true;
}

/// As write(), for kLanes pixels of a triangle before the near plane, from `u` on.
LOCI_PART_OF_FILL bool TriangleFill::write_lanes(const Plane& plane, double row_w, int u,
                                                 float* inverse_depth, uint64_t* id) const {
  const Lanes steps = {0, 1, 2, 3};
  Lanes w = plane.a * (u + steps - camera_.cx) + row_w;
  w = w < plane.low ? plane.low + Lanes{} : w;
  w = w > plane.high ? plane.high + Lanes{} : w;
  const Floats value = __builtin_convertvector(w, Floats);
  Floats drawn;
  Mask ids;
  std::memcpy(&drawn, inverse_depth, sizeof drawn);
  std::memcpy(&ids, id, sizeof ids);
  const auto own = static_cast<int64_t>(plane.id);
  const Mask above = __builtin_convertvector(value > drawn, Mask);
  const Mask level = __builtin_convertvector(value == drawn, Mask);
  const Mask nearer = (w >= w_far_) & (above | (level & (own < ids)));
  if ((nearer[0] | nearer[1] | nearer[2] | nearer[3]) == 0) return false;
  drawn = __builtin_convertvector(nearer, Ints) ? value : drawn;
  ids = nearer ? own + Mask{} : ids;
  std::memcpy(inverse_depth, &drawn, sizeof drawn);
  std::memcpy(id, &ids, sizeof ids);
  return true;
}

LOCI_PART_OF_FILL bool TriangleFill::fill_small(const Edge* e, double determinant,
                                                const PlacedTriangle& triangle, const PixelBox& box) {
  // Most small triangles cover no pixel's centre: what only those need that do is found out when one does.
  std::optional<Plane> plane;
  bool written = false;
  const Lanes steps = {0, 1, 2, 3};
  for (int row = box.v_first; row <= box.v_last; ++row) {
    const double v = row - camera_.cy;
    const double r0 = e[0].b * v + e[0].c, r1 = e[1].b * v + e[1].c, r2 = e[2].b * v + e[2].c;
    float* inverse_depth = raster_.inverse_depth.data() + static_cast<ptrdiff_t>(row) * camera_.width;
    uint64_t* id = raster_.id.data() + static_cast<ptrdiff_t>(row) * camera_.width;
    for (int column = box.u_first; column <= box.u_last; column += kLanes) {
      const Lanes u = column + steps - camera_.cx;
      const Mask inside =
          (e[0].a * u + r0 > e[0].limit) & (e[1].a * u + r1 > e[1].limit) & (e[2].a * u + r2 > e[2].limit);
      if ((inside[0] | inside[1] | inside[2] | inside[3]) == 0) continue;
      if (!plane) plane.emplace(e, 1 / determinant, triangle);
      const double row_w = plane->b * v + plane->c;
      for (int i = 0; i < kLanes && column + i <= box.u_last; ++i)
        if (inside[i]) written |= write(*plane, row_w, column + i, inverse_depth, id);
    }
  }
  return written;
}

/// Narrows [first, last] to the pixels of a row that are inside an edge. The division only guesses; the
/// edge function, which rounding leaves monotonic, decides.
LOCI_PART_OF_FILL void TriangleFill::narrow(const Edge& edge, double row_value, int& first, int& last) const {
  const auto inside = [&](int u) { return edge.a * (u - camera_.cx) + row_value > edge.limit; };
  if (edge.a == 0) {
    if (!(row_value > edge.limit)) last = first - 1;
    return;
  }
  const double guess = camera_.cx - row_value / edge.a;
  if (edge.a > 0) {
    int u = first_pixel(guess, first, last);
    while (u > first && inside(u - 1)) --u;
    while (u <= last && !inside(u)) ++u;
    first = u;
  } else {
    int u = last_pixel(guess, first, last);
    while (u < last && inside(u + 1)) ++u;
    while (u >= first && !inside(u)) --u;
    last = u;
  }
}

LOCI_PART_OF_FILL bool TriangleFill::fill_spans(const Edge* edges, const Plane& plane, const PixelBox& box) {
  bool written = false;
  for (int row = box.v_first; row <= box.v_last; ++row) {
    const double v = row - camera_.cy;
    int first = box.u_first, last = box.u_last;
    for (int i = 0; i < 3 && first <= last; ++i) narrow(edges[i], edges[i].b * v + edges[i].c, first, last);
    float* inverse_depth = raster_.inverse_depth.data() + static_cast<ptrdiff_t>(row) * camera_.width;
    uint64_t* id = raster_.id.data() + static_cast<ptrdiff_t>(row) * camera_.width;
    const double row_w = plane.b * v + plane.c;
    int u = first;
    for (; !plane.clipped && u + kLanes <= last + 1; u += kLanes)
      written |= write_lanes(plane, row_w, u, inverse_depth + u, id + u);
    for (; u <= last; ++u) written |= write(plane, row_w, u, inverse_depth, id);
  }
  return written;
}

LOCI_VECTORISED
bool TriangleFill::fill(const PlacedTriangle& triangle, const PixelBox& box) {
  const Vector3d &p0 = triangle.corners[0], &p1 = triangle.corners[1], &p2 = triangle.corners[2];
  const double determinant = p0.dot(p1.cross(p2));
  if (determinant == 0 || !std::isfinite(determinant)) return false;
  const double sign = determinant < 0 ? -1 : 1;
  const Edge edges[3] = {Edge(p1, p2, sign), Edge(p2, p0, sign), Edge(p0, p1, sign)};
  if (box.u_last - box.u_first < kSmallWidth) return fill_small(edges, sign * determinant, triangle, box);
  return fill_spans(edges, Plane(edges, sign / determinant, triangle), box);
}

}  // namespace loci::mapping::render_detail
