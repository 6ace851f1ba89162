#pragma once

#include <string>

#include "gui/core/colored_cloud.h"
#include "gui/data/open_memory.h"

namespace loci::gui {

// What is on the screen, as files.

/// What is believed at a time, a row per object: object, name, class, colour, place, state, probability,
/// centre (m, map frame), size (m), last seen.
std::string believed_csv(const Belief& belief);
/// The same as JSON, with the time and the joints.
std::string believed_json(const Belief& belief);
/// Binary PLY, map frame.
std::string cloud_ply(const ColoredCloud& cloud);

}  // namespace loci::gui
