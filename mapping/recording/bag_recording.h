#pragma once

#include <mutex>

#include "mapping/recording/file_recording.h"
#include "mapping/recording/ros_bag.h"

namespace loci::mapping {

/// RGB-D frames of a ROS 1 bag: the depth and the colour topic with the most messages, the cameras beside
/// them, and poses from /tf and /tf_static. Each depth image takes the nearest colour image; times are
/// those of the headers. The map frame is what the depth camera's frame hangs on in the end.
class BagRecording : public Recording {
 public:
  explicit BagRecording(const std::filesystem::path& path);

  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return frames_.size(); }
  RgbdFrame frame(size_t i) const override;
  TimeNs time_of(size_t i) const override { return frames_.at(i).time_ns; }
  int64_t index_of(size_t i) const override { return frames_.at(i).index; }

 private:
  /// A topic of images.
  struct Stream {
    std::string topic;
    bool compressed = false;
    std::string frame;                            ///< of its first header
    std::vector<std::pair<TimeNs, size_t>> when;  ///< stamp and number of each message, ascending
  };
  Stream stream_of(const BagTopic& topic) const;
  void choose_streams();
  std::optional<PinholeCamera> camera_of(const Stream& stream) const;
  void set_cameras();
  void add_frames();
  std::string where(const std::string& topic, size_t message) const;

  RosBag bag_;
  mutable std::mutex bag_lock_;
  RecordingInfo info_;
  Stream depth_, color_;
  std::vector<FrameFiles> frames_;               ///< index: number of the depth message
  std::vector<std::optional<size_t>> color_of_;  ///< by number of the depth message
};

}  // namespace loci::mapping
