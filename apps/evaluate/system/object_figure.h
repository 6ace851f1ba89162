#pragma once

#include <string>

#include "perception/types/scene_cas.h"

namespace loci::system_evaluation {

/// How much there is to tell of an object: its annotations, and each word, code and product once more.
size_t richness(const types::Cluster& cluster);

/// Figure 8.1: the object's image, and beside it each annotation with its values, as SVG.
std::string object_svg(const types::Cluster& cluster);

}  // namespace loci::system_evaluation
