#include "memory/sentences/lexicon.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string_view>
#include <unordered_map>

#include "mapping/base/text/text.h"
#include "memory/questions/time_parser.h"
#include "memory/sentences/vocabulary.h"
#include "memory/sentences/word_forms.h"

namespace loci::memory {
namespace {

const std::map<std::string, WordClass>& classes() {
  static const std::map<std::string, WordClass> all = [] {
    std::map<std::string, WordClass> result;
    for (const vocabulary::ClassWords& of_class : vocabulary::classes())
      for (const std::string& word : words_of(of_class.words)) result.emplace(word, of_class.word_class);
    return result;
  }();
  return all;
}

}  // namespace

const std::map<std::string, Words>& contractions() {
  static const std::map<std::string, Words> all = {{"can't", {"can", "not"}},
                                                   {"cannot", {"can", "not"}},
                                                   {"cant", {"can", "not"}},
                                                   {"won't", {"will", "not"}},
                                                   {"i'm", {"i", "am"}},
                                                   {"im", {"i", "am"}},
                                                   {"whats", {"what", "is"}},
                                                   {"wheres", {"where", "is"}},
                                                   {"theres", {"there", "is"}},
                                                   {"isnt", {"is", "not"}},
                                                   {"dont", {"do", "not"}},
                                                   {"didnt", {"did", "not"}},
                                                   {"hasnt", {"has", "not"}},
                                                   {"havent", {"have", "not"}},
                                                   {"wasnt", {"was", "not"}},
                                                   {"where'd", {"where", "did"}},
                                                   {"when'd", {"when", "did"}},
                                                   {"who'd", {"who", "did"}},
                                                   {"let's", {"let", "us"}},
                                                   {"i'll", {"i", "will"}},
                                                   {"ive", {"i", "have"}},
                                                   {"doesnt", {"does", "not"}},
                                                   {"arent", {"are", "not"}},
                                                   {"werent", {"were", "not"}},
                                                   {"wont", {"will", "not"}},
                                                   {"couldnt", {"could", "not"}},
                                                   {"whos", {"who", "is"}},
                                                   {"whens", {"when", "is"}},
                                                   {"hows", {"how", "is"}},
                                                   {"thats", {"that", "is"}},
                                                   {"its", {"its"}},
                                                   {"longs", {"long", "has"}},
                                                   {"2day", {"today"}},
                                                   {"rn", {"right", "now"}},
                                                   {"atm", {"right", "now"}},
                                                   {"ur", {"your"}},
                                                   {"r", {"are"}},
                                                   {"u", {"you"}},
                                                   {"&", {"and"}},
                                                   {"w/", {"with"}},
                                                   {"gimme", {"give", "me"}},
                                                   {"lemme", {"let", "me"}},
                                                   {"dunno", {"do", "not", "know"}},
                                                   {"gotta", {"got", "to"}},
                                                   {"wanna", {"want", "to"}},
                                                   {"til", {"until"}},
                                                   {"'til", {"until"}},
                                                   {"cuz", {"because"}},
                                                   {"coz", {"because"}},
                                                   {"ya", {"you"}}};
  return all;
}

namespace {

/// "what's" as "what is", "can't" as "can not".
Words expanded(const std::string& word) {
  static const std::set<std::string> before_is = {"what", "where", "who",   "there", "it",  "how",
                                                  "when", "that",  "which", "he",    "she", "here"};
  static const std::vector<std::pair<std::string, std::string>> endings = {
      {"n't", "not"}, {"'re", "are"}, {"'ve", "have"}, {"'d", "would"}, {"'ll", "will"}};
  if (const auto found = contractions().find(word); found != contractions().end()) return found->second;
  if (word.ends_with("'s") && before_is.contains(word.substr(0, word.size() - 2)))
    return {word.substr(0, word.size() - 2), "is"};
  for (const auto& [ending, rest] : endings)
    if (word.ends_with(ending) && word.size() > ending.size())
      return {word.substr(0, word.size() - ending.size()), rest};
  return {word};
}

bool is_digits(const std::string& word) {
  return !word.empty() && std::ranges::all_of(word, is_digit);
}

std::string without_hash(const std::string& word) {
  return word.starts_with('#') ? word.substr(1) : word;
}

/// The parts of "last_seen"; a name of the map ("drawer_1_front") is the furniture that it is a part of.
Words parts_of(const std::string& word) {
  static const std::set<std::string> pieces = {"front", "bottom", "handle", "knob", "joint"};
  Words parts = words_of(word, "_");
  if (parts.size() < 2) return {word};
  if (std::ranges::all_of(parts, [](const std::string& part) {
        return lexicon().contains(part) || class_of(part) != WordClass::name;
      }))
    return parts;
  size_t count = parts.size();
  while (count > 2 && pieces.contains(parts[count - 1])) --count;
  if (count == parts.size() || !is_digits(parts[count - 1])) return {word};
  parts.resize(count);
  return {joined(parts, "_")};
}

/// "second drawer" and "drawer number two" are "drawer 2".
void name_by_number(Words& words) {
  static const std::map<std::string, std::string> ordinals = {
      {"first", "1"}, {"1st", "1"},    {"second", "2"}, {"2nd", "2"},   {"third", "3"},
      {"3rd", "3"},   {"fourth", "4"}, {"4th", "4"},    {"fifth", "5"}, {"sixth", "6"}};
  static const std::map<std::string, std::string> numbers = {{"one", "1"},  {"two", "2"},  {"three", "3"},
                                                             {"four", "4"}, {"five", "5"}, {"six", "6"}};
  static const std::set<std::string> furniture = {"drawer",  "door",    "shelf",    "table",
                                                  "counter", "cabinet", "cupboard", "island"};
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    // "object 7", "object number 7"
    if (words[i] == "object" && i + 2 < words.size() && (words[i + 1] == "number" || words[i + 1] == "no"))
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    if (words[i] == "object" && is_digits(without_hash(words[i + 1]))) {
      words[i] += "_" + without_hash(words[i + 1]);
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    if (i + 1 == words.size()) break;
    // "number two drawer"
    if (words[i] == "number" && i + 2 < words.size() && furniture.contains(words[i + 2])) {
      words[i] = words[i + 2];
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 2);
    }
    if (const auto ordinal = ordinals.find(words[i]);
        ordinal != ordinals.end() && furniture.contains(words[i + 1])) {
      words[i] = words[i + 1];
      words[i + 1] = ordinal->second;
    }
    if (!furniture.contains(words[i])) continue;
    const bool numbered =
        i + 2 < words.size() && (is_digits(without_hash(words[i + 2])) || numbers.contains(words[i + 2]));
    if (numbered && (words[i + 1] == "number" || words[i + 1] == "no"))
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    words[i + 1] = without_hash(words[i + 1]);
    // "the drawer one can find it in"
    const bool person = words[i + 1] == "one" && i + 2 < words.size() &&
                        class_of(lemma_of(words[i + 2])) == WordClass::auxiliary &&
                        lemma_of(words[i + 2]) == "may";
    if (person) words[i + 1] = "someone";
    if (const auto number = numbers.find(words[i + 1]); number != numbers.end())
      words[i + 1] = number->second;
  }
}

/// The compounds by the words that they may begin with.
const std::unordered_map<std::string_view, std::vector<const vocabulary::Compound*>>& compounds() {
  static const auto all = [] {
    std::unordered_map<std::string_view, std::vector<const vocabulary::Compound*>> result;
    for (const vocabulary::Compound& compound : vocabulary::compounds()) {
      for (const std::string_view word : first_words(compound.first))
        if (auto& of_word = result[word]; of_word.empty() || of_word.back() != &compound)
          of_word.push_back(&compound);
    }
    return result;
  }();
  return all;
}

/// Replaces the longest compound at each word; false when there is none.
bool replace_compounds(Words& words) {
  bool replaced = false;
  for (size_t i = 0; i < words.size(); ++i) {
    const auto found = compounds().find(words[i]);
    if (found == compounds().end()) continue;
    size_t longest = 0;
    const char* by_text = nullptr;
    for (const vocabulary::Compound* one : found->second)
      if (const size_t length = longest_match(one->first, words, i); length > longest) {
        longest = length;
        by_text = one->second;
      }
    if (longest == 0) continue;
    const Words by = words_of(by_text);
    replace_words(words, i, longest, by);
    replaced = true;
    i += by.empty() ? 0 : by.size() - 1;
    if (by.empty()) --i;
  }
  return replaced;
}

/// "the milk's on" is "the milk is on"; before a name it is an owner.
void expand_verbs(Words& words) {
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    if (!words[i].ends_with("'s") || words[i].size() < 4) continue;
    const std::string& next = words[i + 1];
    if (class_of(lemma_of(next)) == WordClass::name && !lexicon().contains(next)) continue;
    if (class_of(lemma_of(next)) == WordClass::person) continue;  // "the neighbour's girl"
    words[i].resize(words[i].size() - 2);
    words.insert(words.begin() + static_cast<std::ptrdiff_t>(i) + 1, "is");
  }
}

