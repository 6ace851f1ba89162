#include "memory/wordnet/wordnet.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "memory/wordnet/tables.h"

namespace loci::memory::wordnet {
namespace {

std::string_view word_at(size_t index) {
  const Tables& all = tables();
  const size_t begin = all.word_begins[index];
  return all.words.substr(begin, all.word_begins[index + 1] - begin - 1);
}

std::optional<size_t> find_word(std::string_view word) {
  size_t first = 0, last = tables().word_begins.size() - 1;
  while (first < last) {
    const size_t middle = (first + last) / 2;
    if (word_at(middle) < word)
      first = middle + 1;
    else
      last = middle;
  }
  if (first + 1 == tables().word_begins.size() || word_at(first) != word) return std::nullopt;
  return first;
}

/// Lexicographer files 0 to 2 and 44 are of adjectives and adverbs, 3 to 28 of nouns, 29 to 43 of verbs.
PartOfSpeech part_of(Synset synset) {
  const int file = tables().files[synset];
  if (file == 2) return PartOfSpeech::adverb;
  if (file < 2 || file == 44) return PartOfSpeech::adjective;
  return file < 29 ? PartOfSpeech::noun : PartOfSpeech::verb;
}

std::span<const Synset> all_senses(size_t word) {
  const Tables& all = tables();
  return all.senses.subspan(all.sense_begins[word], all.sense_begins[word + 1] - all.sense_begins[word]);
}

bool is_base_form(std::string_view word, PartOfSpeech part) {
  const auto found = find_word(word);
  return found && std::ranges::any_of(all_senses(*found), [&](Synset one) { return part_of(one) == part; });
}

struct Ending {
  std::string_view ending, base;
};
/// The rules of detachment of morphy(7WN).
std::span<const Ending> endings_of(PartOfSpeech part) {
  static constexpr std::array<Ending, 8> kNouns = {{{"s", ""},
                                                    {"ses", "s"},
                                                    {"xes", "x"},
                                                    {"zes", "z"},
                                                    {"ches", "ch"},
                                                    {"shes", "sh"},
                                                    {"men", "man"},
                                                    {"ies", "y"}}};
  static constexpr std::array<Ending, 8> kVerbs = {
      {{"s", ""}, {"ies", "y"}, {"es", "e"}, {"es", ""}, {"ed", "e"}, {"ed", ""}, {"ing", "e"}, {"ing", ""}}};
  static constexpr std::array<Ending, 4> kAdjectives = {{{"er", ""}, {"est", ""}, {"er", "e"}, {"est", "e"}}};
  switch (part) {
    case PartOfSpeech::noun:
      return kNouns;
    case PartOfSpeech::verb:
      return kVerbs;
    case PartOfSpeech::adjective:
      return kAdjectives;
    case PartOfSpeech::adverb:
      break;
  }
  return {};
}

/// "left" → "leave", where the list of exceptions has it.
std::vector<std::string> irregular_bases(const std::string& word, PartOfSpeech part) {
  const std::string_view all = tables().exceptions;
  const std::string head = std::string(1, "nvar"[static_cast<size_t>(part)]) + " " + word + " ";
  std::vector<std::string> bases;
  size_t first = 0, last = all.size();  // both at the beginning of a line
  while (first < last) {
    const size_t middle = first + (last - first) / 2;
    const size_t before = middle == 0 ? std::string_view::npos : all.rfind('\n', middle - 1);
    const size_t begin = before == std::string_view::npos ? 0 : before + 1;
    if (all.substr(begin, head.size()) < head)
      first = all.find('\n', middle) + 1;
    else
      last = begin;
  }
  for (; all.substr(first, head.size()) == head; first = all.find('\n', first) + 1)
    bases.emplace_back(all.substr(first + head.size(), all.find('\n', first) - first - head.size()));
  return bases;
}

/// Artefacts, food, plants, objects, substances and what they are kinds of: lexicographer files.
bool can_be_touched(Synset synset) {
  static constexpr std::array<int, 6> kFiles = {3, 6, 13, 17, 20, 27};
  return std::ranges::count(kFiles, tables().files[synset]) > 0;
}

/// The most frequent ones.
std::set<Synset> touchable_senses(const std::string& noun, size_t max_count) {
  std::set<Synset> found;
  for (const Synset sense : senses(noun, PartOfSpeech::noun))
    if (can_be_touched(sense) && found.size() < max_count) found.insert(sense);
  return found;
}

}  // namespace

std::vector<std::string> base_forms(const std::string& word, PartOfSpeech part) {
  std::vector<std::string> bases = irregular_bases(word, part);
  const auto add = [&](std::string base) {
    if (std::ranges::count(bases, base) == 0 && is_base_form(base, part)) bases.push_back(std::move(base));
  };
  add(word);
  for (const auto& [ending, base] : endings_of(part))
    if (word.size() > ending.size() + 1 && word.ends_with(ending))
      add(word.substr(0, word.size() - ending.size()) + std::string(base));
  return bases;
}

bool is_word(const std::string& word) {
  constexpr std::array kParts = {PartOfSpeech::noun, PartOfSpeech::verb, PartOfSpeech::adjective,
                                 PartOfSpeech::adverb};
  return std::ranges::any_of(kParts, [&](PartOfSpeech part) { return !base_forms(word, part).empty(); });
}

std::vector<Synset> senses(const std::string& word, PartOfSpeech part) {
  std::vector<Synset> found;
  for (const std::string& base : base_forms(word, part))
    if (const auto index = find_word(base))
      for (const Synset sense : all_senses(*index))
        if (part_of(sense) == part && std::ranges::count(found, sense) == 0) found.push_back(sense);
  return found;
}

std::span<const Synset> hypernyms(Synset sense) {
  const Tables& all = tables();
  return all.hypernyms.subspan(all.hypernym_begins[sense],
                               all.hypernym_begins[sense + 1] - all.hypernym_begins[sense]);
}

bool is_person(const std::string& noun) {
  constexpr int kPerson = 18;  // lexicographer file
  const std::vector<Synset> all = senses(noun, PartOfSpeech::noun);
  return !all.empty() && tables().files[all.front()] == kPerson;
}

bool may_be_somewhere(const std::string& noun) {
  // Lexicographer files: tops, animals, bodies, persons.
  constexpr std::array<int, 4> kLiving = {3, 5, 8, 18};
  return std::ranges::any_of(senses(noun, PartOfSpeech::noun), [&](Synset one) {
    return can_be_touched(one) || std::ranges::count(kLiving, tables().files[one]) > 0;
  });
}

namespace {

/// How the most frequent senses of two nouns are related.
Relation relation_of_senses(std::set<Synset> reached, const std::set<Synset>& wanted, int max_steps) {
  const auto meets = [&] {
    return std::ranges::any_of(reached, [&](Synset one) { return wanted.contains(one); });
  };
  if (meets()) return Relation::synonym;
  for (int step = 0; step < max_steps; ++step) {
    std::set<Synset> next;
    for (const Synset one : reached)
      for (const Synset above : hypernyms(one))
        if (can_be_touched(above)) next.insert(above);
    reached = std::move(next);
    if (meets()) return Relation::kind;
  }
  return Relation::none;
}

}  // namespace

Relation relation_of(const std::string& noun, const std::string& other, int max_steps) {
  constexpr size_t kFrequent = 1, kMaxSenses = 2;
  // In two rare senses "can" and "pot" are both a toilet.
  for (const auto& [of_noun, of_other] :
       {std::pair(kFrequent, kMaxSenses), std::pair(kMaxSenses, kFrequent)}) {
    const Relation relation =
        relation_of_senses(touchable_senses(noun, of_noun), touchable_senses(other, of_other), max_steps);
    if (relation != Relation::none) return relation;
  }
  return Relation::none;
}

}  // namespace loci::memory::wordnet
