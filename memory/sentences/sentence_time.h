#pragma once

#include <optional>
#include <string>

#include "memory/questions/time_parser.h"
#include "memory/sentences/lexicon.h"

namespace loci::memory {

/// A time that a sentence names, as texts that TimeReader reads.
struct SentencePeriod {
  std::string from, to;     ///< "" = open
  bool moment = false;      ///< one short time
  bool throughout = false;  ///< "the whole day": all of it
  bool spans = false;       ///< "since nine", "until nine", "from nine to ten": all of it, of what lasts
  bool around = false;      ///< "around nine"
};

/// Removes the longest time from a sentence ("this morning", "between nine and ten", "in the last hour"), the
/// last of equally long ones; unset when there is none.
std::optional<SentencePeriod> cut_time(Words& words, const TimeReader& times);

/// The longest time that begins at a word; `at` is moved behind it.
std::optional<SentencePeriod> time_at(const Words& words, size_t& at, const TimeReader& times);

}  // namespace loci::memory
