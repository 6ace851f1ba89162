#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/belief/interaction_model.h"
#include "memory/belief/scene.h"
#include "memory/catalogue/object_description.h"
#include "memory/store/facts.h"
#include "memory/store/store.h"

namespace loci::memory {

/// The source of facts that follow from catalogues; others are statements of people or programs.
inline constexpr const char* kCatalogueSource = "catalogue";

/// One object of a home: what it is, what it is called, what it looks like.
struct CatalogueEntry {
  std::string name;        ///< in its own home: "object_3"
  std::string class_name;  ///< empty = unknown
  std::vector<std::pair<std::string, std::string>>
      facts;                     ///< alias, owner and other facts of people; no state
  std::string color;             ///< name; empty = unknown
  std::optional<Vector3d> size;  ///< metres
  ObjectTerms terms;
  ObjectViews views;  ///< a few, over time
  size_t observations = 0;
};

/// The objects of a home and how people handle them, without observations: knowledge for another home.
struct Catalogue {
  std::string home;  ///< identified by its first recording or scene
  std::vector<CatalogueEntry> entries;
  std::map<std::string, belief::RateFactor> handling;  ///< by class, as the belief learned it
  std::map<std::string, std::map<std::string, double>>
      kept_on;  ///< by class: share of its observations by class of place
};

/// The id of the home in its catalogue; empty for a memory without scenes.
std::string home_of(const Store& store);
Catalogue catalogue_of(const Store& store);

Json to_json(const Catalogue& catalogue);
/// Error when it is not a catalogue, or of another version; `file` is for the message.
Catalogue catalogue_from(const Json& json, const std::string& file);
Catalogue read_home_catalogue(const std::filesystem::path& file);

/// The result of importing a catalogue, or of applying those that a memory has.
struct CatalogueResult {
  size_t entries = 0, objects = 0;                ///< compared
  size_t added = 0, changed = 0, taken_back = 0;  ///< facts with source "catalogue"
  struct Match {
    Id object = 0;
    std::string key, value;
    double probability = 0;
    std::string by = {};  ///< evidence: "appearance", "terms" or "appearance and terms"
  };
  std::vector<Match> known;  ///< facts of the catalogues about the objects of this memory, in order of object

  std::string summary() const;
  Json report() const;
};

/// Stores a catalogue in a memory, replacing an older one of that home, and adds facts with source
/// "catalogue" and a probability to the objects that match an entry. Facts of people take precedence.
/// Importing again changes nothing. Error for the catalogue of this memory's own home.
CatalogueResult import_catalogue(Store& store, const Catalogue& catalogue);
/// Matches again, after new observations or new examples. Examples are the objects of this memory with a fact
/// `taught`, whose value is a class: what looks like them gets the class, with a probability; of what is
/// unlike all of them nothing is stated. Without catalogues and examples nothing happens.
CatalogueResult apply_catalogues(Store& store);

}  // namespace loci::memory
