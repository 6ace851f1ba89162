#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Which object each pixel of the depth image shows: 0 = none, n = the scene's n-th cluster (from 1), or
/// the number that `numbers` gives that cluster (0 = leave out).
cv::Mat label_image(const types::SceneCas& scene, const std::vector<int>& numbers = {});

/// The memory's numbers of the scene's clusters (from their TrackingAnnotation); 0 = not known to be an
/// object.
std::vector<int> tracked_numbers(const types::SceneCas& scene);

/// Writes FOLDER/FRAME_label.png (16 bit), FRAME being the frame's name: "learn33" for learn33_depth.png.
void write_label_image(const types::SceneCas& scene, const std::filesystem::path& folder,
                       const std::vector<int>& numbers = {});

/// Writes FOLDER/FRAME.png: the colour image with the clusters in colours, their boxes and numbers.
void write_overlay(const types::SceneCas& scene, const std::filesystem::path& folder);

}  // namespace loci::perception
