#include "memory/sentences/clauses/clause.h"

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/courtesy.h"
#include "memory/sentences/discourse.h"

namespace loci::memory {
namespace {

using WordSet = std::set<std::string>;

const WordSet kAtRelations = {"on", "in", "at"};
/// Whether a relation to an object is another relation of that object: "behind" and "in front".
bool has_inverse(const std::string& relation) {
  static const WordSet relations = {"behind", "infront", "leftof", "rightof",
                                    "under",  "near",    "nextto", "on"};
  return relations.contains(relation);
}
/// Verbs that say no more than that something is there, is seen or is known: rules need not name them.
const WordSet kLight = {"stand", "hide", "exist", "see", "find", "know", "think", "get", "sure"};

/// "2", "two"; "one" stands for a thing.
bool is_number(const std::string& word) {
  const auto count = count_of(word);
  return count && (*count > 1 || is_digit(word[0]));
}

// ---- Words as parts of a clause.

/// Takes the words of a sentence one after the other.
class ClauseReader {
 public:
  ClauseReader(Tokens tokens, const WordSet& concepts) : tokens_(std::move(tokens)), concepts_(concepts) {}

  /// Unset when a word has no place in a clause.
  std::optional<Clause> read() {
    for (next_ = 0; next_ < tokens_.lemmas.size(); ++next_)
      if (!take()) return std::nullopt;
    close();
    drop_formal_subject();
    if (clause_.mood.empty()) clause_.mood = is_stated() ? "yes" : "bare";
    return clause_;
  }

 private:
  /// "It is still there the bowl?", "which things they are there?"
  void drop_formal_subject() {
    const auto is_formal = [](const Phrase& phrase) {
      return phrase.relation.empty() && is_pronoun(phrase.text);
    };
    const auto named = std::ranges::count_if(clause_.phrases, [&](const Phrase& phrase) {
      return (phrase.relation.empty() || phrase.relation == "which") && !is_formal(phrase);
    });
    const bool things = clause_.mood == "what" && clause_.concepts.contains("thing");
    if (named > 0 || things)
      if (const auto formal = std::ranges::find_if(clause_.phrases, is_formal);
          formal != clause_.phrases.end() && (things || clause_.mood == "yes" || clause_.mood.empty()))
        clause_.phrases.erase(formal);
  }
  /// A statement asks whether it is so.
  bool is_stated() const {
    return !clause_.phrases.empty() && std::ranges::any_of(clause_.marks, [](const std::string& mark) {
      return class_of(mark) == WordClass::auxiliary;
    });
  }
  const std::string& lemma(size_t ahead = 0) const {
    static const std::string none;
    return next_ + ahead < tokens_.lemmas.size() ? tokens_.lemmas[next_ + ahead] : none;
  }
  const std::string& word() const { return tokens_.words[next_]; }
  const std::string& next_word() const {
    static const std::string none;
    return next_ + 1 < tokens_.words.size() ? tokens_.words[next_ + 1] : none;
  }
  const std::string& previous() const {
    static const std::string none;
    return next_ > 0 ? tokens_.lemmas[next_ - 1] : none;
  }
  bool is_concept(const std::string& one) const { return concepts_.contains(one); }
  bool is_name(const std::string& one) const {
    return !one.empty() && class_of(one) == WordClass::name && !is_concept(one);
  }
  /// The next token that is neither article nor empty.
  const std::string& next_meaning() const {
    static const std::string none;
    for (size_t i = next_ + 1; i < tokens_.lemmas.size(); ++i) {
      const WordClass word_class = class_of(tokens_.lemmas[i]);
      if (word_class != WordClass::article && word_class != WordClass::empty) return tokens_.lemmas[i];
    }
    return none;
  }
  bool began() const {
    return !clause_.mood.empty() || !clause_.phrases.empty() || !clause_.concepts.empty() || !name_.empty();
  }

