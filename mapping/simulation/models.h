#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/world/mesh.h"

namespace loci::mapping {

/// A household object of a scenario.
struct ObjectSpec {
  std::string name;
  std::string model;             ///< one of object_models()
  std::optional<Vector3d> size;  ///< full extents in metres; unset = the model's own
  Rgba color = Rgba(0.8F, 0.8F, 0.8F, 1);
  std::optional<Rgba> accent;   ///< second colour of patterns and lids; unset = a darker color
  std::string pattern;          ///< one of object_patterns(); "" = plain
  std::filesystem::path label;  ///< image on the front of a box, around a can, jar or bottle
};

/// An object as triangles: z up, origin in the middle of its bottom, front towards -y.
struct ObjectModel {
  TriangleMesh mesh;
  Vector3d low = Vector3d::Zero();   ///< corner of its bounding box
  Vector3d high = Vector3d::Zero();  ///< opposite corner
  double top = 0;                    ///< height at which other objects stand on it (a plate's is not its rim)
};

std::vector<std::string> object_models();
std::vector<std::string> object_patterns();

/// Builds an object. Error when its label is no image.
ObjectModel build_object(const ObjectSpec& spec);

}  // namespace loci::mapping
