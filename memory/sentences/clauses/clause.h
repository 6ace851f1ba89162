#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "memory/sentences/lexicon.h"
#include "memory/sentences/sentence_time.h"

namespace loci::memory {

/// A name in a clause: "red cup", with the relation before it.
struct Phrase {
  std::string relation = {};  ///< "on", "from", …; "" = none; "which" = asked for: "which red cup"
  std::string text = {};
  std::string joint = {};  ///< "and" or "or", where that joins it to the phrase before
};

/// A sentence taken apart. Every word of it is in one of the parts, or changes no meaning.
struct Clause {
  /// "where", "what", "howmany", …; "yes" = a question for yes or no; "order" = an order, or what a person
  /// states of themselves; "bare" = no verb, or a statement.
  std::string mood = {};
  std::set<std::string> concepts = {};  ///< lemmas that a rule has to account for: "move", "last", "not"
  std::set<std::string> marks = {};     ///< those that it may ignore: "was", "may", "there", "any"
  std::vector<Phrase> phrases = {};     ///< in order
  std::optional<SentencePeriod> period = {};
};

/// Readings of a sentence, the most literal first; none where a word is neither a name nor known to the
/// grammar. `concepts` are the lemmas that rules name.
std::vector<Clause> parse_clauses(const std::string& sentence, const std::set<std::string>& concepts,
                                  const TimeReader& times);

}  // namespace loci::memory
