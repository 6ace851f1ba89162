#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

/// Tells the names in a reading of a sentence from words that it only takes for names.
class NameCheck {
 public:
  /// Both outlive this.
  NameCheck(const Store& store, const Snapshot& snapshot) : store_(store), snapshot_(snapshot) {}

  /// Whether a name has a word before its noun that nobody knows, or ends like a verb or an adverb, or is
  /// nothing that could stand somewhere ("meeting"): then it is likelier that the sentence was not understood
  /// than that something is called so.
  bool is_strange(const Query& query) const;
  /// Whether an object stands where a question has a place: "when was the jam opened".
  bool is_object_for_place(const Query& query) const;
  /// Whether a place stands where a question has an object: "where did the shelf go".
  bool is_place_for_object(const Query& query) const;
  /// Whether a name of several words has one that means nothing in this memory.
  bool has_unknown_word(const Query& query) const;
  /// Whether the query names no object, or one that the memory knows.
  bool is_known(const Query& query) const;
  /// The words of this memory for its objects and places.
  const std::set<std::string>& words() const;

 private:
  bool is_strange_name(const std::vector<std::string>& name) const;

  const Store& store_;
  const Snapshot& snapshot_;
  mutable std::optional<std::set<std::string>> words_;  ///< read when first asked for
};

}  // namespace loci::memory
