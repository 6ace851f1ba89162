#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/changes/line_of_sight.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/polygon.h"
#include "mapping/base/math/random.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::apps::update_claim {

/// Furniture of a world that can be moved: links of one family ("island" with its cabinets) and what hangs
/// on them.
struct Group {
  std::string name;
  std::vector<std::string> branches;   ///< links that are fixed to the room
  std::vector<std::string> links;      ///< all of them
  std::string shape;                   ///< equal for groups that look the same
  double period = 2 * kPi;             ///< after a turn by so much (radians) it looks the same; 0: round
  Vector3d centre = Vector3d::Zero();  ///< of its bounding box, world frame
  Isometry3d map_from_group = Isometry3d::Identity();

  /// Error of a turn that is off by `error`, in degrees; unset where the yaw cannot be measured.
  std::optional<double> turn_error_deg(const Isometry3d& error) const;
};

/// A group and its motion in the world frame.
struct Move {
  size_t group = 0;
  Isometry3d now_from_before = Isometry3d::Identity();
};

/// How far furniture is moved.
struct MoveLimits {
  double min_m = 0.1, max_m = 3;
  double max_turn = 45 * kDegree;  ///< radians
};

/// Finds groups and draws motions that leave all furniture free of collision and inside the room.
class MovableWorld {
 public:
  /// `families`: beginnings of link names.
  MovableWorld(mapping::World world, const mapping::MeshSearch& search,
               const std::vector<std::string>& families, Warnings& warnings);

  const std::vector<Group>& groups() const { return groups_; }
  /// Up to `count` moves (log-uniform) with turns; fewer where the room is too full.
  std::vector<Move> draw(size_t count, Random& random, const MoveLimits& limits = {}) const;
  const changes::LineOfSight& sight() const { return sight_; }
  mapping::World moved(const std::vector<Move>& moves) const;
  /// How many points lie on a group at its pose after a motion (within 2 cm of its boxes).
  size_t points_on(size_t group, const Isometry3d& now_from_before,
                   const std::vector<Vector3d>& points) const;

 private:
  /// The footprint of a visual.
  struct Prism {
    Polygon hull;
    double low = 0, high = 0;
    int group = -1;
  };
  /// Whether a group looks the same after a turn about its centre.
  bool looks_same(size_t group, double turn) const;
  bool collides(size_t group, const Isometry3d& motion, const std::vector<Isometry3d>& others) const;

  mapping::World world_;
  std::vector<Group> groups_;
  std::vector<Prism> prisms_;
  changes::LineOfSight sight_;
};

}  // namespace loci::apps::update_claim
