#pragma once

#include <map>
#include <string>

#include "memory/store/store.h"

namespace loci::memory {

/// What is said of a thing: by kind ("text", "product", "barcode", "label") its values, each with the part of
/// the sightings of which this kind says anything that say so.
using Words = std::map<std::string, std::map<std::string, double>>;

/// What annotators read on an object and call it in its last hundred sightings. A class that people gave it
/// stands in place of the annotators' labels; what catalogues say is left out.
Words words_of(const Store& store, Id object);

/// How much more probable the words are if both are of the same thing, logarithm: the sum over the kinds that
/// both have. Texts are compared word by word, upper and lower case alike.
double words_log_ratio(const Words& a, const Words& b);

}  // namespace loci::memory
