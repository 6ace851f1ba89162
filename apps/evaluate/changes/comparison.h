#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/evaluate/changes/calibration.h"
#include "apps/evaluate/changes/story.h"
#include "apps/evaluate/changes/truth.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/recording/recording.h"
#include "memory/belief/association/decisions.h"

namespace loci::apps::changes {

/// What can be said of a true transition: unchanged, moved, looks_different, added, removed, kept (neither
/// seen nor gone), identity lost (gone and appeared as another object), confused (taken for another object),
/// not found (no cluster in a frame).
inline constexpr const char* kSaidKinds[] = {"unchanged", "moved",         "looks_different",
                                             "added",     "removed",       "kept",
                                             "confused",  "identity lost", "not found"};

/// What is said about one true transition.
struct JudgedTransition {
  TrueTransition truth;
  std::string said;                                     ///< one of kSaidKinds
  memory::Id from_object = 0, to_object = 0;            ///< objects at the two ends; 0 = none
  memory::Id from_observation = 0, to_observation = 0;  ///< of it at the two ends; 0 = not found
  bool counts() const { return truth.kind != "uncertain"; }
  /// The kind of the truth; moved also for what moved and turned, moved or looks_different for what turned in
  /// its place, looks_different for what was given another colour.
  bool right() const;
};

/// How one way of telling what happened compares with the truth.
struct Comparison {
  std::string method;
  std::vector<JudgedTransition> transitions;
  size_t visible = 0, found = 0;  ///< true objects in frames, and those with an observation
  size_t attributed = 0;          ///< observations taken for objects, those of hardly visible objects aside
  size_t agreed = 0;      ///< of these, that fit the best pairing of true objects with objects, each once
  size_t switches = 0;    ///< an object that is found gets another number than when it was found before
  size_t pairs = 0;       ///< that could have been switches
  Stated association;     ///< of these pairs: that it is this object, and whether it is that of before
  size_t false_gone = 0;  ///< said to be gone while it stood where it had been seen
  size_t returned = 0, recognised = 0;   ///< came back after having been removed: recognised as the same
  size_t phantoms = 0;                   ///< objects that never were a true object
  memory::belief::ArbiterCount arbiter;  ///< of a memory: what simple trackers would have settled

  /// Counts those of another recording, too.
  void add(const Comparison& other);
  size_t certain() const;
  size_t right() const;
  size_t count(const std::string& kind) const;
  size_t count_right(const std::string& kind) const;
  size_t count(const std::string& kind, const std::string& said) const;
  /// F1 over the sightings of objects: 2 agreed / (visible + attributed), [Ristani 2016].
  double identity_f1() const;
};

/// The associations of the methods that state probabilities, for reliability_diagrams().
std::vector<std::pair<std::string, Stated>> stated_associations(const std::vector<Comparison>& methods);

/// Pairs true objects with what was observed in a frame, nearest first; index of the object by that of the
/// sight.
std::map<size_t, size_t> find_true_objects(const std::vector<TrueObject>& true_objects, const Moment& moment);

Comparison compare(const std::string& method, const Truth& truth, const Moments& moments, const Story& story);

/// What a memory of a recording says (first), and greedy and nearest of the same observations. `clutter` is
/// what the map of the recording lacks but the room has (Truth::clutter).
std::vector<Comparison> compare_all(const std::filesystem::path& folder, const mapping::Recording& recording,
                                    const memory::Store& memory, const std::vector<TrueObject>& clutter = {});

/// The methods beside each other, the first being the one that is looked at in detail.
std::string text(const std::vector<Comparison>& methods, bool verbose);
Json to_json(const std::vector<Comparison>& methods);

}  // namespace loci::apps::changes
