#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace loci::memory::wordnet {

/// WordNet as the build compiles it (compile/). Words are sorted; of word i the senses are
/// senses[sense_begins[i] … sense_begins[i + 1]), of synset s the hypernyms likewise.
struct Tables {
  std::string_view words;  ///< each followed by '\n'
  std::span<const std::uint32_t> word_begins;
  std::span<const std::uint32_t> sense_begins, senses;
  std::span<const std::uint8_t> files;  ///< by synset: its lexicographer file, see lexnames(5WN)
  std::span<const std::uint32_t> hypernym_begins, hypernyms;
  std::string_view exceptions;  ///< lines "n knives knife", sorted; n, v, a or r is the part of speech
};
const Tables& tables();

}  // namespace loci::memory::wordnet
