#include "memory/sentences/clauses/relative_clause.h"

#include <algorithm>
#include <optional>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/sentences/mentions.h"
#include "memory/sentences/sentence_time.h"

namespace loci::memory {
namespace {

/// "the cup | that stood on | the table | this morning"
struct RelativeClause {
  size_t first = 0, last = 0;  ///< words, the name included
  std::string name = {}, place = {};
  bool left = false;    ///< it was taken from the place
  bool beside = false;  ///< `place` is an object that it was near
  std::optional<SentencePeriod> period = {};
};

/// Whether words between a name and a place make a clause: "that stood on", "I left on", "you saw in".
bool links(const Tokens& tokens, size_t first, size_t last, bool& left) {
  static const std::set<std::string> verbs = {"stand", "put", "leave", "see", "keep", "have", "take",
                                              "find",  "was", "been",  "go",  "get",  "move", "lose"};
  static const std::set<std::string> present = {"stands", "sits",  "lies", "is",
                                                "rests",  "leave", "put",  "see"};
  if (last < first + 3 || last > first + 6) return false;
  const bool pronoun = tokens.lemmas[first] == "that" || tokens.lemmas[first] == "which";
  if (!pronoun && class_of(tokens.lemmas[first]) != WordClass::person) return false;
  bool verb = false, relation = false;
  for (size_t i = first + 1; i < last; ++i) {
    const std::string& lemma = tokens.lemmas[i];
    const WordClass word_class = class_of(lemma);
    if (present.contains(tokens.words[i]) && pronoun) return false;
    if (verbs.contains(lemma)) {
      verb = true;
      continue;
    }
    if (word_class == WordClass::relation) {
      relation = true;
      left = lemma == "from";
      continue;
    }
    const bool passes = word_class == WordClass::auxiliary || word_class == WordClass::article ||
                        word_class == WordClass::empty || word_class == WordClass::person ||
                        lemma == "before";
    if (!passes) return false;
  }
  return verb && relation;
}

std::optional<RelativeClause> find_clause(const Tokens& tokens, const Snapshot& snapshot,
                                          const TimeReader& times) {
  const std::vector<Mention> mentions =
      find_mentions(tokens, snapshot, [](const std::string&) { return true; });
  for (size_t i = 0; i + 1 < mentions.size(); ++i) {
    const Mention &name = mentions[i], &place = mentions[i + 1];
    bool left = false;
    if (name.place || !links(tokens, name.last, place.first, left)) continue;
    const auto is_beside = [&](size_t at) {
      return tokens.lemmas[at] == "near" || tokens.lemmas[at] == "nextto";
    };
    const bool beside = is_beside(place.first - 1) || is_beside(place.first - 2);
    if (place.place == beside) continue;
    RelativeClause clause{.first = name.first,
                          .last = place.last,
                          .name = name.text,
                          .place = place.text,
                          .left = left,
                          .beside = beside};
    clause.period = time_at(tokens.words, clause.last, times);
    if (beside && !(clause.period && clause.period->moment)) continue;  // what is near changes
    return clause;
  }
  return std::nullopt;
}

/// What was there then, or was taken from there.
std::vector<Id> objects_of(const RelativeClause& clause, const Snapshot& snapshot) {
  Query query{.question = clause.left ? "changes" : "contents-history",
              .arguments = {{"place", clause.place}},
              .asks = Asks::objects};
  if (clause.left) {
    query.arguments["kind"] = "left";
    query.arguments["object"] = clause.name;
  }
  if (!clause.left && clause.period && clause.period->moment)
    query = {.question = "on",
             .arguments = {{"place", clause.place}, {"at", clause.period->from}},
             .asks = Asks::objects};
  else if (clause.period && !clause.period->from.empty())
    query.arguments["from"] = clause.period->from;
  if (query.question != "on" && clause.period && !clause.period->to.empty())
    query.arguments["to"] = clause.period->to;
  if (clause.beside)
    query = {.question = "near",
             .arguments = {{"around", clause.place},
                           {"object", clause.name},
                           {"at", clause.period->from},
                           {"count", "1"}},
             .asks = Asks::objects};
  try {
    const std::vector<Id> called = snapshot.find_objects(clause.name);
    std::vector<Id> found =
        ask(snapshot.store(), query, snapshot.as_of())
            .reply({snapshot.store(), query,
                    read_as_of(snapshot.store(), query.argument("at"), "", snapshot.as_of()),
                    TimeWriter(snapshot.store())})
            .objects;
    std::erase_if(found, [&](Id id) { return std::ranges::count(called, id) == 0; });
    return found;
  } catch (const Error&) {
    return {};  // the clause is kept, and the sentence not understood
  }
}

/// "Everything that is red" as "red objects".
Words with_attributes_first(Words words, const Snapshot& snapshot) {
  static const std::set<std::string> all = {"everything", "anything", "things", "objects", "ones"};
  static const std::set<std::string> pronouns = {"that", "which"},
                                     verbs = {"is", "are", "was", "were", "looks"};
  for (size_t i = 0; i + 3 < words.size(); ++i)
    if (all.contains(words[i]) && pronouns.contains(words[i + 1]) && verbs.contains(words[i + 2]) &&
        class_of(words[i + 3]) == WordClass::name && snapshot.means_objects(words[i + 3]))
      replace_words(words, i, 4, {words[i + 3], "objects"});
  return words;
}

}  // namespace

Words without_relative_clauses(Words words, const Snapshot& snapshot, const TimeReader& times) {
  words = with_attributes_first(std::move(words), snapshot);
  const Tokens tokens = tokens_of(words);
  const auto clause = find_clause(tokens, snapshot, times);
  if (!clause) return words;
  const std::vector<Id> objects = objects_of(*clause, snapshot);
  if (objects.empty()) return words;
  Words names;
  for (const Id id : objects) {
    if (!names.empty()) names.emplace_back("and");
    names.push_back(object_name(id));
  }
  Words result = tokens.words;
  replace_words(result, clause->first, clause->last - clause->first, names);
  return result;
}

}  // namespace loci::memory
