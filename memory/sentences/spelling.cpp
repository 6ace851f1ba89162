#include "memory/sentences/spelling.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "mapping/base/text/text.h"
#include "memory/questions/question.h"
#include "memory/sentences/intents/intent_model.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/vocabulary.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

constexpr size_t kMaxSentences = 8;
constexpr size_t kMaxLength = 1000;  ///< of a sentence that is corrected

/// Words of the grammar, of times and of households, sorted.
const std::vector<std::string_view>& vocabulary_words() {
  static const std::vector<std::string_view> all = [] {
    std::vector<std::string_view> words;
    const auto add = [&](std::string_view text) {
      const std::vector<std::string_view> more = word_views(text);
      words.insert(words.end(), more.begin(), more.end());
    };
    for (const auto& [lemma, forms] : vocabulary::lemmas()) {
      add(lemma);
      add(forms);
    }
    for (const auto& [form, by] : vocabulary::compounds()) add(form);
    for (const auto& of_class : vocabulary::classes()) add(of_class.words);
    for (const auto& surrounding : vocabulary::surroundings()) add(surrounding.words);
    for (const auto& [word, full] : contractions()) add(word);
    add(vocabulary::kFurniture);
    add(vocabulary::kHouseholdWords);
    add(vocabulary::kOtherWords);
    std::ranges::sort(words);
    words.erase(std::unique(words.begin(), words.end()), words.end());
    return words;
  }();
  return all;
}

/// Words of the questions, which few sentences need beside those.
const std::set<std::string>& question_words() {
  static const std::set<std::string> all = [] {
    std::set<std::string> words;
    for (const Question& question : questions())
      for (const SentenceForm& form : question.sentences) {
        for (const std::string& word : sentence_words(form.example)) words.insert(word);
        for (const std::string& word : words_of(form.form, " []<>|:-")) words.insert(word);
      }
    return words;
  }();
  return all;
}

/// Features of the classifier that are words by themselves.
bool is_plain_word(std::string_view feature) {
  return feature.find_first_of(" '#") == std::string_view::npos;
}

bool is_known(const std::string& word, const std::set<std::string>& names) {
  const auto knows = [&](const std::string& one) {
    return std::ranges::binary_search(vocabulary_words(), std::string_view(one)) || names.contains(one) ||
           (is_plain_word(one) && trained_intents().has_feature(one)) || question_words().contains(one);
  };
  if (knows(word)) return true;
  for (const std::string ending : {"s", "es", "'s", "'", "'re", "'ve", "'d", "'ll", "n't"})
    if (word.ends_with(ending) && knows(word.substr(0, word.size() - ending.size()))) return true;
  return false;
}

std::string without_doubles(std::string word) {
  word.erase(std::unique(word.begin(), word.end()), word.end());
  return word;
}

/// One letter, or in a long word which letters are double: "dissapear".
bool is_typo(const std::string& typed, const std::string& meant) {
  constexpr size_t kLong = 7;
  return is_one_typo(typed, meant) ||
         (typed.size() >= kLong && without_doubles(typed) == without_doubles(meant));
}

/// What happened more often comes first: two letters exchanged, a letter twice or once, other mistakes.
int rank_of(const std::string& typed, const std::string& meant) {
  std::string a = typed, b = meant;
  std::ranges::sort(a);
  std::ranges::sort(b);
  if (a == b) return 0;
  if (without_doubles(typed) == without_doubles(meant)) return 1;
  if (typed.size() < meant.size()) return 2;
  if (typed[0] == meant[0]) return 3;
  return 4;
}

/// Corrections of a word up to a rank, the likeliest first.
std::vector<std::string> corrections(const std::string& word, const std::set<std::string>& names,
                                     int max_rank) {
  constexpr size_t kMinLength = 4;
  constexpr size_t kMaxCorrections = 3;
  std::set<std::string> found;
  const auto try_word = [&](std::string_view meant) {
    const std::string one(meant);
    if (!is_typo(word, one)) return;
    const int rank = rank_of(word, one);
    if (rank > max_rank) return;
    // Short words are only taken for one another where letters were exchanged, or one is missing: "mlk".
    const bool one_missing = rank == 2 && word.size() + 1 == kMinLength;
    if (std::min(word.size(), one.size()) < kMinLength && rank > 1 && !one_missing) return;
    found.insert(one);
  };
  std::ranges::for_each(vocabulary_words(), try_word);
  std::ranges::for_each(question_words(), try_word);
  for (const std::string_view feature : trained_intents().features)
    if (is_plain_word(feature)) try_word(feature);
  std::ranges::for_each(names, try_word);
  std::vector<std::string> ranked(found.begin(), found.end());
  std::ranges::stable_sort(ranked, {}, [&](const std::string& one) {
    return std::pair(rank_of(word, one), names.contains(one) ? 0 : 1);
  });
  if (ranked.size() > kMaxCorrections) ranked.resize(kMaxCorrections);
  return ranked;
}

bool is_word(const std::string& text) {
  return text.size() >= 3 &&
         std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || c == '\''; });
}

}  // namespace

bool is_known_word(const std::string& word) {
  return is_known(word, {});
}

std::vector<Respelling> respellings(const std::string& sentence, const std::set<std::string>& names,
                                    bool of_rare_words) {
  constexpr int kMaxRank = 4, kMaxRankOfRare = 1;
  std::vector<Respelling> all = {{}};
  bool changed = false;
  const std::string text = sentence.size() > kMaxLength ? "" : lower_case(sentence);
  const auto append = [&](std::string_view part) {
    for (Respelling& one : all) one.sentence += part;
  };
  for (size_t i = 0; i < text.size();) {
    size_t end = i;
    while (end < text.size() && !is_space(text[end]) &&
           std::string_view("?!,;.:\"()").find(text[end]) == std::string::npos)
      ++end;
    if (end == i) {
      append(std::string_view(sentence).substr(i++, 1));
      continue;
    }
    const std::string word = text.substr(i, end - i);
    std::vector<std::string> meant;
    const bool rare = wordnet::is_word(word);
    if (is_word(word) && !is_known(word, names) && (!rare || of_rare_words))
      meant = corrections(word, names, rare ? kMaxRankOfRare : kMaxRank);
    if (meant.empty()) {
      append(std::string_view(sentence).substr(i, end - i));
    } else {
      changed = true;
      std::vector<Respelling> longer;
      for (const std::string& one : meant)
        for (const Respelling& before : all) {
          if (longer.size() == kMaxSentences) break;
          longer.push_back(before);
          longer.back().sentence += one;
          longer.back().notes.push_back(fmt::format("'{}' is taken as '{}'", word, one));
        }
      all = std::move(longer);
    }
    i = end;
  }
  if (changed || text.empty()) all.push_back({sentence, {}});
  if (text.empty()) all.erase(all.begin());
  return all;
}

}  // namespace loci::memory
