#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Name of the visual with which a map shows a photo of a front, before the panel of the front's mean colour.
inline constexpr const char* kPhotoVisual = "photo";

/// Triangles of one material of a mesh file, in the frame of their visual, metres.
struct MeshPart {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector2f> texture_coordinates;  ///< one per vertex, v upwards; empty without texture
  std::vector<std::array<uint32_t, 3>> triangles;    ///< counter-clockwise seen from outside
  std::optional<Rgba> color;                         ///< of the file's material
  std::filesystem::path texture;                     ///< image that exists; empty = none
};

/// Reads a mesh file as load_mesh() does, with its textures.
std::vector<MeshPart> load_mesh_parts(const Mesh& mesh, const MeshSearch& search, Warnings& warnings);

/// Names the mesh files that a world names relative to one folder relative to another.
void move_mesh_names(World& world, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace loci::mapping
