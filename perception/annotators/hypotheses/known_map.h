#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mapping/render/render.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci {

/// A surface of the map on which things may stand.
struct SupportSurface {
  std::string link;
  std::string class_name;
  size_t link_id = 0;  ///< in KnownMap::scene
  /// Frame of the place: origin at the centre of the surface, z up, x and y those of the link where its z is
  /// up.
  Isometry3d link_from_top = Isometry3d::Identity();
  std::vector<Vector2d> outline;  ///< convex, counter-clockwise, in that frame, metres
};

/// The map that a recording is perceived against: world, sidecar, and its triangles ready to be drawn. A
/// resource of the pipeline.
struct KnownMap {
  std::filesystem::path path;
  World world;
  SemanticMap semantics;
  MeshSearch meshes;
  RenderScene scene;
  size_t part = 0;

  /// Reads a URDF and, where there is one, its sidecar.
  static std::shared_ptr<KnownMap> load(const std::filesystem::path& urdf,
                                        const std::vector<std::filesystem::path>& package_paths,
                                        Warnings& warnings);
  static std::shared_ptr<KnownMap> make(World world, SemanticMap semantics, MeshSearch meshes,
                                        Warnings& warnings);

  /// From the sidecar; without an entry there, the name without its numbers: "drawer_3_bottom" is a
  /// "drawer_bottom".
  std::string class_of(const std::string& link) const;

  /// The surfaces of links whose name or class matches one of the patterns (* and ?), with their joints at 0.
  std::vector<SupportSurface> support_surfaces(const std::vector<std::string>& patterns) const;
};

}  // namespace loci
