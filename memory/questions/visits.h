#pragma once

#include "memory/questions/snapshot.h"

namespace loci::memory {

/// Looks that follow each other closer than this are one visit: no single view sees all of a place.
inline constexpr TimeNs kVisitGap = 600 * kSecond;

/// The first scene of the visit that ends with the last scene as of a time; unset without a scene.
std::optional<TimeNs> last_visit_begin(const Store& store, const AsOf& as_of);

/// What the views of one visit saw of a place, taken together.
struct PlaceLook {
  TimeNs from = 0, to = 0;              ///< the views that are counted
  Id scene = 0;                         ///< the last of them
  std::optional<double> fraction = {};  ///< of the place; unset where no view states it
};
/// The part of a place that the views of a visit saw: of the best view where that is enough, else of all
/// together.
double fraction_of_visit(const Snapshot& snapshot, const PlaceRow& place, TimeNs from, TimeNs to,
                         double best_view);
/// The last visit that saw at least `min_fraction` of a place as of the moment of the snapshot; unset without
/// one.
std::optional<PlaceLook> last_look(const Snapshot& snapshot, const PlaceRow& place, double min_fraction = 0);

}  // namespace loci::memory
