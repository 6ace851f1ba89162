#pragma once

#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::memory {

/// A surface found without a map that was seen before.
struct KnownPlane {
  std::string name;
  double height = 0;                ///< of its middle, metres
  Vector2d low = Vector2d::Zero();  ///< extent of all that was seen of it, map frame
  Vector2d high = Vector2d::Zero();
};

/// Gives surfaces that are found frame by frame names that stay: plane_1, plane_2, … A surface is a known one
/// when it has its height and overlaps it (or nearly: the view may have jumped over a part).
class KnownPlanes {
 public:
  /// The name of a surface with this outline (map frame), which the known one grows by; a new one if needed.
  std::string name(const std::vector<Vector3d>& outline);

  const std::vector<KnownPlane>& planes() const { return planes_; }
  Json to_json() const;
  static KnownPlanes from_json(const Json& json);

 private:
  std::vector<KnownPlane> planes_;
};

}  // namespace loci::memory
