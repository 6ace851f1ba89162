#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "memory/store/store.h"

namespace loci::memory {

/// Classes of objects, their synonyms, superclasses and properties: a mug is a cup is crockery, milk is
/// perishable, "tea cup" is another word for "cup". A memory stores each taxonomy that was loaded as the
/// configuration of the run that loaded it: an answer as known at a time uses the one that was known then.
class Taxonomy {
 public:
  struct Concept {
    std::vector<std::string> synonyms = {};
    std::vector<std::string> kinds = {};       ///< `is`: what it is a kind of
    std::vector<std::string> properties = {};  ///< "perishable"
  };

  Taxonomy() = default;
  /// YAML: {mug: {synonyms: [cup, tea cup], is: [crockery], properties: [..]}, ..}. Error for unknown keys, a
  /// word that belongs to two concepts, and a concept that is a kind of itself.
  static Taxonomy read(const std::filesystem::path& path);
  /// The one that was loaded last; empty when there is none.
  static Taxonomy of(const Store& store, const AsOf& as_of);
  /// Adds it to a memory, as what holds from now on.
  void save(Store& store) const;

  const std::map<std::string, Concept>& concepts() const { return concepts_; }
  /// All words (lower case) for the objects that a word means: itself, its synonyms, every kind below it, and
  /// every concept with that property. Plurals mean their singular.
  std::set<std::string> meanings(const std::string& word) const;

 private:
  void check(const std::string& file) const;
  std::string concept_of(const std::string& word) const;  ///< "" = none
  std::map<std::string, Concept> concepts_;
};

std::string to_text(const Taxonomy& taxonomy);
Json to_json(const Taxonomy& taxonomy);

}  // namespace loci::memory