  void close() {
    if (!name_.empty()) {
      const bool what = clause_.mood == "what" && relation_.empty();
      // "Which is the biggest?", not "what colour is the biggest box?"
      const bool of_property = clause_.concepts.contains("colour") || clause_.concepts.contains("size");
      if (what && !of_property &&
          is_superlative(name_[rank_called(name_[0]) > 0 && name_.size() > 1 ? 1 : 0]))
        relation_ = "most";
      // "What is red?", "how many cups are red?"
      const bool of_kind = clause_.mood == "howmany" && relation_.empty() && !clause_.phrases.empty();
      if ((what || of_kind) && name_.size() == 1 && is_color_word(name_[0])) relation_ = "coloured";
      if (!joint_.empty() && relation_.empty()) relation_ = joint_;
      const bool coloured = clause_.mood == "yes" && name_.size() > 1 && is_color_word(name_.back());
      const std::string colour = coloured ? name_.back() : "";
      if (coloured) name_.pop_back();
      if (is_fruit()) name_ = {"oranges"};
      clause_.phrases.push_back({relation_, join_words(name_, 0, name_.size()), joint_});
      if (coloured) clause_.phrases.push_back({"coloured", colour});  // "is the pot grey"
      relation_.clear();                                              // it stays across articles
      joint_.clear();
    }
    name_.clear();
  }
  void append(const std::string& text) {
    if (name_.empty()) definite_ = next_ > 0 && is_definite(tokens_.words[next_ - 1]);
    name_.push_back(text);
  }
  static bool is_definite(const std::string& word) {
    static const WordSet words = {"the", "a", "an", "my", "our", "your"};
    return words.contains(word);
  }
  /// "An orange" alone does not mean the colour.
  bool is_fruit() const { return definite_ && name_.size() == 1 && name_[0] == "orange"; }
  bool add_concept(const std::string& one) {
    if (!name_.empty() && name_.back().ends_with("'s")) name_.back().resize(name_.back().size() - 2);
    close();
    relation_.clear();
    joint_.clear();
    if (clause_.concepts.empty() && !clause_.phrases.empty()) clause_.marks.insert("subject");
    (kLight.contains(one) ? clause_.marks : clause_.concepts).insert(one);
    if (is_of_staying(word())) clause_.marks.insert("stays");
    return true;
  }

  bool take() {
    const std::string& one = lemma();
    const bool after_person = after_person_;
    if (class_of(one) != WordClass::empty) after_person_ = false;
    // "the purple can", not "the bowl can be"
    const bool has_verb = clause_.marks.contains("may") || next_word() != "be";
    if (one == "may" && word() == "can" && !name_.empty() && class_of(lemma(1)) != WordClass::person &&
        has_verb)
      return take_name();
    if (word() == "one" && previous() == "may") {  // "where could one see it"
      clause_.marks.insert("person");
      return true;
    }
    if (one == "longest" && is_of_time()) return add_concept("longesttime");
    if (one == "this" || one == "that") return take_demonstrative();
    if (one == "there") return take_there();
    if (is_pronoun(one)) return take_pronoun();
    switch (class_of(one)) {
      case WordClass::question:
        return take_question();
      case WordClass::auxiliary:
        return take_auxiliary();
      case WordClass::person:
        close();
        clause_.marks.insert("person");
        if (!began()) {
          clause_.mood = "order";
          clause_.marks.insert("says");
        }
        after_person_ = true;
        return true;
      case WordClass::article:
        close();
        if (one == "any" || one == "some" || one == "a" || one == "an") clause_.marks.insert("any");
        return true;
      case WordClass::empty:
        close();
        if (one == "anymore") clause_.marks.insert(one);
        return true;
      case WordClass::relation:
        return take_relation();
      case WordClass::ordinary:
        return false;
      case WordClass::name:
        break;
    }
    if (one == "before" || one == "afterwards") {
      if (take_order()) return true;
      if (one == "afterwards") return false;
    }
    if (is_concept(one)) return take_concept();
    // After a person comes a verb; this is one that no rule knows.
    if (after_person && !clause_.marks.contains("have")) return false;
    return take_name();
  }

  /// "Which has been on the table the longest?", not "the longest spoon".
  bool is_of_time() const {
    const WordClass next = class_of(lemma(1));
    const bool stays = clause_.marks.contains("been") || clause_.marks.contains("stand");
    return lemma(1).empty() || next == WordClass::auxiliary || (stays && next == WordClass::relation);
  }

  /// "before the table", "before it came to the table".
  bool take_order() {
    const std::string& next = next_meaning();
    if (is_pronoun(next)) {
      add_concept(lemma());
      while (!is_pronoun(lemma())) ++next_;
      return true;
    }
    if (!is_name(next)) return false;
    close();
    relation_ = lemma() == "before" ? "before" : "after";
    return true;
  }

