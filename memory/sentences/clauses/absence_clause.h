#pragma once

#include <optional>
#include <string>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

/// "How long was the tea away from the counter?" asks when it left and when it came back.
struct Absence {
  Query left = {}, came = {};  ///< for times; `came` has to begin at the time of `left`
};
/// Unset for other sentences.
std::optional<Absence> find_absence(const std::string& sentence, const Snapshot& snapshot);

/// From the look before it left to the look that saw it back, else to `now`: at most that long it was away.
Reply absence_reply(const TimeSpan& left, const std::optional<TimeSpan>& came, TimeNs now,
                    const TimeWriter& times);

}  // namespace loci::memory