/// "the cooking pot" is a pot; in "who is cooking soup" somebody cooks.
void drop_purposes(Words& words) {
  static const std::set<std::string> purposes = {"cooking", "frying",  "drinking", "mixing",
                                                 "baking",  "serving", "eating",   "washing"};
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    const WordClass before = i == 0 ? WordClass::article : class_of(lemma_of(words[i - 1]));
    const bool named = before == WordClass::article || before == WordClass::name ||
                       before == WordClass::relation || before == WordClass::question ||
                       before == WordClass::empty;
    if (purposes.contains(words[i]) && named && is_household_noun(words[i + 1]))
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace

const std::map<std::string, std::string>& lexicon() {
  static const std::map<std::string, std::string> lemmas = [] {
    std::map<std::string, std::string> result;
    for (const auto& [lemma, words] : vocabulary::lemmas())
      for (const std::string& word : words_of(words)) result[word] = lemma;
    return result;
  }();
  return lemmas;
}

bool has_meaning(const std::string& lemma) {
  static const std::set<std::string> all = [] {
    std::set<std::string> lemmas;
    for (const auto& [one, words] : vocabulary::lemmas()) lemmas.insert(one);
    return lemmas;
  }();
  return all.contains(lemma);
}

const std::string& lemma_of(const std::string& word) {
  const auto found = lexicon().find(word);
  return found == lexicon().end() ? word : found->second;
}

WordClass class_of(const std::string& lemma) {
  const auto found = classes().find(lemma);
  return found == classes().end() ? WordClass::name : found->second;
}

bool is_pronoun(const std::string& lemma) {
  return lemma == "it" || lemma == "they" || lemma == "them";
}

bool is_of_staying(const std::string& word) {
  static const std::set<std::string> forms = word_set("stay stayed remain remained");
  return forms.contains(word);
}

bool is_order(const std::string& lemma) {
  static const std::set<std::string> verbs = word_set(
      "show list name give describe find bring fetch get put set lay make prepare clean empty wipe stow "
      "pack keep take move carry hand pass want lose tell explain summarize place print output display "
      "enumerate return report");
  return verbs.contains(lemma);
}

bool is_furniture(const std::string& word) {
  static const std::set<std::string> words = [] {
    const Words all = words_of(vocabulary::kFurniture);
    return std::set<std::string>(all.begin(), all.end());
  }();
  return words.contains(word);
}

bool is_household_noun(const std::string& word) {
  static const std::set<std::string> words = [] {
    const Words all = words_of(vocabulary::kHouseholdWords);
    return std::set<std::string>(all.begin(), all.end());
  }();
  return words.contains(word) || is_furniture(word);
}

Words sentence_words(const std::string& sentence) {
  Words result;
  std::string plain = sentence;  // with the apostrophe of typewriters
  for (const std::string_view quote : {"\u2019", "\u2018"})
    for (size_t at = plain.find(quote); at != std::string::npos; at = plain.find(quote, at))
      plain.replace(at, quote.size(), 1, '\'');
  for (std::string& word : words_of(plain, " \t\n\v\f\r?!,;\"()[]")) {
    // ISO 8601 times keep their T and Z.
    if (std::isdigit(static_cast<unsigned char>(word[0])) == 0) word = lower_case(word);
    while (word.ends_with('.') || word.ends_with(':')) word.pop_back();
    if (word.ends_with("days") && weekday_of(word.substr(0, word.size() - 1))) word.pop_back();
    if (word.empty()) continue;
    for (const std::string& piece : parts_of(word))
      for (std::string& part : expanded(piece)) result.push_back(std::move(part));
  }
  expand_verbs(result);
  drop_purposes(result);
  name_by_number(result);
  return result;
}

std::vector<std::string_view> word_views(std::string_view text) {
  constexpr std::string_view kSeparators = " ()[]|";
  std::vector<std::string_view> words;
  for (size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find_first_of(kSeparators, begin), text.size());
    if (end > begin) words.push_back(text.substr(begin, end - begin));
  }
  return words;
}

