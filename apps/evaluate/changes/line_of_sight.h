#pragma once

#include "mapping/base/math/math.h"
#include "mapping/render/ray_scene.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::apps::changes {

/// From where one can look at what in a world whose joints are at 0. Map frame, metres.
class LineOfSight {
 public:
  LineOfSight(const mapping::World& world, const mapping::MeshSearch& search, Warnings& warnings);

  /// No wall stands between two places, and walls stand around the second.
  bool in_room(const Vector3d& from, const Vector3d& to) const;
  /// Whether a camera of the room has a free line of sight to 30 cm above a point.
  bool sees(const Vector3d& camera, const Vector3d& target) const;
  bool free_line(const Vector3d& from, const Vector3d& to) const;
  /// How far one falls from a point; infinity where nothing is below.
  double height_above_ground(const Vector3d& point) const;

 private:
  mapping::RayScene scene_;
};

}  // namespace loci::apps::changes
