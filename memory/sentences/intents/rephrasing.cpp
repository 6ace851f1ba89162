#include "memory/sentences/intents/rephrasing.h"
#include "memory/sentences/word_forms.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/lexicon.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

using IsName = std::function<bool(const std::string&)>;

bool is_mark(const std::string& word) {
  static const std::set<std::string> marks = {",", "?", "!", ".", ";"};
  return marks.contains(word);
}

/// Words in lower case; the marks that separate fragments are words of their own.
Words words_and_marks(const std::string& sentence) {
  Words all;
  std::string text;
  const auto end = [&] {
    for (std::string& word : sentence_words(text)) all.push_back(std::move(word));
    text.clear();
  };
  for (size_t i = 0; i < sentence.size(); ++i) {
    const char c = sentence[i];
    const bool at_blank = i + 1 == sentence.size() || is_space(sentence[i + 1]);
    const bool dash = c == '-' && at_blank && i > 0 && is_space(sentence[i - 1]);
    if (c == '?' || c == '!' || c == ',' || c == ';' || dash || (at_blank && (c == '.' || c == ':'))) {
      end();
      all.push_back(c == ':' || dash ? "," : std::string(1, c));
    } else {
      text += c;
    }
  }
  end();
  return all;
}

Words tail_of(const Words& words, size_t first) {
  return {words.begin() + static_cast<std::ptrdiff_t>(first), words.end()};
}

bool is_question_word(const std::string& word) {
  return class_of(lemma_of(word)) == WordClass::question;
}

bool may_begin_question(const std::string& word) {
  return is_question_word(word) || class_of(lemma_of(word)) == WordClass::auxiliary;
}

// ---- Corrections by the speaker.

/// Where a correction begins and what comes after it: "no, sorry,", "scratch that".
struct Correction {
  size_t first = 0, last = 0;
};

std::optional<Correction> find_correction(const Words& words) {
  static const std::vector<Words> all = expand_form(
      "no (sorry|wait)|(sorry|wait|hang on|hold on) no|no [sorry] i mean|sorry i mean|no i meant|or rather|"
      "no rather|scratch that|[no] make that");
  Words plain;
  std::vector<size_t> at;
  for (size_t i = 0; i < words.size(); ++i)
    if (!is_mark(words[i])) {
      plain.push_back(words[i]);
      at.push_back(i);
    }
  for (size_t i = plain.size(); i-- > 0;)
    for (const Words& one : all)
      if (starts_with_words(plain, one, i) && i + one.size() < plain.size())
        return Correction{at[i], at[i + one.size()]};
  return std::nullopt;
}

/// "where is the tea" with "not the tea but the milk", "the milk", "on the shelf" or "where is the milk".
Words corrected(Words before, Words by) {
  while (!before.empty() && is_mark(before.back())) before.pop_back();
  if (by[0] == "not") {
    const auto question = std::ranges::find_if(by, may_begin_question);
    if (question != by.end()) return {question, by.end()};
    const auto again = std::find(by.begin() + std::min<std::ptrdiff_t>(2, std::ssize(by)), by.end(),
                                 by.size() > 1 ? by[1] : "but");
    if (again == by.end()) return before;
    by.erase(by.begin(), again);
  }
  if (may_begin_question(by[0]) || before.empty()) return by;
  // From the last word that begins alike: "on the shelf", "the tea".
  size_t first = before.size();
  for (size_t i = before.size(); i-- > 0 && first == before.size();)
    if (before[i] == by[0]) first = i;
  if (first == before.size() && class_of(lemma_of(by[0])) == WordClass::name) --first;
  before.resize(first);
  before.insert(before.end(), by.begin(), by.end());
  return before;
}

// ---- Constructions.

/// A pattern: words, "a|b" one of them, "a|b?" may be missing, "<x>" any words without a mark, "<x:kind>"
/// words of a kind; "^" and "$" are the ends of a fragment.
class Pattern {
 public:
  Pattern(const char* form, const char* by) : elements_(words_of(form)), by_(words_of(by)) {}

  /// Replaces the first match in the words.
  bool apply(Words& words, const IsName& is_name) const {
    for (size_t first = 0; first < words.size(); ++first) {
      Match match{words, is_name, {}, {}};
      if (!matches(match, 0, first)) continue;
      Words by;
      for (const std::string& word : by_)
        if (word[0] == '<') {
          const auto [begin, end] = match.taken.at(word.substr(1, word.size() - 2));
          for (size_t i = begin; i < end; ++i) by.push_back(words[i]);
        } else {
          by.push_back(word);
        }
      replace_words(words, first, match.end - first, by);
      return true;
    }
    return false;
  }

