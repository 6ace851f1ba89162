#include "memory/sentences/name_check.h"

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/spelling.h"
#include "memory/sentences/suggestions.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

/// "grown", "drank": a form of a verb, and no noun.
bool is_inflected_verb(const std::string& word) {
  using wordnet::PartOfSpeech;
  const std::vector<std::string> bases = wordnet::base_forms(word, PartOfSpeech::verb);
  return !bases.empty() && std::ranges::count(bases, word) == 0 &&
         wordnet::base_forms(word, PartOfSpeech::noun).empty();
}

/// Whether the parameter of a question is a name of what is in the home.
bool is_name(const Parameter& parameter) {
  return parameter.type == ParameterType::object || parameter.type == ParameterType::place ||
         parameter.type == ParameterType::part || parameter.type == ParameterType::spot;
}

}  // namespace

bool NameCheck::is_strange(const Query& query) const {
  return std::ranges::any_of(find_question(query.question)->parameters, [&](const Parameter& parameter) {
    const std::vector<std::string> name = words_of(lower_case(query.argument(parameter.name)));
    return is_name(parameter) && !name.empty() && is_strange_name(name);
  });
}

bool NameCheck::is_strange_name(const std::vector<std::string>& name) const {
  const auto known = [&](const std::string& word) {
    return is_known_word(word) || word.find_first_of("_0123456789'") != std::string::npos ||
           words().contains(word);
  };
  const std::string& noun = name.back();
  const bool is_compound =  // "watering can"
      name.size() == 2 && !wordnet::base_forms(name[0] + "_" + name[1], wordnet::PartOfSpeech::noun).empty();
  if (is_compound) return false;
  const bool is_noun = !wordnet::base_forms(noun, wordnet::PartOfSpeech::noun).empty();
  if (is_noun && !known(noun) && !wordnet::may_be_somewhere(noun)) return true;
  // "Uncertain", "unusual": English, and no noun.
  if (!is_noun && wordnet::is_word(noun) && !is_household_noun(noun) && !words().contains(noun)) return true;
  const auto means_something = [&] {
    return lemma_of(noun) == "thing" || is_known({"where", {{"object", noun}}, Asks::place});
  };
  for (const std::string& word : name) {
    if (known(word)) continue;
    const bool verb =
        word.ends_with("ed") || word.ends_with("ing") || word.ends_with("ly") || is_inflected_verb(word);
    if (verb || (&word != &noun && means_something())) return true;
  }
  return false;
}

bool NameCheck::is_object_for_place(const Query& query) const {
  return std::ranges::any_of(find_question(query.question)->parameters, [&](const Parameter& parameter) {
    const bool place = parameter.type == ParameterType::place || parameter.type == ParameterType::part;
    const std::string name = query.argument(parameter.name);
    return place && !name.empty() && snapshot_.places_meant(name).empty() && snapshot_.means_objects(name);
  });
}

bool NameCheck::is_place_for_object(const Query& query) const {
  const std::string name = query.argument("object");
  return !name.empty() && !snapshot_.places_meant(name).empty() && !snapshot_.means_objects(name);
}

bool NameCheck::has_unknown_word(const Query& query) const {
  return std::ranges::any_of(find_question(query.question)->parameters, [&](const Parameter& parameter) {
    const std::vector<std::string> name = words_of(lower_case(query.argument(parameter.name)));
    return is_name(parameter) && name.size() > 1 &&
           std::ranges::any_of(name, [&](const std::string& word) { return !words().contains(word); });
  });
}

bool NameCheck::is_known(const Query& query) const {
  try {
    snapshot_.find_objects(query.argument("object"));
    return true;
  } catch (const UnknownName&) {
    return false;
  }
}

const std::set<std::string>& NameCheck::words() const {
  if (!words_) {
    words_.emplace();
    for (const std::string& name : known_names(store_))
      for (const std::string& word : words_of(lower_case(name))) words_->insert(word);
    for (const std::string& name : snapshot_.known_names())
      for (const std::string& word : words_of(lower_case(name))) words_->insert(word);
  }
  return *words_;
}

}  // namespace loci::memory