  bool take_question() {
    // "How much cups" asks for a number, "how much milk" for an amount.
    const bool number = lemma() == "howmany" || (lemma() == "howmuch" && lemma(1).ends_with('s'));
    const std::string mood = lemma() == "which" ? "what" : number ? "howmany" : lemma();
    close();
    const bool relative = (lemma() == "which" || lemma() == "who" || mood == "what") && next_ > 0 &&
                          !clause_.mood.empty() && clause_.mood != "bare";
    if (relative) return true;
    // "Is the jam on the shelf where it was?" does not ask where it is.
    if (mood == "where" && clause_.mood == "yes" && !clause_.phrases.empty()) return false;
    if (!clause_.mood.empty() && clause_.mood != "yes" && clause_.mood != "order")
      return add_concept(lemma());
    clause_.mood = mood;
    if (mood == "what") relation_ = "which";
    return true;
  }

  bool take_auxiliary() {
    close();
    relation_.clear();
    joint_.clear();
    if (lemma() == "will") return add_concept("future");
    if (lemma() == "do" && clause_.mood == "what" && lemma(1).empty()) return add_concept("act");
    if (clause_.mood.empty() && clause_.phrases.empty() && clause_.concepts.empty()) clause_.mood = "yes";
    clause_.marks.insert(lemma());
    return true;
  }

  bool take_demonstrative() {
    const std::string& next = lemma(1);
    static const WordSet claims = {"know", "think", "sure", "say", "howsure", "see"};
    static const WordSet things = {"thing", "everything", "room"};
    const bool claimed =
        clause_.mood == "howsure" || clause_.marks.contains("sure") || clause_.marks.contains("think");
    if (lemma() == "that" && claimed && class_of(previous()) == WordClass::auxiliary) return true;
    if (lemma() == "that" && (!name_.empty() || claims.contains(previous()) || previous() == "someone" ||
                              things.contains(previous()))) {
      // "The cup that was on the table" is none that is there now.
      static const WordSet past = {"stood", "sat",   "lay",         "left",    "came",
                                   "went",  "moved", "disappeared", "vanished"};
      const bool ended = next == "was" || next == "had" || next == "did" ||
                         (next_ + 1 < tokens_.words.size() && past.contains(tokens_.words[next_ + 1]));
      if (!name_.empty() && !clause_.mood.empty() && clause_.mood != "bare" && ended) return false;
      close();
      return true;
    }
    if (is_name(next)) {
      close();
      append(word());
      return true;
    }
    if (next == "room") return true;
    return take_name();
  }

  bool take_there() {
    // "there on the table"
    if (kAtRelations.contains(lemma(1)) && relation_.empty()) {
      close();
      return true;
    }
    // "Has the milk been there?" means the place.
    const bool existential = (class_of(previous()) == WordClass::auxiliary && previous() != "been") ||
                             class_of(lemma(1)) == WordClass::auxiliary;
    const bool after_relation = kAtRelations.contains(relation_);
    close();
    if (existential && !after_relation) {
      clause_.marks.insert("there");
      return true;
    }
    clause_.phrases.push_back({after_relation && relation_ == "in" ? "in" : "at", "there"});
    relation_.clear();
    return true;
  }

  /// "and", "or".
  bool take_joint() {
    close();
    if (!began()) return true;
    const std::string& next = next_meaning();
    const bool place = class_of(next) == WordClass::relation;
    if (!place && !is_name(next) && !is_pronoun(next) && next != "this" && next != "that")
      return add_concept(lemma());
    relation_.clear();
    joint_ = lemma();
    return true;
  }

  bool take_relation() {
    if (lemma() == "and" || lemma() == "or") return take_joint();
    const bool open = !name_.empty();
    const std::string& next = next_meaning();
    const bool names = is_name(next) || is_pronoun(next) || next == "this" || next == "that" ||
                       next == "there" || next == "room" || next == "thing";
    if (lemma() == "of" && open && names && relation_ != "within") {
      append(word());
      return true;
    }
    close();
    const bool known = lemma() == "of" && previous() == "know";
    if (lemma() == "of" && !known && !clause_.phrases.empty() && !names) return add_concept("of");
    if (next == "someone") return true;  // "by someone", "to me"
    if (lemma() == "with" && class_of(lemma(1)) == WordClass::article && lemma(2).empty()) {
      ++next_;  // "with her"
      return true;
    }
    if (names) {
      if (lemma() != "of") relation_ = lemma();
      return true;
    }
    // "about the location of the jam", "do you know of"
    static const WordSet nouns = {"location", "state", "content", "colour", "size", "history"};
    if (nouns.contains(next) || known) return true;
    static const WordSet particles = {"on", "in", "at", "to", "into", "over"};
    if (particles.contains(lemma()) || lemma() == "about" ||
        (lemma() == "near" && (word() == "around" || word() == "about"))) {
      clause_.marks.insert("stranded");
      return true;
    }
    if (class_of(next) == WordClass::question) return true;
    return add_concept(lemma());
  }

