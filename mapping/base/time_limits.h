#pragma once

#include "mapping/base/time.h"

namespace loci {

/// Times that are read from outside lie within 146 years of 1970, up to and including this one: the
/// difference of any two of them fits into TimeNs.
inline constexpr TimeNs kMaxTime = (TimeNs{1} << 62) - 1;

inline bool is_within_limits(TimeNs time) {
  return -kMaxTime <= time && time <= kMaxTime;
}

}  // namespace loci
