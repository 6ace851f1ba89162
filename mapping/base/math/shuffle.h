#pragma once

#include <utility>
#include <vector>

#include "mapping/base/math/random.h"

namespace loci {

/// All orders are equally likely (Fisher and Yates 1938); the same on every machine, unlike std::shuffle.
template <class Value>
void shuffle(std::vector<Value>& values, Random& random) {
  for (size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.index(i)]);
}

}  // namespace loci