  bool take_concept() {
    std::string one = lemma();
    if (word() == "anything" || word() == "something") clause_.marks.insert("any");
    if (word() == "place" && !began()) one = "put";
    if (word() == "spot" && clause_.marks.contains("person")) one = "see";
    const bool next_is_name = is_name(lemma(1)) && !is_number(lemma(1));
    if (is_superlative(word()) && next_is_name && class_of(previous()) == WordClass::article)
      return append(word()), true;  // "the bigger cup"
    if (one == "thing" && clause_.mood == "yes" && !clause_.phrases.empty() && has_inverse(relation_)) {
      clause_.phrases.push_back({relation_, word()});  // "is the cup behind something"
      clause_.marks.insert("something");
      relation_.clear();
      return true;
    }
    if (one == "thing" || one == "everything") {
      const bool phrase = clause_.mood == "order" && class_of(previous()) == WordClass::article;
      if (one == "thing" && (!name_.empty() || phrase)) return append(word()), true;
      if (next_is_name) {  // "anything yellow", "object jam"
        return true;
      }
    }
    if (word() == "never") clause_.marks.insert("never");
    if (word() == "different" && (next_is_name || lemma(1) == "thing")) return true;
    if (word() == "always" && clause_.mood != "where") one = "throughout";
    if (one == "every" && (clause_.mood == "what" || clause_.mood == "howmany" || clause_.mood == "order"))
      return true;
    if (one == "room") {
      if (next_is_name || !name_.empty()) return append(word()), true;
      if (kAtRelations.contains(relation_) || relation_ == "near") {
        relation_.clear();
        clause_.marks.insert("room");
        return true;
      }
    }
    // "Isn't the milk on the table?" asks whether it is.
    if (one == "not" && clause_.mood == "yes" && clause_.phrases.empty() && clause_.concepts.empty() &&
        name_.empty() && word() == "not")
      return true;
    if (clause_.mood.empty() && clause_.phrases.empty() && name_.empty() && is_order(one))
      clause_.mood = "order";
    return add_concept(one);
  }

  bool take_pronoun() {
    // "Where do they keep it?"
    static const WordSet deeds = {"keep", "put", "leave", "take", "move", "have"};
    if (lemma() == "they" && deeds.contains(lemma(1)) && clause_.phrases.empty()) {
      clause_.marks.insert("person");
      return true;
    }
    const bool after_auxiliary = class_of(previous()) == WordClass::auxiliary;
    const bool named = !clause_.phrases.empty() && clause_.phrases[0].relation.empty();
    if (lemma() == "it" && named && after_auxiliary && clause_.mood == "bare") return true;
    // "The milk, is it on the table?", "does it exist a banana", "it was tea"
    const bool formal =
        lemma(1) == "exist" || (!began() && class_of(lemma(1)) == WordClass::auxiliary &&
                                (class_of(lemma(2)) == WordClass::article || is_name(lemma(2))));
    if (lemma() == "it" && (formal || (named && after_auxiliary && clause_.concepts.empty()))) {
      if (formal) clause_.marks.insert("there");
      return true;
    }
    // "has something in it", "which drawer has the cup in it"
    if (kAtRelations.contains(relation_) && !clause_.phrases.empty() && lemma() != "they") {
      relation_.clear();
      clause_.marks.insert("inside");
      return true;
    }
    return take_name();
  }

  bool take_name() {
    const bool counts = name_.empty() && is_number(word()) && is_name(lemma(1));
    if (counts && relation_ != "within" && relation_ != "repeated") {
      clause_.phrases.push_back({"count", word()});
      return true;
    }
    append(word());
    return true;
  }

