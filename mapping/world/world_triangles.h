#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// A triangle of a world's visual geometry, root frame.
struct WorldTriangle {
  std::array<Vector3d, 3> corners;
  Vector3d normal;  ///< unit
  double area = 0;
  size_t link = 0;  ///< index into the world's links
  Rgba color = Rgba(0.7F, 0.7F, 0.7F, 1);
};

/// All visual geometry with the joints at 0; slivers are left out.
std::vector<WorldTriangle> triangles_of(const World& world, const MeshSearch& search, Warnings& warnings);

/// Height of a world's floor: the largest level face of its link `floor`; else the lowest level on which
/// upward faces cover half of the ground plan. Unset where neither is there.
std::optional<double> floor_height(const World& world, const std::vector<WorldTriangle>& triangles);

/// Whether a floor lies at z = 0, as in every frame "map": measured ones do within a few centimetres.
bool is_at_zero(double floor_height);

}  // namespace loci::mapping
