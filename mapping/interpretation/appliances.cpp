#include "mapping/interpretation/appliances.h"

#include <vector>

#include "mapping/base/quantile.h"

namespace loci::mapping {
namespace {

constexpr size_t kMin = 50;  // rays

/// Whether the front returns much less light than the rest of its face.
bool dark(const FaceRect& rect, const FaceRays& rays) {
  constexpr double kDark = 0.4;  // of the rest
  std::vector<float> own, rest;
  for (const FaceRay& ray : rays.rays) {
    if (!ray.returned || std::abs(ray.depth) > static_cast<float>(kFaceRelief)) continue;
    const bool inside = rect.contains(static_cast<double>(ray.u), static_cast<double>(ray.v), -0.02);
    (inside ? own : rest).push_back(ray.look[0]);
  }
  return own.size() > kMin && rest.size() > kMin &&
         static_cast<double>(median(own)) < kDark * static_cast<double>(median(rest));
}

bool between(double value, double low, double high) {
  return value >= low && value <= high;
}

}  // namespace

std::string appliance_of(const Front& front, const FaceRect& rect, const FaceRays& rays) {
  const bool handle = front.fixture && front.fixture->kind == Fixture::Kind::handle;
  const bool upright = handle && std::abs(front.fixture->axis.z()) > 0.9;
  if (between(front.width, 0.52, 0.66) && between(front.height, 0.35, 0.65) && !upright && dark(rect, rays))
    return "oven";
  if (upright && front.fixture->length > 0.3 && between(front.width, 0.45, 0.95) &&
      between(front.height, 0.8, 2.0) && rect.v1 > 1.3)
    return "fridge";
  return {};
}

}  // namespace loci::mapping
