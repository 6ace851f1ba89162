#pragma once

#include <filesystem>
#include <map>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/belief/options.h"
#include "memory/reasoning/revise.h"

namespace loci::memory {

struct ReasonResult {
  size_t scenes = 0, observations = 0;
  size_t skipped = 0;  ///< scenes of which no evidence was kept, those that were let go among them
  size_t let_go = 0;   ///< scenes whose evidence was let go by a rule of retention
  std::optional<TimeNs> from = {};         ///< of the first scene that was reasoned about
  size_t facts = 0;                        ///< about objects, that came along
  std::vector<std::string> unplaced = {};  ///< others: "object_7: alias tea cup"

  std::string summary() const;
  Json report() const;
};

/// Runs the identity reasoning again over everything that a memory observed, into a new memory. Depth is that
/// of the thumbnails. Observations, images, searchable annotations, places and what is said of them come
/// along, and what people stated of objects goes with the object that has most of their observations. What
/// was forgotten stays forgotten: tombstones and forgotten scenes come along, too. Feature structures stay
/// behind. `known`: what corrections say of identities; it holds in the new memory, too.
/// Where evidence was let go it begins with what is left, which the result says. Error when `other` exists,
/// or when no evidence is left; `other` is there as a whole or not at all.
ReasonResult reason(const Store& from, const std::filesystem::path& other,
                    const belief::BeliefOptions& options, const WriteOptions& write, Progress& progress,
                    const KnownIdentities& known = {});

/// What two histories of the same observations say differently.
struct HistoryDifference {
  struct Observation {
    Id scene = 0;  ///< of the first memory
    TimeNs time = 0;
    int64_t number = 0;
    Id first = 0, second = 0;  ///< object in each memory; 0 = a false cluster
  };
  std::vector<Observation> observations;  ///< that differ
  size_t compared = 0;
  size_t objects_first = 0, objects_second = 0;
  std::map<std::string, std::pair<size_t, size_t>> events;  ///< how many of each kind
  size_t scenes_unmatched = 0;                              ///< that only one of them has

  std::string text() const;
  Json to_json() const;
};

HistoryDifference compare_histories(const Store& first, const Store& second);

}  // namespace loci::memory