 private:
  struct Match {
    const Words& words;
    const IsName& is_name;
    std::map<std::string, std::pair<size_t, size_t>> taken;
    size_t end = 0;
  };

  bool matches(Match& match, size_t element, size_t at) const {
    if (element == elements_.size()) return match.end = at, true;
    const std::string& one = elements_[element];
    const Words& words = match.words;
    if (one == "^") return (at == 0 || is_mark(words[at - 1])) && matches(match, element + 1, at);
    if (one == "$") return (at == words.size() || is_mark(words[at])) && matches(match, element + 1, at);
    if (one[0] == '<') return captures(match, element, at);
    const bool optional = one.size() > 1 && one.ends_with('?');
    const Words alternatives = words_of(optional ? one.substr(0, one.size() - 1) : one, "|");
    const bool fits = at < words.size() && std::ranges::count(alternatives, words[at]) > 0;
    if (fits && matches(match, element + 1, at + 1)) return true;
    return optional && matches(match, element + 1, at);
  }

  bool captures(Match& match, size_t element, size_t at) const {
    const std::string inner = elements_[element].substr(1, elements_[element].size() - 2);
    const size_t colon = inner.find(':');
    const std::string kind = colon == std::string::npos ? "" : inner.substr(colon + 1);
    for (size_t end = at + 1; end <= match.words.size() && !is_mark(match.words[end - 1]); ++end) {
      match.taken[inner.substr(0, colon)] = {at, end};
      // What names mean is only asked where the rest fits.
      if (matches(match, element + 1, end) && is_of_kind(match, kind, at, end)) return true;
    }
    return false;
  }

  static bool is_of_kind(const Match& match, const std::string& kind, size_t first, size_t last) {
    const Words& words = match.words;
    const bool single = last == first + 1;
    if (kind.empty()) return true;
    if (kind == "name") {
      const bool article = class_of(lemma_of(words[first])) == WordClass::article;
      return first + (article ? 1 : 0) < last &&
             match.is_name(join_words(words, first + (article ? 1 : 0), last));
    }
    if (kind == "colour") return single && is_color_word(words[first]);
    if (kind == "doing")
      return single && words[first].ends_with("ing") &&
             !wordnet::base_forms(words[first], wordnet::PartOfSpeech::verb).empty();
    if (kind == "noun")
      return single && class_of(lemma_of(words[first])) == WordClass::name &&
             !wordnet::base_forms(words[first], wordnet::PartOfSpeech::noun).empty();
    if (kind == "plural")
      return is_of_kind(match, "noun", first, last) && words[first].ends_with('s') &&
             singular_of(words[first]) != words[first];
    if (kind == "courtesy") return is_courtesy(words, first, last);
    return kind == "matrix" && is_matrix(match, first, last);
  }

  /// "it is not too much trouble", "you do not mind": what restricts nothing.
  static bool is_courtesy(const Words& words, size_t first, size_t last) {
    static const std::set<std::string> all = [] {
      const Words some = words_of(
          "it this that you i we are is am was were be not no would do does may might can could too so very "
          "much great big any a of the all to me us ask mind bother trouble imposition inconvenience "
          "problem fine alright ok okay right possible kind good please like wrong mistaken remember recall "
          "happen know allowed convenient with correctly rightly");
      return std::set<std::string>(some.begin(), some.end());
    }();
    return std::all_of(words.begin() + static_cast<std::ptrdiff_t>(first),
                       words.begin() + static_cast<std::ptrdiff_t>(last),
                       [](const std::string& word) { return all.contains(word); });
  }

  /// "Perhaps you could enlighten me as to": persons who want to know something, and no name.
  static bool is_matrix(const Match& match, size_t first, size_t last) {
    bool person = false;
    for (size_t i = first; i < last; ++i) {
      const std::string& word = match.words[i];
      person = person || word == "me" || word == "us" || word == "i" || word == "we" || word == "you";
      if (is_household_noun(word) || is_pronoun(word) || match.is_name(word)) return false;
    }
    return person;
  }

  Words elements_, by_;
};

bool apply_all(const std::vector<Pattern>& patterns, Words& words, const IsName& is_name) {
  bool changed = false;
  for (const Pattern& pattern : patterns) changed = pattern.apply(words, is_name) || changed;
  return changed;
}

