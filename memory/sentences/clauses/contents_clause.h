#pragma once

#include <optional>
#include <string>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// "What was on the table at noon that was not there at ten?": what was on a place at one time, against what
// was there at another. "Are there more cups than plates?": of the one against the other, or at two places.

struct ContentsComparison {
  enum class Relation {
    without,  ///< what is in the first and not in the second
    common,   ///< what is in both
    more,     ///< whether the first has more, or which has
    fewer,    ///< whether the first has fewer, or which has
    equal,    ///< whether both have as many
  };
  Relation relation = Relation::without;
  Query first = {}, second = {};  ///< both ask for objects
  std::string place = {};
  /// In words: "now", "" = ever, "on the table", "cups".
  std::string first_label = {}, second_label = {};
  /// Objects, their number, or a verdict: with `without` and `common` whether that holds of all of the first.
  /// With `more` and `fewer` a verdict, or the objects or the place of which there are.
  Asks asks = Asks::objects;
};
/// Unset for other sentences: every word has to be accounted for.
std::optional<ContentsComparison> find_contents_comparison(const std::string& sentence,
                                                           const Snapshot& snapshot, const TimeReader& times);

/// The reply from those to both questions; not known where one of them is not.
Reply compared(const ContentsComparison& comparison, const Reply& first, const Reply& second,
               const Snapshot& snapshot);

}  // namespace loci::memory
