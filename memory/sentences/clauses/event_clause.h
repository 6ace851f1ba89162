#pragma once

#include <optional>
#include <string>

#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

/// A question whose time is that of an event, or that holds on a condition: "where was the cup when the
/// drawer was opened", "if the cup is in the drawer, is it the red one". What a pronoun of one clause stands
/// for is named in the other.
struct EventClause {
  enum class Link { at, after, before, condition };
  Link link = Link::at;
  std::string question = {};  ///< "where was the cup"
  std::string event = {};     ///< "the drawer was opened"
};
/// Unset when no clause of this kind is in the sentence.
std::optional<EventClause> find_event_clause(const std::string& sentence, const Snapshot& snapshot);

/// The question at the time of its event: a state at that moment, what happened from then or until then.
/// `lasts`: it was so from the first to the last time, and did not happen at some time between them.
std::string question_at(const EventClause& clause, const TimeSpan& event, bool lasts);

}  // namespace loci::memory
