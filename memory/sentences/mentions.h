#pragma once

#include <functional>
#include <string>
#include <vector>

#include "memory/questions/snapshot.h"
#include "memory/sentences/lexicon.h"

namespace loci::memory {

/// A name in a sentence.
struct Mention {
  size_t first = 0, last = 0;  ///< words [first, last)
  bool place = false;          ///< else an object
  bool known = false;          ///< means something in the memory
  std::string text = {};
};

/// Names in the order of the words: the longest ones that mean something in the memory; else nouns of
/// households, and nouns after an article that `is_word` does not know.
std::vector<Mention> find_mentions(const Tokens& tokens, const Snapshot& snapshot,
                                   const std::function<bool(const std::string& lemma)>& is_word);

/// Mentions that one name may be are one: where `coordinated`, "the oil and the pot"; where `attached`, "the
/// cup on the counter".
std::vector<Mention> joined_mentions(const std::vector<Mention>& mentions, const Tokens& tokens,
                                     bool coordinated, bool attached);

}  // namespace loci::memory
