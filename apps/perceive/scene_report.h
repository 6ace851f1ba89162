#pragma once

#include <string>

#include "mapping/base/json_fwd.h"
#include "perception/types/scene_cas.h"

namespace loci::apps {

/// What was found in one scene, a line per support and per cluster.
std::string scene_text(const perception::types::SceneCas& scene);
/// The same with numbers: frame, time, supports, clusters (numbered from 1) with place, sentence, size,
/// height, colours, centroid, flags.
Json scene_json(const perception::types::SceneCas& scene);

}  // namespace loci::apps