/// What readers would take for less than it says.
const std::vector<Pattern>& meanings() {
  static const std::vector<Pattern> all = {
      {"have|has|had|would <x> by now", "have <x>"},
      {"^ what|which <x> on|in|at <p:name> together|along with <y:name> $",
       "what <x> on <p> when <y> was on <p>"},
      // "What was it that I put on the table?"
      {"what is|was it that? i|we|you had <x>", "what was <x>"},
      {"^ what is|was it that? i|we|you|someone|somebody <x>", "what did someone <x>"},
      {"^ where is|was it that? i|we|you|someone|somebody <x>", "where did someone <x>"},
      {"^ when is|was it that? i|we|you|someone|somebody <x>", "when did someone <x>"},
      // What changed since then.
      {"^ what|anything is? different|changed from|than|to <t> $", "what changed since <t>"},
      {"^ is|are everything|all still? where|as it|they was|were <t> $", "was nothing moved since <t>"},
      {"^ does everything|it|the? kitchen|room? still? look the same as <t> $",
       "was nothing moved since <t>"},
      // What was there then and is not now.
      {"^ what|which is|are not on|in|at <p:name> any? more|anymore that|which was|were there <t> $",
       "what was on <p> <t> that is gone now"},
      {"^ what|which is|are missing|gone from|on|in <p:name> compared with|to <t> $",
       "what was on <p> at <t> that is gone now"},
      // What is there now and was not then.
      {"^ what|which <x> on|in|at <p:name> that|which was|were not there|here <t> $",
       "what newsince is on <p> <t>"},
      {"^ compared with|to <t> , what is|are new on|in|at <p:name> $", "what newsince is on <p> at <t>"},
      {"^ what is|are new on|in|at <p:name> compared with|to <t> $", "what newsince is on <p> at <t>"},
      {"^ <x:name> total|count|tally $", "how many <x>"},
      {"^ <x:name> on|in|at <p:name> , total|count|tally|number $", "how many <x> are on <p>"},
      // What was the last state that is asked about.
      {"^ the? last time that? <x> was|were open|opened ,? what was|were in it|them|there $",
       "what was in <x> when <x> was last opened"},
      {"^ which|what is|was closer|nearer to <y:name> , <a:name> or <b:name> $",
       "is <y> nearer to <a> or to <b>"},
      {"^ give|state|name|report|tell the? interval|period|time|window|moment during|in|at? which <x>",
       "when did <x>"},
      // Which one of that name: "the cup, the red one, where is it?"
      {"the|my <x:name> , the <c:colour> one , <z>", "the <c> <x> , <z>"},
      {"the|my <x:name> , the <c:colour> one $", "the <c> <x>"},
      {"the|my <x:name> , the one that? is? in|inside <p:name> , <z>", "the <x> in <p> , <z>"},
      {"the|my <x:name> , the one that? is? on|at <p:name> , <z>", "the <x> on <p> , <z>"},
      {"^ has|have <p:name> stayed|remained put", "was <p> never moved"},
      {"^ has|have <p:name> stayed|remained|been left? where it|they was|were $", "was <p> never moved"},
      {"^ has|have <p:name> stayed|remained|been left? where i|we|someone left|put it|them $",
       "was <p> never moved"},
      {"^ has|have <p:name> stayed|remained|been left? where i|we|someone left|put it|them at|in <t> $",
       "was <p> never moved since <t>"},
      // What is left out of what is asked about.
      {"^ never mind|ignoring|ignore|forget|disregarding <x:name> .|, what else? <y> $",
       "what <y> except <x>"},
      {"something|anything else|other than <x:name> on|at <p:name>", "anything on <p> except <x>"},
      {"something|anything else|other than <x:name> in|inside <p:name>", "anything in <p> except <x>"},
      {"^ did <p:name> stay|remain put", "was <p> never moved"},
      {"^ <x> , <c> included|including $", "<x>"},
      {"^ <x> , including <c:name> $", "<x>"},
      // Which of two did it more often.
      {"^ which|what <x> more|most often , <a:name> or <b:name> $", "which of <a> and <b> <x> most often"},
      // What has an own question.
      {"which|what <x:name> disappeared|vanished|left and|but came|returned back? $", "which <x> came back"},
      {"be seen|found right? now|currently", "be seen"},
      {"the|my|our dark <n:noun>", "the black <n>"},
      {"^ where should|could|can i|we look|search|check $", "where should i look for it"},
      {"^ since when do|have|had i|we have|had|got? a|an|any|some <x:name> $", "when was the <x> first seen"},
      {"^ since when is|are there a|an|any <x:name> $", "when was the <x> first seen"},
      {"^ from which|what <n:noun> did|has|was <x:name> come|came|taken|moved|go $",
       "where did <x> come from"},
      {"^ which|what <n:noun> did|has|was <x:name> come|came|taken from $", "where did <x> come from"},
      {"moved|handled|used|touched the? most $", "moved most often"},
      {"opened the? most $", "opened most often"},
      {"^ when was the? last time that? anything|something <x>", "when did something <x> last"},
      {"^ how long has|have|had|was|were <x:name> been? out $", "how long was <x> there"},
      {"^ next to|beside|near which object|objects|thing|things is|are|was|were <x:name> $",
       "what is next to <x>"},
      // A choice of places: where it is, or was.
      {"^ where do|can|could|should i|we find <x:name> , <p> or <q> $", "where is <x>"},
      {"^ where is|are <x:name> , <p> or <q> $", "where is <x>"},
      {"^ where was|were <x:name> <t> , <p> or <q> $", "where was <x> <t>"},
      {"^ was|were <x:name> in|on|at <a:name> or in|on|at? <b:name> <t> $", "where was <x> <t>"},
      // How much room there is nobody measures; what takes it up is known.
      {"^ is there still? any|enough|some? space|room left|free? on|at <p:name> $", "what is on <p>"},
      {"^ is there still? any|enough|some? space|room left|free? in|inside <p:name> $", "what is in <p>"},
      {"^ which|what place|places|surface|surfaces|spot|spots is|are empty|free|clear|unused $",
       "what furniture is empty"},
      {"^ has|have|was|were <x:name> been? anywhere|somewhere else $", "where has <x> been"},
      // Telegrams.
      {"^ objects|things|items that|which <x>", "what <x>"},
      {"^ objects|things|items within <x>", "what is within <x>"},
      {"^ objects|things|items moved|touched|handled <x>", "what was moved <x>"},
      {"^ objects|things|items appeared|added <x>", "what appeared <x>"},
      {"^ gone|missing|vanished objects|things|items $", "what has gone"},
      {"how long <x> at most $", "how long <x>"},
      // A choice after a question that is complete without it.
      {"^ do|have i|we have? two|three|four <n:noun> or one|two|three|four|five $", "how many <n> are there"},
      {"^ are there two|three|four <n:noun> or one|two|three|four|five $", "how many <n> are there"},
      {"which|what of? the? two? <n:noun> is|was closer|nearer to <y> , the <a> one? or the <b> one $",
       "is <y> nearer to the <a> <n> or to the <b> <n>"},
      {"which|what of? the? two? <n:noun> is|was <v> , the <a> one or the <b> one $", "which <n> is <v>"},
      // Lists: of four, the last three first.
      {"<a:name> , <b:name> ,? and <c:name>", "<a> and <b> and <c>"},
      {"<a:name> , <b:name> ,? or <c:name>", "<a> or <b> or <c>"},
      {"<a:name> , <b:name> and <c>", "<a> and <b> and <c>"},
      {"<a:name> , <b:name> or <c>", "<a> or <b> or <c>"},
      // "Which of my ingredients has moved: the oil, the milk or the jam?"
      {"which|what of the|my|our|these|those <n:noun> has|have|was|were|did <v> , <a> or <b:name> $",
       "which <a> or <b> was <v>"}};
  return all;
}

