#pragma once

#include <string>
#include <vector>

#include "apps/evaluate/changes/truth.h"
#include "mapping/base/json.h"
#include "memory/store/store.h"

namespace loci::changes {

/// What the memory says about one true transition.
struct JudgedTransition {
  TrueTransition truth;
  /// unchanged, moved, looks_different, added, removed, kept (neither seen nor gone), identity lost (gone and
  /// appeared as another object), confused (taken for another thing), not found (no cluster in a frame).
  std::string said;
  Id from_object = 0, to_object = 0;  ///< the memory's objects at the two ends; 0 = none
  bool right() const { return said == truth.kind; }
};

struct Comparison {
  std::vector<JudgedTransition> transitions;
  size_t visible = 0, found = 0;  ///< true things in frames, and those with an observation
  size_t same_pairs = 0,
         same_kept = 0;  ///< unchanged or moved, found at both ends: the memory's number is kept
  size_t returned = 0, recognised = 0;  ///< came back after having been removed: recognised as the same
  size_t phantoms = 0;                  ///< objects of the memory that never were a true thing

  size_t certain() const;
  size_t right() const;
  std::string text(bool verbose) const;
  Json to_json() const;
};

/// `names` of frames for people by index; may be empty.
Comparison compare(const Truth& truth, const Store& store);

}  // namespace loci::changes
