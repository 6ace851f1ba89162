#pragma once

#include "memory/sentences/lexicon.h"

namespace loci::memory {

// What makes a question polite, and asks nothing.

/// "Excuse me", "thanks", "robot", "please".
bool is_polite(const Words& words);
/// "Do you know", "would you happen to remember", "I wonder": what introduces a question, alone.
bool is_introduction(const Words& words);

/// Removes politeness and introductions from both ends.
void strip_surroundings(Words& words);

}  // namespace loci::memory