const std::vector<Pattern>& constructions() {
  static const std::vector<Pattern> all = {
      // Around the question.
      {"^ if <c:courtesy> $", ""},
      {"^ if i remember|recall correctly|rightly|right ,?", ""},
      {"^ unless i am mistaken|wrong ,?", ""},
      {"^ not that <x> , but", ""},
      {"^ <m:matrix> as? to|of|about|on? which <x>", "which <x>"},
      {"^ <m:matrix> as? to|of|about|on? what <x>", "what <x>"},
      {"^ <m:matrix> as? to|of|about|on? where <x>", "where <x>"},
      {"^ <m:matrix> as? to|of|about|on? how <x>", "how <x>"},
      {"^ <m:matrix> as? to|of|about|on? whether <x>", "whether <x>"},
      {"^ describe|list|name|tell|say|show|report me|us? what|which <x>", "what <x>"},
      {"the? last time i|we|you|anyone looked|checked $", ""},
      {"when you last looked|checked $", ""},
      {"^ where is the|my? <x> , the|my <n:name> $", "where is the <n>"},
      {"^ how much <n:noun> are <x>", "how many <n> are <x>"},
      {"^ how much <n:plural> is <x>", "how many <n> are <x>"},
      // Who does it, and how often.
      {"keep|keeps|kept|keep|been <v:doing>", "<v>"},
      {"in front of me|us|you", ""},
      {"the|my|our|your|these|those two|three|four|five <n:name>", "the <n>"},
      // What restricts the objects.
      {"how many of the|my|our|these|those <x> is|are <c:colour> $", "how many <c> <x>"},
      {"which|what of the|my|our|these|those <x> is|are <c:colour> $", "which <c> <x>"},
      {"what is the|that|this <c:colour> thing|one on|in|at|inside <x:name> $", "which <c> thing is on <x>"},
      {"^ is? it? true? that? the|my|our? <p:name> has|holds <x> on|in|inside it $",
       "is there <x> on the <p>"},
      {"^ <a:name> or <b:name> bigger|larger $", "which is bigger <a> or <b>"},
      {"^ <a:name> or <b:name> smaller $", "which is smaller <a> or <b>"},
      {"^ <a:name> or <b:name> taller|higher $", "which is taller <a> or <b>"},
      {"^ is more big|large <a> or <b> $", "which is bigger <a> or <b>"},
      {"^ is bigger|larger <a> or <b> $", "which is bigger <a> or <b>"},
      {"^ what is|was the|that|this <c:colour> <n:noun> $", "which <c> <n> are there"},
      {"^ is|are|was|were <x:name> a|an? <c:colour> one|ones|thing|things|object|objects $", "is <x> <c>"},
      {"^ is|are|was|were <x:name> one|some of the <c:colour> ones|things|objects $", "is <x> <c>"},
      {"are there any? <n:noun> that? you|we have never <v> $", "which <n> were never <v>"},
      {"is|are there more <a:noun> than <b:noun> $", "does the <a> outnumber the <b>"},
      {"is|are there fewer|less <a:noun> than <b:noun> $", "does the <b> outnumber the <a>"},
      // Not moved since.
      {"^ is|are <p:name> still? where it|they was|were at|in? <t> $", "was <p> never moved since <t>"},
      {"^ is|are <p:name> still? where i|we|someone left|put it|them $", "was <p> never moved"},
      {"^ is|are <p:name> still where it|they was|were $", "was <p> never moved"},
      {"^ is? there? anything|something unusual|odd|strange $", "is anything out of place"},
      {"^ is|are it|they still? where i|we|someone left|put it|them $", "was it never moved"},
      // When it ends.
      {"how long <x> before|until|till someone|somebody|anyone|anybody <v> it|them|that away|up|again|shut? "
       "$",
       "how long <x>"},
      {"how long did|has|was|had <x:name> stand|stood|sit|lie|stay|stayed|remain|been|standing|lying|sitting "
       "around|about|out|there? $",
       "how long was <x> there"},
      {"for breakfast $", "at breakfast"},
      {"for lunch $", "at lunch"},
      {"for dinner|supper $", "at dinner"},
  };
  return all;
}

