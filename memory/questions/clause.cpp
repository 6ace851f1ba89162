#include "memory/questions/clause.h"

#include <algorithm>

#include "mapping/base/text.h"

namespace loci::memory {
namespace {

using WordSet = std::set<std::string>;

const WordSet kPronouns = {"it", "they", "them"};
const WordSet kAtRelations = {"on", "in", "at"};
/// Verbs that begin an order.
const WordSet kOrders = {"show", "list", "name", "give", "describe", "find",      "bring", "fetch",
                         "get",  "put",  "set",  "lay",  "make",     "prepare",   "clean", "empty",
                         "wipe", "stow", "pack", "keep", "take",     "move",      "carry", "hand",
                         "pass", "want", "lose", "tell", "explain",  "summarize", "place"};

bool is_number(const std::string& word) {
  static const WordSet names = {"two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"};
  return names.contains(word) || (!word.empty() && std::ranges::all_of(word, is_digit));
}

// ---- Fragments: what punctuation separates.

std::vector<Words> fragments_of(const std::string& sentence) {
  std::vector<Words> fragments;
  std::string text;
  const auto end = [&] {
    if (Words words = sentence_words(text); !words.empty()) fragments.push_back(std::move(words));
    text.clear();
  };
  for (size_t i = 0; i < sentence.size(); ++i) {
    const char c = sentence[i];
    const bool at_blank = i + 1 == sentence.size() || sentence[i + 1] == ' ';
    const bool dash = c == '-' && i > 0 && sentence[i - 1] == ' ';
    if (c == '?' || c == '!' || c == ',' || c == ';' || (at_blank && (c == '.' || c == ':' || dash)))
      end();
    else
      text.push_back(c);
  }
  end();
  return fragments;
}

bool all_in(const Words& lemmas, const WordSet& set) {
  return std::ranges::all_of(lemmas, [&](const std::string& lemma) { return set.contains(lemma); });
}

/// "Excuse me", "thanks", "robot", "please".
bool is_polite(const Tokens& tokens) {
  static const WordSet words = {"excuse",  "someone",   "thanks", "thank",   "please", "hello",  "hi",
                                "hey",     "sorry",     "ok",     "okay",    "dear",   "good",   "morning",
                                "evening", "afternoon", "day",    "well",    "so",     "right",  "yes",
                                "quick",   "question",  "a",      "one",     "more",   "listen", "pardon",
                                "and",     "now",       "then",   "correct", "by",     "the",    "near",
                                "way",     "hmm",       "um",     "oh",      "not",    "no",     "tell",
                                "if",      "may",       "do",     "think",   "know"};
  return all_in(tokens.lemmas, words);
}

/// "isn't it", "was there", "or not": the end of a statement that asks whether it is so.
bool is_tag(const Tokens& tokens) {
  static const WordSet words = {"is",  "was", "do",   "did",   "have",    "had",
                                "not", "it",  "they", "there", "someone", "or"};
  return all_in(tokens.lemmas, words) &&
         (class_of(tokens.lemmas[0]) == WordClass::auxiliary || tokens.lemmas[0] == "or");
}

/// "The second drawer", "about the milk": names alone.
bool is_topic(const Tokens& tokens, const WordSet& concepts) {
  static const WordSet introductions = {"about", "as", "for", "and", "mean", "someone"};
  bool named = false;
  for (const std::string& lemma : tokens.lemmas) {
    const WordClass word_class = class_of(lemma);
    const bool name =
        word_class == WordClass::name && !concepts.contains(lemma) && !kPronouns.contains(lemma);
    named = named || name;
    if (!name && word_class != WordClass::article && (named || !introductions.contains(lemma))) return false;
  }
  return named;
}

/// Puts a phrase in the place of the first "it"; false when there is none.
bool replace_pronoun(Words& words, const Words& topic) {
  const auto it =
      std::ranges::find_if(words, [](const std::string& word) { return kPronouns.contains(word); });
  if (it == words.end()) return false;
  replace_words(words, static_cast<size_t>(it - words.begin()), 1, topic);
  return true;
}

/// The sentence as one sequence of words: fragments that only make it polite are left out, and a topic takes
/// the place of the pronoun that stands for it: "The second drawer, when was it opened?"
Words joined_fragments(const std::vector<Words>& fragments, const WordSet& concepts) {
  std::vector<Words> parts;
  for (const Words& fragment : fragments) {
    const Tokens of_fragment = tokens_of(fragment);
    const bool alone = fragments.size() == 1;
    if (!alone && (is_polite(of_fragment) || (is_tag(of_fragment) && !parts.empty()))) continue;
    parts.push_back(fragment);
  }
  // "If the milk is not on the table, where else may it be?"
  if (parts.size() > 1 && parts[0][0] == "if" && std::ranges::count(parts[0], "not") > 0)
    parts[0] = Words(parts[0].begin() + 1, std::ranges::find_if(parts[0], [](const std::string& word) {
                       return word == "is" || word == "are";
                     }));
  for (size_t i = 0; i < parts.size() && parts.size() > 1; ++i) {
    if (!is_topic(tokens_of(parts[i]), concepts)) continue;
    for (size_t j = 0; j < parts.size(); ++j)
      if (j != i && replace_pronoun(parts[j], parts[i])) {
        parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
        break;
      }
  }
  Words words;
  for (const Words& part : parts) words.insert(words.end(), part.begin(), part.end());
  return words;
}

// ---- Politeness.

/// Removes what comes before an embedded question: "could you tell me", "I was wondering", "any idea".
void strip_wrapper(Words& words) {
  static const WordSet wrapper = {
      "someone",   "is",         "was",      "been",    "may",    "will",        "do",       "did",
      "have",      "had",        "want",     "know",    "ask",    "asking",      "wonder",   "wondering",
      "curious",   "interested", "find",     "out",     "figure", "work",        "try",      "trying",
      "to",        "remember",   "not",      "sure",    "like",   "love",        "forget",   "forgot",
      "forgotten", "tell",       "help",     "think",   "idea",   "clue",        "any",      "near",
      "chance",    "say",        "look",     "confirm", "see",    "up",          "explain",  "of",
      "about",     "as",         "in",       "on",      "hope",   "hoping",      "possible", "able",
      "mind",      "telling",    "question", "my",      "it",     "there",       "a",        "the",
      "an",        "happen",     "show",     "remind",  "give",   "let",         "true",     "case",
      "correct",   "right",      "what",     "and",     "but",    "so",          "well",     "hint",
      "need",      "inform",     "quickly",  "clear",   "yet",    "also",        "please",   "just",
      "really",    "possibly",   "hello",    "hi",      "hey",    "excuse",      "sorry",    "ok",
      "okay",      "kind",       "enough",   "memory",  "your",   "for",         "perhaps",  "maybe",
      "kindly",    "actually",   "known",    "this",    "would",  "information", "report",   "state",
      "empty",     "point"};
  static const WordSet claims = {"think", "true",    "case", "correct", "right",
                                 "say",   "confirm", "know", "tell",    "sure"};
  const Tokens tokens = tokens_of(words);
  bool claimed = false, stated = false;
  for (size_t i = 0; i < tokens.lemmas.size(); ++i) {
    const std::string& lemma = tokens.lemmas[i];
    const bool bridge = lemma == "if" || lemma == "whether" || (lemma == "that" && claimed);
    const bool question = class_of(lemma) == WordClass::question;
    if (stated && (bridge || question)) {
      words.assign(tokens.words.begin() + static_cast<std::ptrdiff_t>(bridge ? i + 1 : i),
                   tokens.words.end());
      return;
    }
    if (!wrapper.contains(lemma) || (question && lemma != "what")) return;
    claimed = claimed || claims.contains(lemma);
    stated = stated || class_of(lemma) != WordClass::relation;
  }
}

/// Removes openings and endings that ask nothing: "tell me", "for me", "do you know".
void strip_politeness(Words& words) {
  static const std::vector<Words> openings = expand_form(
      "(can|could|would|will) you [please|kindly] (tell|give|show|list|name|bring|put|find|describe)|tell "
      "me|remind me|let me know|"
      "robot|hey|hello|hi|dear|excuse me|sorry|ok|okay|well|so|and|but|please|thanks|"
      "if|whether|[are you|i am|am i] (sure|certain|right|correct) [that|in thinking that]|is it "
      "(true|correct|right) "
      "that|"
      "(i|we) (think|believe|guess|suppose|reckon) [that]|do you (think|believe|reckon) [that]|"
      "do you happen to|did you happen to|by any chance|by chance");
  static const std::vector<Words> endings = expand_form(
      "for me|robot|thanks|thank you|as well|too|by [any] chance|exactly|or "
      "not|if you (know|remember)|"
      "please|to your knowledge|as far as you (know|remember)|according to (you|your memory)|can you "
      "(tell|say)|"
      "would you (know|say)|then|again|in total|altogether|overall|of yours|of mine|at once");
  for (bool stripped = true; stripped;) {
    stripped = false;
    for (const Words& opening : openings) {
      if (words.size() <= opening.size() || !starts_with_words(words, opening)) continue;
      const std::string& next = words[opening.size()];
      if (opening.back() == "me" && opening.front() == "tell" &&
          (next == "about" || next == "everything" || next == "more" || next == "what"))
        continue;
      // "Could you bring": the order itself stays.
      const bool order = opening.size() > 2 && opening[1] == "you" && kOrders.contains(opening.back());
      replace_words(words, 0, opening.size() - (order ? 1 : 0), {});
      stripped = true;
      break;
    }
    for (const Words& ending : endings)
      if (!stripped && words.size() > ending.size() &&
          starts_with_words(words, ending, words.size() - ending.size())) {
        words.resize(words.size() - ending.size());
        stripped = true;
      }
  }
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
    if (clause_.mood.empty()) clause_.mood = "bare";
    // "Got moved" is "was moved".
    if (clause_.concepts.size() > 1) clause_.concepts.erase("get");
    return clause_;
  }

