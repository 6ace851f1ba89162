#pragma once

#include <optional>
#include <string>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// "What was on the table at noon that was not there at ten?": what was on a place at one time, against what
// was there at another.

struct ContentsComparison {
  enum class Relation {
    without,  ///< what is in the first and not in the second
    common,   ///< what is in both
    more,     ///< whether the first has more
    fewer,    ///< whether the first has fewer
  };
  Relation relation = Relation::without;
  Query first = {}, second = {};  ///< both ask for objects
  std::string place = {};
  std::string first_time = {}, second_time = {};  ///< in words, "now", or "" = ever
  /// Objects, their number, or a verdict: with `without` and `common` whether that holds of all of the first.
  Asks asks = Asks::objects;
};
/// Unset for other sentences: every word has to be accounted for.
std::optional<ContentsComparison> find_contents_comparison(const std::string& sentence,
                                                           const Snapshot& snapshot, const TimeReader& times);

/// The reply from those to both questions; not known where one of them is not.
Reply compared(const ContentsComparison& comparison, const Reply& first, const Reply& second,
               const Snapshot& snapshot);

}  // namespace loci::memory