std::set<std::string> word_set(const char* words) {
  const Words all = words_of(words);
  return {all.begin(), all.end()};
}

bool all_in(const Words& lemmas, const std::set<std::string>& set) {
  return std::ranges::all_of(lemmas, [&](const std::string& lemma) { return set.contains(lemma); });
}

std::string first_lemma(const Words& words) {
  const Tokens tokens = tokens_of(words);
  return tokens.lemmas.empty() ? "" : tokens.lemmas[0];
}

std::optional<size_t> find_pronoun(const Words& words) {
  const auto it = std::ranges::find_if(words, is_pronoun);
  if (it != words.end()) return static_cast<size_t>(it - words.begin());
  for (size_t i = 1; i < words.size(); ++i) {
    const bool ends =
        i + 1 == words.size() || words[i + 1] == "be" || words[i + 1] == "is" || words[i + 1] == "was";
    if ((words[i] == "that" || words[i] == "this") && ends) return i;
  }
  return std::nullopt;
}

void replace_words(Words& words, size_t first, size_t count, const Words& by) {
  words.erase(words.begin() + static_cast<std::ptrdiff_t>(first),
              words.begin() + static_cast<std::ptrdiff_t>(first + count));
  words.insert(words.begin() + static_cast<std::ptrdiff_t>(first), by.begin(), by.end());
}

