#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

// English words and what they mean, from WordNet 3.0 (Debian's wordnet-base). The build compiles its single
// words in; nothing is read at start. WordNet 3.0 is Copyright 2006 by Princeton University, all rights
// reserved; its licence permits use, copying, modification and distribution for any purpose without fee when
// this notice is kept.

namespace loci::memory::wordnet {

/// A set of synonyms, by its number in the compiled tables.
using Synset = std::uint32_t;

enum class PartOfSpeech { noun, verb, adjective, adverb };

/// Base forms of a word as this part of speech, itself included where it is one: "left" → "leave", "knives" →
/// "knife". Empty for other words. Lower case.
std::vector<std::string> base_forms(const std::string& word, PartOfSpeech part);
/// Whether some base form of it is an English word. Function words ("whom") are none.
bool is_word(const std::string& word);
/// What the base forms of a word mean, the most frequent first.
std::vector<Synset> senses(const std::string& word, PartOfSpeech part);
/// What a sense is a kind of, directly.
std::span<const Synset> hypernyms(Synset sense);

/// Whether a noun, in its most frequent sense, is a person: "neighbour".
bool is_person(const std::string& noun);
/// Whether a noun may be somewhere: "spanner", "cat", but not "meeting".
bool may_be_somewhere(const std::string& noun);

/// How a noun for something that can be touched is related to another one.
enum class Relation {
  none,
  synonym,  ///< "pail", "bucket"
  kind,     ///< the first is a kind of the second: "plate", "crockery"
};
/// Up to `max_steps` from a kind to what it is a kind of. Rare senses do not count: a plate is crockery, and
/// no food.
Relation relation_of(const std::string& noun, const std::string& other, int max_steps);

}  // namespace loci::memory::wordnet
