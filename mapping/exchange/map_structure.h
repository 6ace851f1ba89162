#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "mapping/world/furniture.h"
#include "mapping/world/mesh.h"
#include "mapping/world/semantic_map.h"

namespace loci::mapping {

/// A horizontal surface of a map or of a truth.
struct SurfacePatch {
  std::string name;
  std::string class_name;                       ///< empty where unknown
  std::string region;                           ///< of a truth that has regions
  double height = 0;                            ///< metres
  std::vector<std::vector<Vector2d>> polygons;  ///< their union is the patch; metres, map frame
  bool main = true;  ///< a mapper should find it; the others may be found without being wrong
};

/// A rectangle of a vertical plane: normal · p = offset.
struct WallPatch {
  std::string name;
  std::string region;
  Vector3d normal = Vector3d::UnitX();  ///< into the room
  double offset = 0;
  double along_min = 0, along_max = 0;  ///< along (-normal.y, normal.x)
  double bottom = 0, top = 0;
  bool main = true;
};

/// A handle or knob.
struct KnownFixture {
  std::string name;
  std::string region;
  std::string front;  ///< name of the KnownFront that it opens; empty where unknown
  Fixture fixture;
  bool main = true;
  double tolerance = 0;  ///< by which a truth itself may be off, metres
};

/// A furniture front, with its joint where it moves. Its fixture is among the structure's fixtures.
struct KnownFront {
  std::string name;  ///< of the link
  std::string region;
  Front front;
  bool main = true;
};

/// What a comparison looks at.
struct MapStructure {
  std::string source;  ///< "sidecar", "geometry of the URDF", "truth.json"
  std::vector<SurfacePatch> supports;
  std::vector<WallPatch> walls;
  /// Doorways and windows of the walls, with the front's class "doorway" or "window" and its normal into the
  /// room; unset where the source is silent about them.
  std::optional<std::vector<KnownFront>> openings;
  std::vector<KnownFront> fronts;
  std::vector<KnownFixture> fixtures;
  std::optional<double> floor_height;
  std::optional<Isometry3d> map_from_input;  ///< of a sidecar
  bool only_listed_faces =
      false;  ///< of a truth that lists some faces' fronts and is silent about the others
  std::map<std::string, Eigen::AlignedBox3d> regions;  ///< where they are, of a truth that says so
};

/// Reads a URDF (its sidecar where there is one, otherwise the upward and the vertical faces of its visual
/// geometry, all joints at 0), a JSON file with `support_surfaces`, `walls`, `handles`, `joints`, or one with
/// `fronts` that were measured in a real room. Error for other files. `map_from_input` is that of a map which
/// it is compared with: it moves a URDF without sidecar whose floor is not at 0 into that map's frame.
MapStructure read_structure(const std::filesystem::path& path, const MeshSearch& search, Warnings& warnings,
                            const std::optional<Isometry3d>& map_from_input = {});

/// The joints are the world's; a sidecar without its world knows of none.
MapStructure structure_from_sidecar(const SemanticMap& sidecar, const World& world, const std::string& file);
MapStructure structure_from_truth(const Json& truth, const std::string& file);
MapStructure structure_from_geometry(const World& world, const MeshSearch& search, Warnings& warnings);
/// The world below a new root, the map.
World moved_world(World world, const Isometry3d& map_from_world);

}  // namespace loci::mapping
