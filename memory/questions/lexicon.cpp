#include "memory/questions/lexicon.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "mapping/base/text.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {
namespace {

/// Lemmas and the words that stand for them; the lemma itself need not be given.
const std::vector<std::pair<const char*, const char*>> kLemmas = {
    {"is", "am are be"},
    {"was", "were"},
    {"do", "does did"},
    {"has", "have had having"},
    {"can", "could may might should shall would must"},
    {"someone", "i we you he she they anyone anybody somebody people everybody robot"},
    {"anything", "something"},
    {"thing", "things object objects item items stuff"},
    {"content", "contents"},
    {"see",
     "sees saw seen seeing notice noticed spot spotted observe observed detect detected recognise "
     "recognised"},
    {"find", "finds found finding locate search searching"},
    {"look", "looks looked looking viewed check checked inspect inspected"},
    {"move", "moves moved moving shift shifted push pushed touch touched use used handled"},
    {"take", "takes took taken remove removed stolen"},
    {"leave", "leaves left leaving"},
    {"go", "goes went gone going"},
    {"vanish", "vanished disappear disappears disappeared"},
    {"come", "comes came arrive arrived arrives appear appeared appears reach reached return returned"},
    {"put", "puts placed laid added brought"},
    {"lose", "lost misplaced"},
    {"miss", "missing"},
    {"keep", "keeps kept store stores stored"},
    {"stand",
     "stands stood standing lie lies lying lain sit sits sat sitting rest stay stays stayed located"},
    {"belong", "belongs live lives"},
    {"contain", "contains contained hold holds"},
    {"happen", "happens happened occur occurred"},
    {"change", "changes changed"},
    {"own", "owns owned owner"},
    {"open", "ajar"},
    {"opened", "opens opening"},
    {"close", "closed closes shut"},
    {"know", "knows knew remember"},
    {"think", "believe say suppose assume"},
    {"get", "got gets"},
    {"empty", "free clear unoccupied vacant bare"},
    {"full", "occupied"},
    {"on", "upon"},
    {"in", "inside"},
    {"into", "onto"},
    {"near", "beside nearby alongside around"},
    {"under", "below beneath underneath"},
    {"from", "off"},
    {"usually", "normally always mostly typically generally often"},
    {"last", "latest"},
    {"colour", "color"},
    {"room", "kitchen flat apartment house home"},
    {"clean", "tidy straighten"},
    {"new", "different"},
};

/// Several words that are one.
const std::vector<std::pair<Words, std::string>> kCompounds = {
    {{"how", "many", "times"}, "howoften"},
    {{"how", "often"}, "howoften"},
    {{"how", "many"}, "howmany"},
    {{"how", "much"}, "howmany"},
    {{"how", "long"}, "howlong"},
    {{"for", "how", "long"}, "howlong"},
    {{"since", "when"}, "sincewhen"},
    {{"how", "sure"}, "howsure"},
    {{"how", "certain"}, "howsure"},
    {{"how", "confident"}, "howsure"},
    {{"how", "probable"}, "howsure"},
    {{"how", "likely"}, "howsure"},
    {{"at", "what", "time"}, "when"},
    {{"what", "time"}, "when"},
    {{"on", "top", "of"}, "on"},
    {{"next", "to"}, "near"},
    {{"close", "to"}, "near"},
    {{"out", "of"}, "from"},
    {{"in", "front", "of"}, "before"},
    {{"looking", "for"}, "find"},
    {{"look", "for"}, "find"},
    {{"search", "for"}, "find"},
    {{"searching", "for"}, "find"},
    {{"ended", "up"}, "go"},
    {{"end", "up"}, "go"},
    {{"turned", "up"}, "come"},
    {{"in", "use"}, "full"},
};

/// Words that do not change what is meant.
const std::set<std::string> kEmptyWords = {
    "the",   "a",     "an",      "please", "any",  "some",  "my",        "our",      "your",   "his",
    "its",   "still", "already", "ever",   "just", "again", "currently", "really",   "also",   "even",
    "those", "these", "all",     "maybe",  "then", "right", "yet",       "actually", "perhaps"};

/// No phrase for an object, a place or a time has them.
const std::set<std::string> kClosed = {
    "where",   "when",      "who",    "why",     "which",   "what", "how",  "howmany", "howlong", "howoften",
    "howsure", "sincewhen", "is",     "are",     "was",     "were", "do",   "does",    "did",     "has",
    "have",    "had",       "i",      "we",      "you",     "not",  "will", "if",      "or",      "because",
    "and",     "someone",   "anyone", "anybody", "there's", "been", "than", "whether"};

}  // namespace

