#pragma once

#include <span>
#include <utility>

#include "memory/sentences/lexicon.h"

namespace loci::memory::vocabulary {

// The words of the grammar as tables; lexicon.h reads them.

/// A lemma and the words that stand for it; the lemma itself need not be given.
using Lemma = std::pair<const char*, const char*>;
std::span<const Lemma> lemmas();

/// Several words that are one: a form with (a|b) and [optional] parts, and what it is replaced by.
using Compound = std::pair<const char*, const char*>;
std::span<const Compound> compounds();

/// Words of a class, as lemmas.
struct ClassWords {
  WordClass word_class;
  const char* words;
};
std::span<const ClassWords> classes();

/// What words around a question do; a word may do several of these.
enum Use : unsigned {
  kAddress = 1,       ///< "mate", "robot"
  kPolite = 2,        ///< "please", "good morning", "excuse me"
  kIntroduction = 4,  ///< "could you tell me", "I was wondering"
  kClaim = 8,         ///< an introduction that "that" may follow: "do you think"
};
struct SurroundingWords {
  unsigned uses;
  const char* words;
};
std::span<const SurroundingWords> surroundings();

/// Furniture, appliances and rooms.
extern const char* const kFurniture;
/// Other nouns, and adjectives, of a home, which no memory need know: they are names, and no typos of other
/// words.
extern const char* const kHouseholdWords;
/// Words that are no typos, beside all these: pronouns, numbers, times.
extern const char* const kOtherWords;

}  // namespace loci::memory::vocabulary
