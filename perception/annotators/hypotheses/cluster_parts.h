#pragma once

#include <string>
#include <vector>

#include "perception/annotators/hypotheses/color_region.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

// What every expert that finds clusters puts into them.

/// The cluster's points as indices into the scene's cloud (row · width + column), and its centroid from them.
/// `pose` = map_from_camera.
void set_points(const types::Cluster& cluster, const std::string& source, const std::vector<int>& pixels,
                const types::SceneCas& scene, const Isometry3d& pose);

/// Its image, cut out of the colour view with its mask. Nothing where it lies outside that view.
void add_image(const types::Cluster& cluster, const std::string& source, const ColorRegion& region,
               const types::SceneCas& scene);

}  // namespace loci::perception
