#pragma once

#include "memory/questions/answers.h"

namespace loci::memory {

/// Changes of one kind alone: a kind of Change, or "left" (gone, or moved away from the place that is asked
/// about) and "came" (appeared, seen again, or moved there). Without a place what moved neither left nor
/// came. Empty = all. Error with the kinds for any other.
ChangesAnswer ask_for_kind(const Store& store, const ChangesQuestion& question, const std::string& kind);

}  // namespace loci::memory
