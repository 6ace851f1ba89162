#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Triangles with one colour each, in the frame of their visual, metres.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<Rgba> colors;                        ///< one per triangle; empty = no colour of its own
};

/// Where mesh files are looked for: `package://NAME/…` below each package path (a folder that holds NAME, or
/// is NAME) and in the folder NAME that the URDF lies in, relative names beside the URDF.
struct MeshSearch {
  std::vector<std::filesystem::path> package_paths;
  std::filesystem::path urdf_folder;
};

/// Reads STL, OBJ or COLLADA (what else assimp knows is not refused) with assimp, in the file's own axes as
/// RViz shows them (the turn that assimp gives Z_UP files is undone). A missing or unreadable file adds a
/// warning with its name and gives an empty mesh.
TriangleMesh load_mesh(const Mesh& mesh, const MeshSearch& search, Warnings& warnings);

/// Any geometry as triangles: primitives are tessellated (cylinder and sphere with `segments` around), meshes
/// loaded.
TriangleMesh triangulate(const Geometry& geometry, const MeshSearch& search, Warnings& warnings,
                         int segments = 32);

}  // namespace loci::mapping
