#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "mapping/base/pose.h"

namespace loci::nbv {

/// A rectangle on the floor along the map's axes, or all of it: what an exploration keeps to.
class FloorRegion {
 public:
  FloorRegion() = default;
  /// "x0,y0,x1,y1" in metres, any two opposite corners; empty text = everywhere. Error for anything else.
  explicit FloorRegion(const std::string& text);

  bool contains(const Vector2d& point) const { return !box_ || box_->contains(point); }
  bool everywhere() const { return !box_; }

 private:
  std::optional<Eigen::AlignedBox2d> box_;
};

}  // namespace loci::nbv
