#pragma once

#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"

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

/// The verdict on the contrary of what was asked; other replies as they are.
Reply contrary_of(Reply reply);

}  // namespace loci::memory