const std::map<std::string, std::string>& lexicon() {
  static const std::map<std::string, std::string> lemmas = [] {
    std::map<std::string, std::string> result;
    for (const auto& [lemma, words] : kLemmas)
      for (const std::string& word : words_of(words)) result[word] = lemma;
    return result;
  }();
  return lemmas;
}

namespace {

const std::string& lemma_of(const std::string& word) {
  const auto found = lexicon().find(word);
  return found == lexicon().end() ? word : found->second;
}

/// "what's" as "what is", "can't" as "can not".
Words expanded(const std::string& word) {
  static const std::map<std::string, Words> whole = {{"can't", {"can", "not"}},   {"cannot", {"can", "not"}},
                                                     {"i'm", {"i", "am"}},        {"whats", {"what", "is"}},
                                                     {"wheres", {"where", "is"}}, {"won't", {"will", "not"}}};
  static const std::set<std::string> before_is = {"what", "where", "who",  "there", "it",
                                                  "how",  "when",  "that", "which"};
  static const std::vector<std::pair<std::string, std::string>> endings = {
      {"n't", "not"}, {"'re", "are"}, {"'ve", "have"}, {"'d", "would"}};
  if (const auto found = whole.find(word); found != whole.end()) return found->second;
  if (word.ends_with("'s") && before_is.contains(word.substr(0, word.size() - 2)))
    return {word.substr(0, word.size() - 2), "is"};
  for (const auto& [ending, rest] : endings)
    if (word.ends_with(ending) && word.size() > ending.size())
      return {word.substr(0, word.size() - ending.size()), rest};
  return {word};
}

/// "second drawer" is "drawer 2".
void name_by_number(Words& words) {
  static const std::map<std::string, std::string> ordinals = {
      {"first", "1"}, {"1st", "1"},    {"second", "2"}, {"2nd", "2"},   {"third", "3"},
      {"3rd", "3"},   {"fourth", "4"}, {"4th", "4"},    {"fifth", "5"}, {"sixth", "6"}};
  static const std::set<std::string> furniture = {"drawer",  "door",    "shelf",    "table",
                                                  "counter", "cabinet", "cupboard", "island"};
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    const auto ordinal = ordinals.find(words[i]);
    if (ordinal == ordinals.end() || !furniture.contains(words[i + 1])) continue;
    words[i] = words[i + 1];
    words[i + 1] = ordinal->second;
  }
}

}  // namespace

Words sentence_words(const std::string& sentence) {
  Words result;
  for (std::string& word : words_of(sentence, " \t\n\v\f\r?!,;\"")) {
    // ISO 8601 times keep their T and Z.
    if (std::isdigit(static_cast<unsigned char>(word[0])) == 0) word = lower_case(word);
    while (word.ends_with('.') || word.ends_with(':')) word.pop_back();
    if (word.ends_with("days") && weekday_of(word.substr(0, word.size() - 1))) word.pop_back();
    if (word.empty()) continue;
    for (std::string& part : expanded(word)) result.push_back(std::move(part));
  }
  name_by_number(result);
  return result;
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

bool is_empty_word(const std::string& word) {
  return kEmptyWords.contains(word);
}

bool is_closed_word(const std::string& word) {
  return kClosed.contains(word);
}

Tokens tokens_of(Words words) {
  for (const auto& [compound, word] : kCompounds)
    for (size_t i = 0; i < words.size(); ++i)
      if (starts_with_words(words, compound, i)) replace_words(words, i, compound.size(), {word});
  Tokens tokens;
  for (std::string& word : words) {
    tokens.lemmas.push_back(lemma_of(word));
    tokens.words.push_back(std::move(word));
  }
  return tokens;
}

bool is_one_typo(const std::string& a, const std::string& b) {
  if (a == b || a.size() > b.size() + 1 || b.size() > a.size() + 1) return false;
  size_t i = 0;
  while (i < a.size() && i < b.size() && a[i] == b[i]) ++i;
  const std::string rest_a = a.substr(i), rest_b = b.substr(i);
  const auto tail = [](const std::string& text, size_t count) {
    return text.size() < count ? std::string() : text.substr(count);
  };
  if (rest_a.size() == rest_b.size())
    return tail(rest_a, 1) == tail(rest_b, 1) ||
           (rest_a.size() > 1 && rest_a[0] == rest_b[1] && rest_a[1] == rest_b[0] &&
            tail(rest_a, 2) == tail(rest_b, 2));
  return rest_a.size() > rest_b.size() ? tail(rest_a, 1) == rest_b : tail(rest_b, 1) == rest_a;
}

}  // namespace loci::memory
