#include "memory/sentences/intents/rephrasing.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/sentences/intents/rephrasing_rules.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/word_forms.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

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

std::optional<ContraryQuestion> contrary_question(const std::string& sentence, const IsName& is_name) {
  Words words = words_and_marks(sentence);
  if (apply_all(contraries(), words, is_name)) return ContraryQuestion{joined(words, " "), true};
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
  static const std::vector<Words> elided =
      expand_form("when|where|why|who|since when|until when|how long|how often|how many times");
  Words words = words_and_marks(sentence);
  while (!words.empty() && is_mark(words.back())) words.pop_back();
  for (size_t i = 3; i + 1 < words.size(); ++i) {
    if (words[i] != "and") continue;
    const Words more = tail_of(words, i + 1);
    const bool alone = std::ranges::count(elided, more) > 0;
    const bool whole =
        more.size() > 2 && is_question_word(more[0]) && class_of(lemma_of(more[1])) == WordClass::auxiliary;
    if (!alone && !whole) continue;
    while (i > 0 && is_mark(words[i - 1])) --i;
    return TwoQuestions{join_words(words, 0, i) + "?", joined(more, " ") + "?", alone};
  }
  return std::nullopt;
}

}  // namespace loci::memory
