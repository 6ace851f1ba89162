#pragma once

#include <filesystem>
#include <vector>

#include "apps/evaluate/normals/comparison.h"

namespace loci::apps::normals_evaluation {

/// The histograms of figures 4.2 to 4.6 as SVG files in a folder, and of what peers do beside ours; returns
/// the files.
std::vector<std::filesystem::path> write_figures(const Comparison& comparison,
                                                 const std::filesystem::path& folder);

}  // namespace loci::apps::normals_evaluation
