#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"

namespace loci::memory {

// ---- compare

/// Two objects or places against each other.
struct ComparisonQuestion {
  std::string subject = {};  ///< an object; for "more" a place, for heights also furniture
  std::string with = {};     ///< likewise; of distances also a place: from the nearest point of its outline
  std::string than = {};     ///< "nearer" to `with` than to this
  /// "distance" between them; whether the first is "nearer", "bigger" (by volume), "smaller", "left-before",
  /// "came-before", "moved-before" or, of furniture, "opened-before" (the last time), was "longer" at a
  /// place, or whether "more" is on it.
  std::string by = "distance";
  std::string place = {};  ///< that it left, came to or was at; empty = any
  AsOf as_of = {};
};
struct Compared {
  std::string name = {};  ///< "object_3" or "table_1"
  std::optional<Id> object = {};
  /// Distance from the first (m), volume (m^3), number of objects or, at least, time at the place (s).
  std::optional<double> value = {};
  std::optional<double> max_value = {};  ///< of the time at the place, by the looks around its sightings
  /// When it left or moved; without an end where it was last seen there.
  std::optional<TimeSpan> time = {};
};
struct ComparisonAnswer {
  std::string by = {};
  std::vector<Compared> compared = {};      ///< in the order of the question
  Verdict verdict = Verdict::not_observed;  ///< also where a value is not known; of "distance" yes = known
};
ComparisonAnswer ask(const Store& store, const ComparisonQuestion& question);
std::string to_text(const ComparisonAnswer& answer, const TimeWriter& times);
void write_reply(const ComparisonAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const ComparisonAnswer& answer);

std::vector<Question> comparison_questions();

}  // namespace loci::memory
