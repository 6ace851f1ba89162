#include "memory/annotators/known_planes.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

constexpr double kSameHeight = 0.04;  ///< metres: pose drift and tilt of a plane that is seen in part
constexpr double kGap = 0.15;         ///< metres between parts of one surface

}  // namespace

std::string KnownPlanes::name(const std::vector<Vector3d>& outline) {
  KnownPlane seen;
  if (outline.empty()) throw Error("a supporting plane has no outline");
  seen.low = seen.high = outline.front().head<2>();
  for (const Vector3d& corner : outline) {
    seen.low = seen.low.cwiseMin(corner.head<2>());
    seen.high = seen.high.cwiseMax(corner.head<2>());
    seen.height += corner.z() / static_cast<double>(outline.size());
  }
  KnownPlane* best = nullptr;
  double best_overlap = 0;
  for (KnownPlane& plane : planes_) {
    if (std::abs(plane.height - seen.height) > kSameHeight) continue;
    const Vector2d overlap =
        plane.high.cwiseMin(seen.high) - plane.low.cwiseMax(seen.low) + Vector2d(kGap, kGap);
    if ((overlap.array() <= 0).any() || overlap.prod() <= best_overlap) continue;
    best_overlap = overlap.prod();
    best = &plane;
  }
  if (best == nullptr) {
    seen.name = "plane_" + std::to_string(planes_.size() + 1);
    planes_.push_back(seen);
    return seen.name;
  }
  best->low = best->low.cwiseMin(seen.low);
  best->high = best->high.cwiseMax(seen.high);
  return best->name;
}

Json KnownPlanes::to_json() const {
  Json json = Json::array();
  for (const KnownPlane& plane : planes_)
    json.push_back({{"name", plane.name},
                    {"height", plane.height},
                    {"low", {plane.low.x(), plane.low.y()}},
                    {"high", {plane.high.x(), plane.high.y()}}});
  return json;
}

KnownPlanes KnownPlanes::from_json(const Json& json) {
  KnownPlanes known;
  const auto corner = [](const Json& values) {
    return Vector2d(values.at(0).get<double>(), values.at(1).get<double>());
  };
  for (const Json& plane : json)
    known.planes_.push_back({plane.at("name").get<std::string>(), plane.at("height").get<double>(),
                             corner(plane.at("low")), corner(plane.at("high"))});
  return known;
}

}  // namespace loci::memory
