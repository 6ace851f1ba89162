#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "mapping/base/error.h"
#include "mapping/base/text/json_fwd.h"

namespace loci {

/// Why a frame, a scan or a detection gave nothing.
enum class Reason {
  no_pose,
  no_matching_frame,
  no_depth,
  no_color,
  damaged,
  no_depth_in_range,
  depth_too_sparse,
  no_plane,
  camera_rolled,
  map_not_level,
  outside_map,
  no_support_in_view,
  unconfirmed,
  annotator_failed,
  outside_image,
  no_depth_inside,
  nothing_new,
  map_explained,
  support_empty,
  count  ///< of the above
};

/// What a run could use, and why it could not use the rest: stages fill it, and it is rendered here, once.
class Tally {
 public:
  /// `unit`: what is counted, "frame".
  explicit Tally(std::string unit = "frame") : unit_(std::move(unit)) {}

  void add_used() { ++used_; }
  void add(Reason reason, size_t count = 1) { counts_[static_cast<size_t>(reason)] += count; }
  /// With an example, which reasons() names the first of.
  void add(Reason reason, const std::string& example);
  void add(const Tally& other);

  size_t used() const { return used_; }
  size_t count(Reason reason) const { return counts_[static_cast<size_t>(reason)]; }
  size_t total() const;
  /// Whether at least a tenth could be used: those that were, and those in which there was nothing to find.
  bool usable() const;

  /// "no supporting plane in 120, no pose in 45", the most frequent first; empty when all were used.
  std::string reasons() const;
  /// What to do about the most frequent reason; empty without any.
  std::string hint() const;
  /// {"total", "used", "reasons": {"no_plane": 120}}.
  Json report() const;

  /// The end of a run. Unless usable(): Error that says why and what to try. When it is usable and found no
  /// `sought` ("object"): the same as a warning. Nothing happens without units.
  void explain(const std::string& sought, const FileLocation& where, Warnings& warnings) const;

 private:
  std::string unit_;
  size_t used_ = 0;
  std::array<size_t, static_cast<size_t>(Reason::count)> counts_ = {};
  std::array<std::string, static_cast<size_t>(Reason::count)> examples_ = {};
};

}  // namespace loci
