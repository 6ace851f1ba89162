#pragma once

#include <functional>
#include <string>
#include <vector>

#include "memory/sentences/lexicon.h"

namespace loci::memory {

/// Whether words are the name of an object or a place.
using IsName = std::function<bool(const std::string&)>;

/// A question word or an auxiliary.
bool may_begin_question(const std::string& word);
/// A mark of punctuation as a word of its own.
bool is_mark(const std::string& word);

/// A pattern: words, "a|b" one of them, "a|b?" may be missing, "<x>" any words without a mark, "<x:kind>"
/// words of a kind; "^" and "$" are the ends of a fragment.
class Pattern {
 public:
  Pattern(const char* form, const char* by);

  /// Replaces the first match in the words; whether there was one.
  bool apply(Words& words, const IsName& is_name) const;

 private:
  Words elements_, by_;
};

/// Each of them once, one after the other; whether one matched.
bool apply_all(const std::vector<Pattern>& patterns, Words& words, const IsName& is_name);

}  // namespace loci::memory