/// "some idiot", "the neighbour's girl": someone, where nothing is called so.
bool name_people(Words& words, const IsName& is_name) {
  static const std::set<std::string> restricting = {"when",   "while", "if",   "after",
                                                    "before", "until", "since"};
  // Whose coming and going was not seen restricts what is asked: "when my aunt came".
  if (std::any_of(words.begin() + std::min<std::ptrdiff_t>(1, std::ssize(words)), words.end(),
                  [](const std::string& word) { return restricting.contains(word); }))
    return false;
  const auto is_person = [&](const std::string& word) {
    return !is_household_noun(word) && class_of(lemma_of(word)) == WordClass::name &&
           wordnet::is_person(word) && !is_name(word);
  };
  bool changed = false;
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    if (class_of(lemma_of(words[i])) != WordClass::article) continue;
    size_t last = i + 1;
    if (words[last].ends_with("'s") && last + 1 < words.size() &&
        is_person(words[last].substr(0, words[last].size() - 2)))
      ++last;
    const bool person = is_person(words[last]) || lemma_of(words[last]) == "someone";
    if (!person || (last == i + 1 && lemma_of(words[last]) == "someone")) continue;
    replace_words(words, i, last + 1 - i, {"someone"});
    changed = true;
  }
  return changed;
}

/// Where the only negative word of a sentence that asks for yes or no is; unset for others.
std::optional<size_t> only_negative(const Words& words) {
  static const std::set<std::string> negatives = {"nobody", "noone", "nothing", "never"};
  std::optional<size_t> at;
  for (size_t i = 0; i < words.size(); ++i) {
    if (is_question_word(words[i])) return std::nullopt;
    if (!negatives.contains(words[i]) && lemma_of(words[i]) != "not") continue;
    if (at) return std::nullopt;
    at = i;
  }
  return at;
}

