#pragma once

#include <optional>
#include <string>

#include "memory/questions/question.h"

namespace loci::memory {

// A period that was forgotten on request was not observed. Of a moment or a period within it every question
// is answered so, whatever is believed: nothing is claimed from inside it. What is known before it and after
// it stays.

/// What was forgotten of the time that a query asks about.
struct ForgottenTime {
  TimeSpan period = {};  ///< that was forgotten, from the first part of it to the last
  bool all = false;      ///< it leaves nothing of the time asked about
  /// When what is known of a moment in it was seen: the last scene before it. Unset for a period, for what
  /// looks showed, and where no scene came before.
  std::optional<TimeNs> before = {};
};

/// Unset where the time asked about has no part of it. `as_of` holds where the query says no time.
std::optional<ForgottenTime> forgotten_time(const Store& store, const Query& query, const AsOf& as_of);
/// The part of a period that was forgotten, from the first to the last; unset = none of it was.
std::optional<TimeSpan> forgotten_part(const Store& store, const TimeSpan& period);

/// "what was seen from 09:20 to 10:30 was forgotten on request".
std::string forgotten_text(const TimeSpan& period, const TimeWriter& times);
/// The reply instead of `known`, which is one as of the time before, or of what is left of a period.
Reply forgotten_reply(const ForgottenTime& forgotten, const Reply& known, const TimeWriter& times);

}  // namespace loci::memory
