#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mapping/base/json_fwd.h"
#include "mapping/base/pose.h"
#include "memory/belief/habits.h"
#include "memory/belief/observation.h"
#include "memory/catalogue/words.h"
#include "memory/store/store.h"

namespace loci::memory {

/// One thing of a home: what it is, what it is called, what it looks like.
struct CatalogueEntry {
  std::string name;                                        ///< in its own home: "object_3"
  std::string class_name;                                  ///< empty = nobody said
  std::vector<std::pair<std::string, std::string>> facts;  ///< alias, owner and whatever people say; no state
  std::string color;                                       ///< name; empty = unknown
  std::optional<Vector3d> size;                            ///< metres
  Words words;                                             ///< that annotators read on it and call it
  std::vector<std::vector<belief::Descriptor>> looks;      ///< a few, over time
  size_t sightings = 0;
};

/// What there is in a home and how it is handled: object knowledge without episodes, to be used elsewhere.
struct Catalogue {
  std::string home;  ///< known by its first recording or scene, the same for every export
  std::vector<CatalogueEntry> entries;
  std::map<std::string, belief::Factor> handling;  ///< by class, as the belief learned it
  std::map<std::string, std::map<std::string, double>>
      kept_on;  ///< by class: share of its sightings by place class
};

/// By which its catalogue is known; empty for a memory without scenes.
std::string home_of(const Store& store);
Catalogue catalogue_of(const Store& store);

Json to_json(const Catalogue& catalogue);
/// Error when it is none, or of a newer version; `file` is for its message.
Catalogue catalogue_from(const Json& json, const std::string& file);
Catalogue read_home_catalogue(const std::filesystem::path& file);

/// What taking a catalogue in, or looking through those that a memory has, made known.
struct CatalogueResult {
  size_t entries = 0, objects = 0;                ///< compared
  size_t added = 0, changed = 0, taken_back = 0;  ///< facts with source "catalogue"
  struct Match {
    Id object = 0;
    std::string key, value;
    double probability = 0;
    std::string by = {};  ///< what it was known by: "looks", "words" or "looks and words"
  };
  std::vector<Match> known;  ///< what the catalogues say of this memory's objects, in order of object

  std::string summary() const;
  Json report() const;
};

/// Keeps a catalogue in a memory, in the place of an older one of that home, and says of each object that
/// fits an entry by its looks and its words what is known of it: facts with source "catalogue" and a
/// probability. What people say comes first. Taking it in again changes nothing. Error for the catalogue of
/// this very home.
CatalogueResult import_catalogue(Store& store, const Catalogue& catalogue);
/// The same for what was seen since then. Without catalogues nothing happens.
CatalogueResult apply_catalogues(Store& store);

}  // namespace loci::memory
