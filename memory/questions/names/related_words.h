#pragma once

#include <map>
#include <set>
#include <string>

#include "mapping/base/math/pose.h"

namespace loci::memory {

/// Names of objects that a word means besides those called so: kinds of it ("fruit": apple, banana), synonyms
/// ("tin": can); else what it is named after ("teaspoon": spoon). English of households and WordNet.
std::set<std::string> related_names(const std::string& word, const std::set<std::string>& names);

/// Whether a word is a noun, or one of those that this module lists.
bool may_have_related_names(const std::string& word);

/// Another word for a piece of furniture: "worktop" is a counter; "" = none.
std::string furniture_called(const std::string& word);

/// Whether two words together name something else than the second: a watering can is not a can, a tea cup is
/// a cup.
bool is_other_thing(const std::string& modifier, const std::string& noun);

/// "shelves" as "shelf"; a word that is its own singular, or that is not known, as it is.
std::string singular_of(const std::string& word);
/// The same of a name of furniture, "shelf" for "shelves", also where the plural is a word of its own:
/// "drawers".
std::string singular_of_furniture(std::string name);

/// What "biggest" goes by, and "bigger" of two, of a size in metres along the axes of the map.
using SizeMeasure = double (*)(const Vector3d& size);
const std::map<std::string, SizeMeasure>& superlatives();
/// Superlatives of what no camera measures: "heaviest" goes by "the weight".
const std::map<std::string, std::string>& unmeasured();
bool is_superlative(const std::string& word);
/// Of "second" in "second biggest" 1; 0 of other words.
size_t rank_called(const std::string& word);

}  // namespace loci::memory
