#pragma once

#include <filesystem>
#include <optional>

#include "mapping/base/math/tally.h"
#include "mapping/recording/recording.h"
#include "mapping/render/render.h"
#include "mapping/world/world.h"
#include "memory/ingest/detections.h"

namespace loci::memory {

/// Gives detections in images their place by the depth of the recording that they were made in.
class DetectionLifter {
 public:
  /// `map`: URDF whose surfaces are left out; empty = none.
  DetectionLifter(const mapping::Recording& recording, const std::filesystem::path& map, Warnings& warnings);

  const mapping::Recording& recording() const { return recording_; }
  /// The frame taken nearest to a time, at most 50 ms off.
  std::optional<size_t> frame_at(TimeNs time) const;

  /// Places the detections without position by the frame of the scene: position, size, colour; and sets the
  /// camera. Those that cannot be lifted are left out and counted. Why none is left; then the frame is unset
  /// when it is of no use.
  std::optional<Reason> lift(DetectedScene& scene);

  /// Of the detections without position.
  const Tally& detections() const { return detections_; }

 private:
  void render_map(DetectedScene& scene);

  const mapping::Recording& recording_;
  mapping::World world_;
  mapping::RenderScene scene_;
  size_t part_ = 0;
  bool has_map_ = false;
  Tally detections_{"detection"};
};

}  // namespace loci::memory
