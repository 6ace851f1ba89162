#pragma once

#include <string>
#include <vector>

#include "memory/questions/snapshot.h"

namespace loci::memory {

/// What people call objects and places in a sentence.
class Names {
 public:
  explicit Names(const Snapshot& snapshot) : snapshot_(snapshot) {}

  /// The best name known, without an article: alias, product or class, else the colour ("red object"), with
  /// the shortest qualifier that tells it from others of that name: colour, place, or id.
  std::string of(const ObjectRef& object) const;
  /// As the subject of a sentence: "the milk", "my cup", "object_4".
  std::string subject(const ObjectRef& object) const;

 private:
  const Snapshot& snapshot_;
};

/// "the milk", and "my cup" as it is.
std::string with_article(const std::string& name);
/// "the fridge", "drawer_1".
std::string part_in_words(const std::string& name);
/// "on table_1", "in drawer_1", "in the cutlery drawer".
std::string in_words(const PlaceRef& place);
/// "drawer_1" for drawer_1_bottom.
std::string name_in_words(const std::string& place);
/// The piece of furniture that a link or joint of the map is a part of: "drawer_1" for drawer_1_front_joint,
/// drawer_1_front and drawer_1_bottom.
std::string piece_in_words(std::string name);
/// How names of places and parts are compared: in lower case, blanks as '_', without an article before them.
std::string name_key(const std::string& name);
/// "milk, tea and pot", at most `count` of them: "milk, tea and 4 more"; "nothing" for none.
std::string list_in_words(const std::vector<std::string>& names, size_t count = 5);

}  // namespace loci::memory
