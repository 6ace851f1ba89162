#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/world/contacts.h"
#include "mapping/world/mesh.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// What a world holds, counted: what `loci-map check` answers.
struct WorldInspection {
  std::string name;
  std::string root;
  size_t links = 0;
  size_t joints = 0;
  std::map<std::string, size_t> joints_by_type;
  std::map<std::string, size_t> visuals_by_kind;  ///< box, cylinder, sphere, mesh
  size_t collisions = 0;
  size_t triangles = 0;                     ///< of the visual geometry
  std::vector<std::string> missing_meshes;  ///< URIs that gave no triangles, each once
  double mass = 0;                          ///< kg, of the links that state one
  size_t links_with_mass = 0;
  Eigen::AlignedBox3d bounds;     ///< of the visual geometry, root frame, metres, joints at 0; may be empty
  std::vector<Contact> contacts;  ///< of boxes, cylinders and spheres in the closed state
  std::map<std::string, size_t> extensions;              ///< elements that URDF does not define, by name
  std::optional<std::map<std::string, size_t>> classes;  ///< links by class, when there is a sidecar

  std::string summary() const;  ///< one line
  std::string report() const;   ///< all of it, several lines
  Json to_json() const;
};

/// Counts a world. Meshes are loaded; a missing one is warned about by name.
WorldInspection inspect(const World& world, const MeshSearch& search, Warnings& warnings);

/// Error for a world, in the file named, that is larger than any building: its unit is another one than the
/// metre.
void require_metres(const Eigen::AlignedBox3d& bounds, const std::string& file);

/// Adds what a sidecar says; a link that the world does not have is warned about.
void inspect_sidecar(const SemanticMap& sidecar, const World& world, WorldInspection& inspection,
                     Warnings& warnings);

}  // namespace loci::mapping