 private:
  const std::string& lemma(size_t ahead = 0) const {
    static const std::string none;
    return next_ + ahead < tokens_.lemmas.size() ? tokens_.lemmas[next_ + ahead] : none;
  }
  const std::string& word() const { return tokens_.words[next_]; }
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
    static const WordSet superlatives = {"biggest", "largest", "smallest", "tallest"};
    if (!name_.empty()) {
      if (relation_.empty() && clause_.mood == "what" && superlatives.contains(name_[0])) relation_ = "most";
      clause_.phrases.push_back({relation_, join_words(name_, 0, name_.size())});
    }
    if (!name_.empty()) relation_.clear();  // it stays across articles
    name_.clear();
  }
  void append(const std::string& text) { name_.push_back(text); }
  bool add_concept(const std::string& one) {
    if (!name_.empty() && name_.back().ends_with("'s")) name_.back().resize(name_.back().size() - 2);
    close();
    relation_.clear();
    if (clause_.concepts.empty() && !clause_.phrases.empty()) clause_.marks.insert("subject");
    clause_.concepts.insert(one);
    return true;
  }

  bool take() {
    const std::string& one = lemma();
    const bool after_person = after_person_;
    if (class_of(one) != WordClass::empty) after_person_ = false;
    // "A can" is one; "can" alone is not a name.
    const bool can_of = class_of(previous()) == WordClass::article ||
                        (!name_.empty() && class_of(lemma(1)) != WordClass::person && lemma(1) != "is");
    if (word() == "can" && can_of) return take_name();
    if (one == "this" || one == "that") return take_demonstrative();
    if (one == "there") return take_there();
    if (kPronouns.contains(one)) return take_pronoun();
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
        return true;
      case WordClass::relation:
        return take_relation();
      case WordClass::ordinary:
        return false;
      case WordClass::name:
        break;
    }
    if (is_concept(one)) return take_concept();
    // After a person comes a verb; this is one that no rule knows.
    if (after_person && !clause_.marks.contains("have")) return false;
    return take_name();
  }

  bool take_question() {
    // "How much cups" asks for a number, "how much milk" for an amount.
    const bool number = lemma() == "howmany" || (lemma() == "howmuch" && lemma(1).ends_with('s'));
    const std::string mood = lemma() == "which" ? "what" : number ? "howmany" : lemma();
    close();
    const bool relative = (lemma() == "which" || lemma() == "who" || mood == "what") && next_ > 0 &&
                          !clause_.mood.empty() && clause_.mood != "bare";
    if (relative) return true;
    if (!clause_.mood.empty() && clause_.mood != "yes" && clause_.mood != "order")
      return add_concept(lemma());
    clause_.mood = mood;
    if (mood == "what") relation_ = "which";
    return true;
  }

  bool take_auxiliary() {
    close();
    relation_.clear();
    if (lemma() == "will") return add_concept("future");
    if (lemma() == "do" && clause_.mood == "what" && lemma(1).empty()) return add_concept("act");
    if (clause_.mood.empty() && clause_.phrases.empty() && clause_.concepts.empty()) clause_.mood = "yes";
    clause_.marks.insert(lemma());
    return true;
  }

  bool take_demonstrative() {
    const std::string& next = lemma(1);
    static const WordSet claims = {"know", "think", "sure", "say", "howsure", "see"};
    if (lemma() == "that" && (!name_.empty() || claims.contains(previous()) || previous() == "someone")) {
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
    const bool existential =
        class_of(previous()) == WordClass::auxiliary || class_of(lemma(1)) == WordClass::auxiliary;
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

  bool take_relation() {
    const bool open = !name_.empty();
    const std::string& next = next_meaning();
    const bool names = is_name(next) || kPronouns.contains(next) || next == "this" || next == "that" ||
                       next == "there" || next == "room" || next == "thing";
    if (lemma() == "of" && open && names && relation_ != "within") {
      append(word());
      return true;
    }
    close();
    const bool known = lemma() == "of" && previous() == "know";
    if (lemma() == "of" && !known && !clause_.phrases.empty() && !names) return add_concept("of");
    if (next == "someone") return true;  // "by someone", "to me"
    if (names) {
      if (lemma() == "and" && !began()) return true;
      if (lemma() != "of") relation_ = lemma();
      return true;
    }
    if (lemma() == "and" && !began()) return true;
    // "about the location of the jam", "do you know of"
    static const WordSet nouns = {"location", "state", "content", "colour", "size", "history"};
    if (nouns.contains(next) || known) return true;
    static const WordSet particles = {"on", "in", "at", "to", "into", "over"};
    if (particles.contains(lemma())) {
      clause_.marks.insert("stranded");
      return true;
    }
    if (class_of(next) == WordClass::question) return true;
    return add_concept(lemma());
  }

  bool take_concept() {
    std::string one = lemma();
    if (word() == "place" && !began()) one = "put";
    if (word() == "spot" && clause_.marks.contains("person")) one = "see";
    const bool next_is_name = is_name(lemma(1)) && !is_number(lemma(1));
    if (one == "thing" || one == "everything") {
      const bool phrase = clause_.mood == "order" && class_of(previous()) == WordClass::article;
      if (one == "thing" && (!name_.empty() || phrase)) return append(word()), true;
      if (next_is_name) {  // "anything yellow", "object jam"
        if (word() == "anything" || word() == "something") clause_.marks.insert("any");
        return true;
      }
    }
    if (word() == "different" && (next_is_name || lemma(1) == "thing")) return true;
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
    if (clause_.mood.empty() && clause_.phrases.empty() && name_.empty() && kOrders.contains(one))
      clause_.mood = "order";
    return add_concept(one);
  }

  bool take_pronoun() {
    const bool after_auxiliary = class_of(previous()) == WordClass::auxiliary;
    const bool named = !clause_.phrases.empty() && clause_.phrases[0].relation.empty();
    if (lemma() == "it" && named && after_auxiliary && clause_.mood == "bare") return true;
    // "The milk, is it on the table?", "does it exist a banana", "it was tea"
    const bool formal =
        lemma(1) == "exist" || (!began() && class_of(lemma(1)) == WordClass::auxiliary &&
                                class_of(lemma(2)) == WordClass::name && !is_concept(lemma(2)));
    if (lemma() == "it" && (formal || (named && after_auxiliary && clause_.concepts.empty()))) {
      if (formal) clause_.marks.insert("there");
      return true;
    }
    // "has something in it", "which drawer has the cup in it"
    if (kAtRelations.contains(relation_) && !clause_.phrases.empty() && lemma() == "it") {
      relation_.clear();
      clause_.marks.insert("inside");
      return true;
    }
    return take_name();
  }

  bool take_name() {
    const bool counts = name_.empty() && is_number(word()) && is_name(lemma(1));
    if (counts && relation_ != "within") return add_concept("quantity");
    append(word());
    return true;
  }

  Tokens tokens_;
  const WordSet& concepts_;
  size_t next_ = 0;
  Clause clause_;
  Words name_;            ///< the phrase that is open
  std::string relation_;  ///< of it
  bool after_person_ = false;
};

/// The reading in which a place belongs to the name before it: "the cup on the table".
std::optional<Clause> with_attached_places(const Clause& clause) {
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

std::optional<Clause> read_clause(Words words, const WordSet& concepts, const TimeReader& times) {
  const auto period = cut_time(words, times);
  strip_politeness(words);
  strip_wrapper(words);
  strip_politeness(words);
  if (words.empty()) return std::nullopt;
  auto clause = ClauseReader(tokens_of(words), concepts).read();
  if (!clause || !period) return clause;
  clause->period = period;
  clause->marks.insert("time");
  // "Was it there all day" is more than "was it there today".
  if (period->throughout && (clause->mood == "yes" || clause->mood == "bare"))
    clause->concepts.insert("throughout");
  return clause;
}

/// The last of several clauses, with what the first is about for "it": "I need the milk. Where is it?"
std::optional<Clause> last_clause(const std::vector<Words>& fragments, const WordSet& concepts,
                                  const TimeReader& times) {
  if (fragments.size() < 2) return std::nullopt;
  const auto first = read_clause(fragments.front(), concepts, times);
  Words words = fragments.back();
  if (!first || first->phrases.empty() || !replace_pronoun(words, words_of(first->phrases.front().text)))
    return std::nullopt;
  return read_clause(words, concepts, times);
}

}  // namespace

std::vector<Clause> parse_clauses(const std::string& sentence, const std::set<std::string>& concepts,
                                  const TimeReader& times) {
  std::vector<Clause> clauses;
  const std::vector<Words> fragments = fragments_of(sentence);
  size_t count = 0;
  for (const Words& words : fragments) count += words.size();
  if (count > kMaxSentenceWords) return clauses;
  for (const auto& clause : {read_clause(joined_fragments(fragments, concepts), concepts, times),
                             last_clause(fragments, concepts, times)}) {
    if (!clause) continue;
    clauses.push_back(*clause);
    if (auto attached = with_attached_places(*clause)) clauses.push_back(std::move(*attached));
  }
  return clauses;
}

}  // namespace loci::memory
