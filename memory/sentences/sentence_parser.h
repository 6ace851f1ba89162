#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/sentences/clauses/clause.h"

namespace loci::memory {

// English sentences as queries: a sentence is taken apart into a clause (clause.h), and the forms of the
// declared questions say which clauses mean them.

/// The readings of a sentence as clauses, for what follows.
std::vector<Clause> clauses_of(const std::string& sentence, const TimeReader& times);
/// All queries that a sentence may mean, the most literal first; empty when no rule matches.
std::vector<Query> parse_readings(const std::vector<Clause>& clauses, const TimeReader& times);
/// The first of them.
std::optional<Query> parse_sentence(const std::string& sentence, const TimeReader& times);

/// A name alone asks where it is: "The milk?"
std::optional<Query> parse_name(const std::vector<Clause>& clauses);

/// A sentence that leans on the one before: "And the jam?", "And on the counter?", "Why?", "How sure are
/// you?". Empty when it does not, or makes no sense after `last`.
std::vector<Query> parse_follow_up(const std::vector<Clause>& clauses, const Query& last,
                                   const TimeReader& times);

/// Examples of the rules nearest to a sentence, nearest first.
std::vector<std::string> nearest_examples(const std::string& sentence, size_t count = 3);
/// All examples, in the order of the questions.
std::vector<std::string> all_examples();

}  // namespace loci::memory
