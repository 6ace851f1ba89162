#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

// "The milk and the jam": one question for each, and one reply from theirs.

/// A query for each of the names that "and" or "or" joins in one argument; one query where none does.
struct Coordination {
  std::vector<Query> queries;
  std::string joint = {};  ///< "and" or "or"
};
Coordination coordination_of(const Query& query);

/// "Which is the biggest, the cup, the bowl or the plate?" as "what is the biggest cup or bowl or plate?";
/// other sentences as they are.
std::string with_choices_joined(const std::string& sentence);

/// One reply: of verdicts, "and" asks whether all hold and "or" whether any does; of places where it happened
/// last, the latest is named; of the rest, all are stated. Not for no replies.
Reply combined(const std::vector<Reply>& replies, const Coordination& coordination);

/// One reply to several questions of a sentence: a line for each; of each type the first states it, and all
/// objects and places are stated. Not for no replies.
Reply in_lines(const std::vector<Reply>& replies);

/// "Is the spoon on the table and the cup in the drawer?" as two questions; unset for other sentences.
std::optional<std::pair<std::string, std::string>> two_statements(const std::string& sentence);

/// The reply to which objects, how many, or whether any, of these only.
Reply among(const Reply& reply, const std::vector<Id>& them, Asks asks, const Snapshot& snapshot);

/// The verdict on the contrary of what was asked; other replies as they are.
Reply contrary_of(Reply reply);

}  // namespace loci::memory
