#pragma once

#include "memory/store/store.h"

namespace loci::memory {

// What was seen after a past moment is evidence of that moment, too: an object that is found again where it
// was seen before probably stood there all the time, and one that is missed there may have left before.
// Every question about a moment (was, where, on, in, history, objects) takes its probabilities from here.

/// The probability that an object was at the place of `then`, its belief as of the moment of `as_of`, by what
/// was seen before and after it; that of the row where `as_of` is of no moment, at which the object was seen,
/// or after which nothing was seen of it.
double smoothed_probability(const Store& store, const BeliefRow& then, const AsOf& as_of);

}  // namespace loci::memory