/// "has nothing happened" as "has anything happened".
bool affirm(Words& words) {
  static const std::map<std::string, std::string> contraries = {{"nothing", "anything"}, {"never", "ever"}};
  const auto at = only_negative(words);
  const auto contrary = at ? contraries.find(words[*at]) : contraries.end();
  if (contrary == contraries.end()) return false;
  words[*at] = contrary->second;
  return true;
}

/// "Confirm that it was not touched", "it never left, right?": yes, if it is as stated.
bool asks_to_confirm(const Words& words) {
  static const std::set<std::string> orders = {"confirm", "verify"}, tags = {"right", "correct", "true"};
  size_t last = words.size();
  while (last > 0 && is_mark(words[last - 1])) --last;
  return (last > 0 && tags.contains(words[last - 1])) ||
         std::ranges::any_of(words, [](const std::string& word) { return orders.contains(word); }) ||
         (words.size() > 2 && words[0] == "is" && words[1] == "it" && tags.contains(words[2]));
}

/// Of "which one", "which of these" at a word; 0 = another word is there.
size_t length_of_choice(const Words& words, size_t at) {
  static const std::vector<Words> choices =
      expand_form("which (one|ones)|which [one|ones] of (these|those|them)");
  size_t longest = 0;
  for (const Words& choice : choices)
    if (starts_with_words(words, choice, at)) longest = std::max(longest, choice.size());
  return longest;
}

/// "Which of these has moved: the oil, the milk or the jam?" names them where it asks.
bool take_list(Words& words, const IsName& is_name) {
  const size_t length = length_of_choice(words, 0);
  const auto mark = std::ranges::find(words, ",");
  if (length == 0 || mark == words.end()) return false;
  Words list, name;
  const auto end = [&] {
    if (name.empty()) return true;
    if (!is_name(join_words(name, 0, name.size()))) return false;
    if (!list.empty()) list.emplace_back("or");
    list.insert(list.end(), name.begin(), name.end());
    name.clear();
    return true;
  };
  for (auto word = mark; word != words.end(); ++word)
    if (is_mark(*word) || *word == "or" || *word == "and") {
      if (!end()) return false;
    } else if (class_of(lemma_of(*word)) != WordClass::article) {
      name.push_back(*word);
    }
  if (!end() || list.empty()) return false;
  words.erase(mark, words.end());
  replace_words(words, 1, length - 1, list);
  return true;
}

/// "So the oil left the counter": "did the oil left the counter"; others as they are.
void ask_whether(Words& words) {
  const auto is_auxiliary = [](const std::string& word) {
    return class_of(lemma_of(word)) == WordClass::auxiliary;
  };
  if (std::ranges::any_of(words, is_auxiliary)) return;
  const auto that = std::ranges::find(words, "that");
  auto first = that == words.end() ? words.begin() : that + 1;
  while (first != words.end() && (*first == "so" || *first == "and" || is_mark(*first))) ++first;
  words.insert(words.erase(words.begin(), first), "did");
}

}  // namespace

std::string as_meant(const std::string& sentence, const IsName& is_name) {
  Words words = words_and_marks(sentence);
  bool changed = false;
  if (const auto correction = find_correction(words)) {
    words = corrected({words.begin(), words.begin() + static_cast<std::ptrdiff_t>(correction->first)},
                      tail_of(words, correction->last));
    changed = true;
  }
  const Words said = words;
  name_basic_colors(words);
  changed = words != said || changed;
  changed = take_list(words, is_name) || changed;
  changed = apply_all(meanings(), words, is_name) || changed;
  return changed ? joined(words, " ") : sentence;
}