bool starts_with_words(const Words& words, const Words& head, size_t at) {
  return at + head.size() <= words.size() &&
         std::equal(head.begin(), head.end(), words.begin() + static_cast<std::ptrdiff_t>(at));
}

std::string join_words(const Words& words, size_t first, size_t last) {
  std::string text;
  for (size_t i = first; i < last; ++i) text += (i > first ? " " : "") + words[i];
  return text;
}

Tokens tokens_of(Words words) {
  constexpr int kMaxPasses = 3;  // compounds of compounds
  for (int pass = 0; pass < kMaxPasses && replace_compounds(words); ++pass) {
  }
  Tokens tokens;
  for (std::string& word : words) {
    // "The can" is an object, "can" alone a verb.
    const bool object =
        word == "can" && !tokens.lemmas.empty() && class_of(tokens.lemmas.back()) == WordClass::article;
    tokens.lemmas.push_back(object ? word : lemma_of(word));
    tokens.words.push_back(std::move(word));
  }
  return tokens;
}

bool is_one_typo(std::string_view a, std::string_view b) {
  if (a == b || a.size() > b.size() + 1 || b.size() > a.size() + 1) return false;
  size_t i = 0;
  while (i < a.size() && i < b.size() && a[i] == b[i]) ++i;
  a.remove_prefix(i);
  b.remove_prefix(i);
  if (a.size() > b.size()) return a.substr(1) == b;
  if (a.size() < b.size()) return b.substr(1) == a;
  return a.substr(1) == b.substr(1) ||
         (a.size() > 1 && a[0] == b[1] && a[1] == b[0] && a.substr(2) == b.substr(2));
}

}  // namespace loci::memory
