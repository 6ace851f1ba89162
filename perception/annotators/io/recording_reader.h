#pragma once

#include "mapping/recording/recording.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Frames of the Recording among the resources, one scene each: views of colour and depth, cameras, pose,
/// joints. Poses that the recording does not have are assumed: the camera stands still, and the map frame is
/// the first supporting plane that it sees.
class RecordingReader : public Reader {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  size_t count() const override;
  size_t position() const override { return position_; }
  FrameId upcoming() const override;
  void read_next(cas::Cas& cas, Context& context) override;
  void skip(size_t frames) override { position_ += frames; }

 private:
  size_t frame_number(size_t position) const { return position * static_cast<size_t>(every_); }

  int every_ = 1;
  const mapping::Recording* recording_ = nullptr;
  size_t position_ = 0;
  std::optional<Isometry3d> assumed_pose_;
  Isometry3d map_from_poses_ = Isometry3d::Identity();  ///< for poses that are not in the frame of the map
  std::string map_frame_;                               ///< empty = the recording's
};

}  // namespace loci::perception
