#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/simulation/scenario.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Pose and appearance of an object between two actions.
struct PlacedObject {
  std::string support;  ///< a link of the world, or another object
  Isometry3d support_from_object = Isometry3d::Identity();
  Rgba color = Rgba::Ones();
  std::optional<Rgba> accent;
};

/// The world at one scene.
struct WorldState {
  JointState joints;
  std::map<std::string, PlacedObject> objects;  ///< those that are in the world
};

/// Of a link's visual geometry, in the link's frame; empty where it has none. Warns of meshes that are
/// missing.
Eigen::AlignedBox3d bounds_of_link(const Link& link, const MeshSearch& search, Warnings& warnings);

/// Middle of the top of a link's visual geometry, in the link's frame, and how far it reaches from there.
struct SupportTop {
  Vector3d centre = Vector3d::Zero();
  Vector2d half = Vector2d::Zero();
};
/// Nothing for a link that has no shape. Warns of meshes that are missing.
std::optional<SupportTop> top_of_link(const Link& link, const MeshSearch& search, Warnings& warnings);

/// Where objects lie in a drawer whose front is `link`, in the link's frame: on the level surface behind its
/// front where its shapes have one; else on a bottom at the front's lower edge, as deep as the drawer opens.
/// `out`: unit, in the link's frame. Nothing for a link that has no shape or is solid.
std::optional<SupportTop> inside_of_drawer(const Link& link, const Vector3d& out, double travel,
                                           const MeshSearch& search, Warnings& warnings);

/// Plays a scenario without rendering: the state at every scene. Error with the action's location for links
/// and joints that the world does not have, joints moved beyond their limits, objects beside their support,
/// and objects that are asked to move before they are there.
class ScenarioPlay {
 public:
  ScenarioPlay(const Scenario& scenario, const World& world, const MeshSearch& search);

  const std::vector<WorldState>& states() const { return states_; }
  const std::map<std::string, ObjectModel>& models() const { return models_; }

  /// Poses of all objects in the world, in the map frame.
  std::map<std::string, Isometry3d> map_from_objects(const WorldState& state) const;

 private:
  void apply(const Action& action, WorldState& state);
  void place_object(const Action& action, WorldState& state);
  void move_joint(const Action& action, WorldState& state) const;
  std::string resolve_support(const Action& action, const WorldState& state) const;
  std::string resolve_joint(const Action& action) const;
  SupportTop known_top(const std::string& link);
  SupportTop inside(const Action& action, const std::string& front, const Joint& slide) const;
  const Joint* slide_of(const std::string& link) const;
  void require_room(const Action& action, const std::string& support, double bottom, double height) const;
  Isometry3d placed(const Action& action, const std::string& support, const WorldState& state);

  const Scenario& scenario_;
  const World& world_;
  MeshSearch search_;
  std::map<std::string, ObjectModel> models_;
  std::map<std::string, SupportTop> tops_;
  std::vector<Isometry3d> map_from_closed_;  ///< by link
  std::vector<WorldState> states_;
};

}  // namespace loci::mapping
