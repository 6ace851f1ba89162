#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/time.h"
#include "mapping/render/render.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::perception {

/// A robot that may be in view, and how its joints stood.
struct KnownRobot {
  struct Row {
    TimeNs time_ns = 0;
    JointState joints;  ///< all that were named until then
  };

  mapping::World world;
  size_t part = 0;        ///< in KnownMap::scene
  std::vector<Row> rows;  ///< in order of time

  /// The latest state that is not later; the first one before that; joints at 0 without any.
  JointState joints_at(TimeNs time) const;

  /// Rows from a file as recordings have it (time_ns,joint,position), or without the column of times.
  static std::vector<Row> read_joints(const std::filesystem::path& path, const mapping::World& world);
};

/// A surface of the map on which objects may stand.
struct SupportSurface {
  /// The box of which it is the bottom.
  struct Drawer {
    std::string joint;
    double height_m = 0;  ///< of the front's upper edge over the bottom
  };

  std::string link;
  std::string class_name;
  size_t link_id = 0;  ///< in KnownMap::scene
  /// Frame of the place: origin at the centre of the surface, z up, x and y those of the link where its z is
  /// up.
  Isometry3d link_from_top = Isometry3d::Identity();
  std::vector<Vector2d> outline;  ///< counter-clockwise, in that frame, metres; goes round corners
  std::optional<Drawer> drawer;
};

/// The map that a recording is perceived against: world, sidecar, and its triangles ready to be drawn. A
/// resource of the pipeline.
struct KnownMap {
  std::filesystem::path path;
  mapping::World world;
  mapping::SemanticMap semantics;
  mapping::MeshSearch meshes;
  mapping::RenderScene scene;
  size_t part = 0;
  std::vector<KnownRobot> robots;

  /// Reads a URDF and, where there is one, its sidecar.
  static std::shared_ptr<KnownMap> load(const std::filesystem::path& urdf,
                                        const std::vector<std::filesystem::path>& package_paths,
                                        Warnings& warnings);
  static std::shared_ptr<KnownMap> make(mapping::World world, mapping::SemanticMap semantics,
                                        mapping::MeshSearch meshes, Warnings& warnings);

  /// Only robots are known: a world without anything to be seen.
  static std::shared_ptr<KnownMap> robots_only(Warnings& warnings);
  bool has_geometry() const;

  /// Adds a robot to the scene; it is drawn where place_robots() puts it.
  void add_robot(const std::filesystem::path& urdf, const std::filesystem::path& joints,
                 const std::vector<std::filesystem::path>& package_paths, Warnings& warnings);
  /// Puts robots where they are at a time. One that has the link `camera_link` (its frame the optical one:
  /// z ahead, y down) is where the depth camera says; the others stand at the map's origin. Joints that
  /// `joints` names go before those of the robot's file.
  void place_robots(TimeNs time, const JointState& joints, const std::string& camera_link,
                    const Isometry3d& map_from_camera);
  void hide_robots();
  /// Whether a robot has a joint of this name.
  bool robot_has_joint(const std::string& joint) const;

  /// From the sidecar; without an entry there, the name without its numbers: "drawer_3_bottom" is a
  /// "drawer_bottom".
  std::string class_of(const std::string& link) const;

  /// The surfaces of links whose name or class matches one of the patterns (* and ?), with their joints at 0.
  std::vector<SupportSurface> support_surfaces(const std::vector<std::string>& patterns) const;
};

}  // namespace loci::perception
