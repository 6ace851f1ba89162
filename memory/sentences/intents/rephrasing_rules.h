#pragma once

#include "memory/sentences/intents/pattern.h"

namespace loci::memory {

/// What readers would take for less than it says; before any of them reads.
const std::vector<Pattern>& meanings();
/// "Was it anywhere but on the shelf?": those of which the contrary is asked.
const std::vector<Pattern>& contraries();
/// Constructions that no reader understands, in plain words.
const std::vector<Pattern>& constructions();

}  // namespace loci::memory
