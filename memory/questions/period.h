#pragma once

#include <optional>

#include "mapping/base/time.h"

namespace loci::memory {

/// Error for a period that ends before it begins: nothing is within it, and "nothing" would answer another
/// question.
void check_period(const std::optional<TimeNs>& from, const std::optional<TimeNs>& to);

}  // namespace loci::memory