  Tokens tokens_;
  const WordSet& concepts_;
  size_t next_ = 0;
  Clause clause_;
  Words name_;             ///< the phrase that is open
  std::string relation_;   ///< of it
  std::string joint_;      ///< "and" or "or" before it
  bool definite_ = false;  ///< an article is before it
  bool after_person_ = false;
};

/// The reading in which a place belongs to the name before it: "the cup on the table".
std::optional<Clause> with_attached_places(const Clause& clause) {
  // "on the table or on the counter" are two places of one object.
  if (std::ranges::any_of(clause.phrases, [](const Phrase& phrase) {
        return !phrase.joint.empty() && kAtRelations.contains(phrase.relation);
      }))
    return std::nullopt;
  Clause attached = clause;
  attached.phrases.clear();
  for (const Phrase& phrase : clause.phrases) {
    const bool attaches = kAtRelations.contains(phrase.relation) && phrase.text != "there" &&
                          !attached.phrases.empty() &&
                          attached.phrases.back().text.find(" on ") == std::string::npos &&
                          attached.phrases.back().text != "it";
    if (!attaches)
      attached.phrases.push_back(phrase);
    else
      attached.phrases.back().text += (phrase.relation == "in" ? " in " : " on ") + phrase.text;
  }
  return attached.phrases.size() < clause.phrases.size() ? std::optional(attached) : std::nullopt;
}

/// The reading in which names that "and" or "or" joins are one: "the milk and the jam".
std::optional<Clause> with_coordination(const Clause& clause) {
  Clause joined = clause;
  joined.phrases.clear();
  for (const Phrase& phrase : clause.phrases) {
    if (phrase.joint.empty() || joined.phrases.empty()) {
      joined.phrases.push_back(phrase);
      continue;
    }
    Phrase& before = joined.phrases.back();
    if (phrase.relation != phrase.joint && phrase.relation != before.relation) return std::nullopt;
    before.text += " " + phrase.joint + " " + phrase.text;
  }
  for (const Phrase& phrase : clause.phrases)
    if (!phrase.joint.empty()) joined.marks.insert(phrase.joint);
  return joined.phrases.size() < clause.phrases.size() ? std::optional(joined) : std::nullopt;
}

/// "Was the cup on the table …", "did it stay there …": whether a state lasted, not whether it ever was.
bool asks_for_lasting_state(const Clause& clause) {
  static const WordSet lasting = {"keep", "leave"}, others = {"any", "there", "person", "see", "find"};
  const auto is_subject = [](const Phrase& phrase) { return phrase.relation.empty(); };
  const auto is_place = [](const Phrase& phrase) { return kAtRelations.contains(phrase.relation); };
  return (clause.mood == "yes" || clause.mood == "bare") && !clause.marks.contains("may") &&
         std::ranges::none_of(others, [&](const std::string& one) { return clause.marks.contains(one); }) &&
         std::ranges::all_of(clause.concepts,
                             [&](const std::string& one) { return lasting.contains(one); }) &&
         std::ranges::any_of(clause.phrases, is_subject) && std::ranges::any_of(clause.phrases, is_place);
}

std::optional<Clause> read_clause(Words words, const WordSet& concepts, const TimeReader& times) {
  const auto period = cut_time(words, times);
  if (period) strip_surroundings(words);
  if (words.empty() && !period) return std::nullopt;  // "And at noon?" is a time only
  const bool ever = std::ranges::count(words, "ever") > 0;
  auto clause = ClauseReader(tokens_of(words), concepts).read();
  if (!clause) return clause;
  // "Is it staying there" asks for now.
  const bool stays = clause->marks.contains("stays") && !clause->marks.contains("is");
  if (!ever && (stays || (period && period->spans)) && asks_for_lasting_state(*clause))
    clause->concepts.insert(period && !period->from.empty() ? "throughout" : "stays");
  const bool now = period && period->from == "now" && period->to == "now";
  if (!period || (now && clause->concepts.contains("miss"))) return clause;
  clause->period = period;
  clause->marks.insert("time");
  // "Was it there all day" is more than "was it there today", "was it moved all day" is not.
  static const WordSet events = {"move", "change", "happen", "come", "vanish", "take"};
  const bool event =
      std::ranges::any_of(clause->concepts, [](const std::string& one) { return events.contains(one); });
  if (period->throughout && !event &&
      (clause->mood == "yes" || clause->mood == "bare" || clause->mood == "what"))
    clause->concepts.insert("throughout");
  return clause;
}

}  // namespace

std::vector<Clause> parse_clauses(const std::string& sentence, const std::set<std::string>& concepts,
                                  const TimeReader& times) {
  std::vector<Clause> clauses;
  for (Words& words : core_words(sentence, concepts, times)) {
    const auto clause = read_clause(std::move(words), concepts, times);
    if (!clause) continue;
    clauses.push_back(*clause);
    if (auto attached = with_attached_places(*clause)) clauses.push_back(std::move(*attached));
    if (auto coordinated = with_coordination(*clause)) clauses.push_back(std::move(*coordinated));
  }
  return clauses;
}

}  // namespace loci::memory