std::optional<Rephrasing> rephrased(const std::string& sentence, const IsName& is_name) {
  Words words = words_and_marks(sentence);
  Rephrasing result;
  bool changed = apply_all(constructions(), words, is_name);
  changed = name_people(words, is_name) || changed;
  result.contrary = affirm(words);
  if (!changed && !result.contrary) return std::nullopt;
  result.sentence = joined(words, " ");
  return result;
}

std::optional<ContraryQuestion> contrary_question(const std::string& sentence) {
  Words words = words_and_marks(sentence);
  for (size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "no" && words[i + 1] == "one") replace_words(words, i, 2, {"nobody"});
  const auto at = only_negative(words);
  if (!at || *at + 1 >= words.size()) return std::nullopt;
  const std::string negative = words[*at];
  const bool nobody = negative == "nobody" || negative == "noone";
  if (!nobody && negative != "nothing" && !asks_to_confirm(words)) return std::nullopt;
  if (nobody) {
    words[*at] = "somebody";
    if (class_of(lemma_of(words[*at + 1])) == WordClass::auxiliary)
      std::swap(words[*at], words[*at + 1]);
    else
      words.insert(words.begin() + static_cast<std::ptrdiff_t>(*at), "did");
  } else {
    if (!affirm(words)) replace_words(words, *at, 1, {});
    ask_whether(words);
  }
  return ContraryQuestion{joined(words, " "), nobody};
}

std::string with_choice(const std::string& question, const std::string& subject) {
  static const std::vector<Words> any =
      expand_form("(is|are) there (any|some|one) [left]|have (i|we) [got] (any|some|one) [left]");
  Words words = words_and_marks(question);
  const size_t length = length_of_choice(words, 0);
  while (!words.empty() && is_mark(words.back())) words.pop_back();
  if (!subject.empty() && std::ranges::count(any, words) > 0) return "is there any " + subject + "?";
  if (length == 0 || subject.empty()) return question;
  replace_words(words, 1, length - 1, words_of(subject));
  return joined(words, " ");
}

std::string without_partitive(const std::string& question) {
  constexpr size_t kMaxBefore = 4;
  static const std::set<std::string> them = {"them", "those", "these"};
  Words words = words_and_marks(question);
  while (!words.empty() && is_mark(words.back())) words.pop_back();
  if (std::ranges::any_of(words, is_mark)) return "";  // what they are may be said before
  for (size_t i = 1; i + 1 < words.size() && i <= kMaxBefore; ++i) {
    const bool ends = i + 2 == words.size();
    const bool noun = !ends && class_of(lemma_of(words[i + 2])) != WordClass::auxiliary &&
                      words[i + 1] != "them";  // "of these cups"
    if (words[i] != "of" || !them.contains(words[i + 1]) || noun) continue;
    replace_words(words, i, 2, {});
    return joined(words, " ") + "?";
  }
  return "";
}

bool chooses(const std::string& sentence) {
  const Words words = words_and_marks(sentence);
  for (size_t i = 0; i < words.size(); ++i)
    if (length_of_choice(words, i) > 0) return true;
  return false;
}

std::optional<TwoQuestions> two_questions(const std::string& sentence) {
  const Words words = words_and_marks(sentence);
  for (size_t i = 3; i + 3 < words.size(); ++i) {
    if (words[i] != "and" || !is_question_word(words[i + 1]) ||
        class_of(lemma_of(words[i + 2])) != WordClass::auxiliary)
      continue;
    size_t end = i;
    while (end > 0 && is_mark(words[end - 1])) --end;
    return TwoQuestions{join_words(words, 0, end) + "?", join_words(words, i + 1, words.size())};
  }
  return std::nullopt;
}

std::optional<TwoQuestions> elided_question(const std::string& sentence) {
  static const std::vector<Words> more =
      expand_form("when|where|why|who|since when|until when|how long|how often|how many times");
  Words words = words_and_marks(sentence);
  while (!words.empty() && is_mark(words.back())) words.pop_back();
  for (const Words& one : more) {
    if (words.size() < one.size() + 4 || !starts_with_words(words, one, words.size() - one.size())) continue;
    Words question(words.begin(), words.end() - std::ssize(one));
    if (question.back() != "and") continue;
    while (question.back() == "and" || is_mark(question.back())) question.pop_back();
    return TwoQuestions{joined(question, " ") + "?", joined(one, " ") + "?"};
  }
  return std::nullopt;
}

}  // namespace loci::memory
