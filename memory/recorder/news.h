#pragma once

#include <string>

#include "memory/belief/evidence/visibility.h"
#include "memory/store/rows.h"

namespace loci::memory {

/// Whether a reader of the memory would be told something else without a row of belief of its own (the schema
/// says what is too little for one). `before`: what the memory says; `row`: what is believed now.
bool is_news(const BeliefRow& before, const BeliefRow& row, bool seen_now);

/// Metres or radians.
bool joint_moved(double from, double to);

/// What a scene says about an object that it did not see (missed, out_of_view, hidden), and how surely.
ObjectStatus unseen_status(const belief::Visibility& visibility);
double unseen_probability(const belief::Visibility& visibility, ObjectStatus status);

}  // namespace loci::memory
