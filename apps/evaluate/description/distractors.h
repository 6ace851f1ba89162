#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/random.h"
#include "perception/recognition/product_catalogue.h"

namespace loci::apps::description_evaluation {

/// Draws the front of a package that nobody sells: 198 × 198 pixels like a shop's images, a few coloured
/// shapes, a name in large letters, lines in small ones.
cv::Mat invented_package(Random random);

/// Writes so many of them into a folder, as entries of a catalogue that no query shows. Same seed, same
/// bytes.
std::vector<perception::Product> invent_products(int count, const std::filesystem::path& folder);

}  // namespace loci::apps::description_evaluation
