#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"

namespace loci::memory {

// Facts that people state about objects and places: alias, owner, class, state, or any other key. Rows are
// only added: a new owner supersedes the old one, which questions as of an earlier time still see.

/// A fact that holds.
struct Fact {
  Id id = 0;
  std::string about = {};  ///< "object_4", "table_1"
  std::string key = {};
  std::string value = {};
  TimeNs valid_from = 0;
  TimeNs known_from = 0;
  std::string source = {};  ///< "user", "perceive", "catalogue", ...
  std::optional<double> probability = {};
};
struct FactsQuestion {
  std::string about = {};  ///< object or place in words; empty = all
  std::string key = {};    ///< empty = all
  AsOf as_of = {};
};
struct FactsAnswer {
  std::vector<Fact> facts = {};
  std::vector<Fact> retracted = {};  ///< by the change that this is the answer of
};
FactsAnswer ask(const Store& store, const FactsQuestion& question);
std::string to_text(const FactsAnswer& answer);
Json to_json(const FactsAnswer& answer);

/// States that `about` (which must mean one object or one place) has this value. A key other than "alias" has
/// one value: the old one is superseded. Stating the same again changes nothing. Returns the facts of that
/// key that hold then.
FactsAnswer set_fact(Store& store, const std::string& about, const std::string& key,
                     const std::string& value);
/// The same for several keys and values of one object or place, as one change. Returns its facts of these
/// keys.
FactsAnswer set_facts(Store& store, const std::string& about,
                      std::vector<std::pair<std::string, std::string>> values);
/// Retracts a value, or every value of the key when it is empty; with kTaughtKey also the class that was
/// stated with the example, and what had been said before holds again. Error when there is none.
FactsAnswer remove_fact(Store& store, const std::string& about, const std::string& key,
                        const std::string& value);

}  // namespace loci::memory
