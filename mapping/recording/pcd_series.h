#pragma once

#include "mapping/recording/file_recording.h"

namespace loci::mapping {

/// Whether a path is a point cloud, or a folder with clouds and no scan set.
bool is_pcd_series(const std::filesystem::path& path);

/// Organised point clouds (width x height, x y z, optionally rgb or rgba), one file per frame in order of
/// name, seen by one camera whose pinhole is fitted to the first cloud. Clouds with z backwards and y up are
/// turned into the optical frame. Stamps are seconds, or nanoseconds, in the names ("1305031102.160407.pcd"),
/// otherwise made up. A pose is read from NAME.pose.txt (4 x 4); VIEWPOINT is none: recorders leave it at
/// whatever they like.
class PcdSeries : public Recording {
 public:
  explicit PcdSeries(const std::filesystem::path& path);

  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return frames_.size(); }
  RgbdFrame frame(size_t i) const override;
  TimeNs time_of(size_t i) const override { return frames_.at(i).time_ns; }
  int64_t index_of(size_t i) const override { return frames_.at(i).index; }

 private:
  void find_frames(const std::filesystem::path& path);
  void fit_camera();

  RecordingInfo info_;
  std::vector<FrameFiles> frames_;
  bool backwards_ = false;  ///< z points backwards and y up
};

}  // namespace loci::mapping
