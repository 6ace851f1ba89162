#pragma once

#include <string>

#include "perception/types/scene_cas.h"

namespace loci::apps::system_evaluation {

/// How much there is to tell of an object: its annotations, and each word, code and product once more.
size_t richness(const perception::types::Cluster& cluster);

/// Figure 8.1: the object's image, and beside it each annotation with its values, as SVG.
std::string object_svg(const perception::types::Cluster& cluster);

}  // namespace loci::apps::system_evaluation
