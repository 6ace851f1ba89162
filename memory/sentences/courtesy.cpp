#include "memory/sentences/courtesy.h"

#include <algorithm>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/sentences/spelling.h"
#include "memory/sentences/vocabulary.h"
#include "memory/sentences/word_forms.h"

namespace loci::memory {
namespace {

using WordSet = std::set<std::string>;

/// Words with any of these uses.
WordSet words_used(unsigned uses) {
  WordSet all;
  for (const vocabulary::SurroundingWords& one : vocabulary::surroundings())
    if ((one.uses & uses) != 0) all.merge(word_set(one.words));
  return all;
}

/// Without "if", "whether"; a clause about a person asks whether they did: "whether somebody moved it".
void begin_embedded(Words& words, size_t count) {
  const std::string bridge = count > 0 ? words[count - 1] : "";
  replace_words(words, 0, count, {});
  const bool asks = bridge == "if" || bridge == "whether" || bridge == "that";
  if (asks && !words.empty() && class_of(first_lemma(words)) == WordClass::person)
    words.insert(words.begin(), "did");
}

/// Removes what comes before an embedded question: "could you tell me", "I was wondering", "any idea".
void strip_wrapper(Words& words) {
  static const WordSet wrapper = words_used(vocabulary::kIntroduction);
  static const WordSet claims = words_used(vocabulary::kClaim);
  const Tokens tokens = tokens_of(words);
  bool claimed = false, stated = false;
  for (size_t i = 0; i < tokens.lemmas.size(); ++i) {
    const std::string& lemma = tokens.lemmas[i];
    const bool bridge =
        (lemma == "if" || lemma == "whether" || (lemma == "that" && claimed)) && i + 1 < tokens.lemmas.size();
    const bool question = class_of(lemma) == WordClass::question;
    if (stated && (bridge || (question && !(lemma == "what" && i + 1 == tokens.lemmas.size())))) {
      words = tokens.words;
      begin_embedded(words, bridge ? i + 1 : i);
      return;
    }
    if (!wrapper.contains(lemma) || (question && lemma != "what")) return;
    claimed = claimed || claims.contains(lemma);
    stated = stated || class_of(lemma) != WordClass::relation;
  }
}

/// "My wife swears that ...", "they told me ...": asks whether it is so.
void strip_claim(Words& words) {
  static const WordSet claims = word_set(
      "say says said swear swears swore claim claims claimed insist insists insisted think thinks thought "
      "reckon reckons believe believes believed maintains told tells promised promises suspect suspects "
      "figures assume assumes");
  const auto is_person = [&](size_t i) {
    return words[i] == "they" || class_of(lemma_of(words[i])) == WordClass::person ||
           class_of(lemma_of(words[i])) == WordClass::article;
  };
  size_t verb = 0;
  while (verb < words.size() && is_person(verb)) ++verb;
  if (verb == 0 || verb == words.size() || !claims.contains(words[verb])) return;
  size_t first = verb + 1;
  if ((words[verb] == "told" || words[verb] == "tells") && first < words.size() && is_person(first)) ++first;
  const bool that = first < words.size() && words[first] == "that";
  if (that) ++first;
  if (first + 2 >= words.size() || class_of(lemma_of(words[first])) == WordClass::relation) return;
  words[first - 1] = "that";
  begin_embedded(words, first);
}

/// Removes openings and endings that ask nothing: "tell me", "for me", "do you know".
void strip_politeness(Words& words) {
  static const std::vector<Words> openings = expand_form(
      "(can|could|would|will) you [please|kindly|maybe|perhaps|possibly|just|quickly] "
      "(tell|give|show|list|name|bring|put|find|describe)|tell "
      "me|remind me|let me know|say me|tell us|"
      "[hey|hi|hello|ok|okay|excuse me|listen|so|well] "
      "(robot|computer|assistant|machine|loci|mate|dear|love)|"
      "hey|hello|hi|hiya|excuse me|sorry|ok|okay|well|so|and|but|please|thanks|now then|right|look|listen|"
      "quick question|quick|quickly|just curious|just checking|by the way|between you and me|anyway|good "
      "(morning|evening|afternoon)|"
      "if|whether|[are you|i am|am i] (sure|certain|right|correct) [that|in thinking that]|is it "
      "(true|correct|right|possible|the case) that|"
      "(i|we) (think|believe|guess|suppose|reckon|bet|thought|assume) [that]|do you (think|believe|reckon) "
      "[that]|"
      "(confirm|verify|check|assert) [that|whether|if]|"
      "do you happen to|did you happen to|by any chance|by chance|in your (opinion|memory)|"
      "as far as you (know|remember|can tell)|according to (you|your memory)|to your knowledge");
  static const std::vector<Words> endings = expand_form(
      "for me|for us|robot|computer|dear|mate|love|darling|my (dear|friend)|sir|madam|thanks|thank "
      "you|cheers|"
      "as well|too|by [any] chance|exactly|or "
      "not|yes or no|true or false|right|correct|if you (know|remember|please|can|could)|if possible|"
      "please|to your knowledge|as far as you (know|remember|can tell)|according to (you|your memory)|can "
      "you "
      "(tell|say)|any idea|i wonder|in your (opinion|memory)|"
      "would you (know|say)|then|again|in total|altogether|overall|of yours|of mine|at once|all told|"
      "for sure|for certain|at all|around here|in here|round here|i think|i guess|"
      "(that|which|who) you (know|know of|know about|can see|remember)");
  // A word that nobody knows before a question: "yo, where is the jam".
  if (words.size() > 2 && !is_known_word(words[0]) && !find_pronoun(words) &&
      class_of(first_lemma(Words(words.begin() + 1, words.end()))) == WordClass::question)
    words.erase(words.begin());
  for (bool stripped = true; stripped;) {
    stripped = false;
    for (const Words& opening : openings) {
      if (words.size() <= opening.size() || !starts_with_words(words, opening)) continue;
      const std::string& next = words[opening.size()];
      const std::string& last = opening.back();
      if ((last == "me" || last == "us") && opening.front() != "excuse" &&
          (next == "about" || next == "everything" || next == "more" || next == "what" || next == "some" ||
           next == "a"))
        continue;
      // "Could you bring": the order itself stays.
      const bool order = opening.size() > 2 && opening[1] == "you" && is_order(last);
      const bool doubt = next == "about" || next == "of";  // "are you sure about that"
      if (doubt && std::ranges::count(opening, "sure") + std::ranges::count(opening, "certain") > 0) continue;
      begin_embedded(words, opening.size() - (order ? 1 : 0));
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

}  // namespace

bool is_polite(const Words& words) {
  static const WordSet lemmas = words_used(vocabulary::kAddress | vocabulary::kPolite);
  return all_in(tokens_of(words).lemmas, lemmas);
}

bool is_introduction(const Words& words) {
  static const WordSet verbs = word_set("know remember tell say wonder recall mind ask idea");
  static const WordSet lemmas = [] {
    WordSet all = words_used(~0U);
    all.insert("happen");
    return all;
  }();
  const Tokens tokens = tokens_of(words);
  return all_in(tokens.lemmas, lemmas) && std::ranges::none_of(tokens.lemmas, is_pronoun) &&
         std::ranges::any_of(tokens.words, [](const std::string& word) { return verbs.contains(word); });
}

void strip_surroundings(Words& words) {
  strip_politeness(words);
  strip_claim(words);
  strip_wrapper(words);
  strip_politeness(words);
}

}  // namespace loci::memory
