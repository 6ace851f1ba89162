#pragma once

#include <map>
#include <string>
#include <vector>

#include "memory/belief/scene.h"

namespace loci::memory::belief {

/// What was seen of a place, and when. An object that was put there at a time is still unseen with the
/// product, over the views of the place since, of the share that they did not show.
struct PlaceHistory {
  struct View {
    double exposure_s = 0;  ///< BeliefState::exposure_s
    double unseen = 1;      ///< share of the place that it did not show
  };
  std::vector<View> views;  ///< in order of time; those behind which nothing is unseen are dropped
  double never_seen = 1;    ///< share that no view has shown
  double begin_s = 0;       ///< when it was seen first
  AxisBox extent;           ///< around all that was found there, place frame
  Isometry3d map_from_place = Isometry3d::Identity();  ///< when it was last known

  /// A view at `exposure_s` that showed a share of the place. Views within a second are one view.
  void add_view(double exposure_s, double share);
  /// Seconds between two times, each weighted with the probability that what was put down then is unseen.
  double unseen_seconds(double from_s, double to_s) const;
  /// The same as a share: of an object put down at an unknown time in between.
  double unseen_share(double from_s, double to_s) const;
};

/// A place of which a scene shows something.
struct PlaceView {
  std::string name;
  double share = 1;           ///< of the place that the scene shows
  double never_seen = 1;      ///< share that no scene had shown before
  double unseen_seconds = 0;  ///< time in which what was put down is unseen
};

using PlaceHistories = std::map<std::string, PlaceHistory>;

}  // namespace loci::memory::belief
