#pragma once

#include <string>
#include <vector>

#include "perception/annotators/structure/known_map.h"
#include "perception/annotators/structure/surface_samples.h"

namespace loci::perception {

/// A piece of the map's furniture that people can move: what stands free, with all that is part of it.
struct Furniture {
  std::string name;                   ///< of its support, else of its largest link
  std::vector<std::string> branches;  ///< its topmost links
  std::vector<std::string> links;     ///< all of them
  // Map frame; any prefix covers the piece.
  std::vector<SurfaceSample> samples;  ///< of what no joint moves
  std::vector<SurfaceSample> closed;   ///< of all of it, with its drawers and doors shut
  Vector3d middle = Vector3d::Zero();  ///< of its box, where the map has it
  double radius = 0;                   ///< of a ball around the middle
  double top = 0;                      ///< height of what most of its upward surface lies at
};

/// The pieces of a map's furniture that mapping::stands_free() takes for movable, by the same rules as
/// `loci-map update` but from the links: those that touch belong together, those that carry a support to it.
std::vector<Furniture> movable_furniture(const KnownMap& map);

/// A world in which some links, with all below them, stand elsewhere. `now_from_before`: map frame.
struct MovedBranch {
  std::string link;
  Isometry3d now_from_before = Isometry3d::Identity();
};
mapping::World with_moved(mapping::World world, const std::vector<MovedBranch>& branches);

}  // namespace loci::perception
