#pragma once

#include <map>
#include <mutex>

#include "mapping/recording/file_recording.h"
#include "mapping/recording/rectification.h"
#include "mapping/recording/ros/bag.h"
#include "mapping/recording/ros/messages.h"
#include "mapping/recording/stamped_poses.h"

namespace loci::mapping {

/// RGB-D frames of one camera of a bag of ROS 1 or ROS 2. A camera is named by what its topics begin with; it
/// is a depth topic and the colour topic that shares most of its name. The one with the most images is read
/// unless a camera or topics are given. Cameras come from the
/// `camera_info` beside the images, poses from /tf and /tf_static, joints from JointState. Each depth image
/// takes the nearest colour image; times are those of the headers. The map frame is what the depth camera's
/// frame hangs on in the end. The index of a frame is the number of its depth message.
class RosRecording : public FrameListRecording {
 public:
  explicit RosRecording(const std::filesystem::path& path, const RecordingOptions& options = {},
                        Progress* progress = nullptr);

  RgbdFrame frame(size_t i) const override;

 private:
  /// A topic of images.
  struct Stream {
    std::string topic;
    Serialization serialization = Serialization::ros1;
    bool compressed = false;
    std::string encoding;                         ///< of its first message
    std::string frame;                            ///< of its first header
    std::vector<std::pair<TimeNs, size_t>> when;  ///< stamp and number of each message, ascending

    bool is_depth() const;
    bool has_colors() const;
  };
  /// What the first pass over the bag collects.
  struct Content {
    std::map<std::string, Stream> images;
    std::map<std::string, RosCamera> cameras;
    std::map<std::string, Isometry3d> extrinsics;  ///< of librealsense: stream_from_reference by topic
    TransformTree transforms;
    std::vector<RosJoints> joints;
    std::vector<RosAcceleration> accelerations;
    double depth_unit_m = 0.001;
  };

  void take(const BagTopic& topic, size_t i, TimeNs recorded, const RosMessage& message,
            Content& content) const;
  Content read_content();
  const Stream* color_for(const Stream& depth, const Content& content) const;
  void choose_streams(const Content& content, const RecordingOptions& options);
  std::vector<const Stream*> depths_of_camera(const Content& content, const RecordingOptions& options);
  const Stream& chosen(const std::string& topic, const Content& content, bool depth) const;
  std::optional<RosCamera> camera_of(const Stream& stream, const Content& content) const;
  void set_cameras(const Content& content);
  void set_depth_camera(const Content& content);
  void set_color_camera(const Content& content);
  PinholeCamera pinhole_of(const Stream& stream, const RosCamera& camera, Rectifier& rectifier);
  void set_color_pose(const Content& content, TimeNs time);
  void add_frames(const Content& content, double color_delay_s);
  void set_joints(std::vector<RosJoints> joints);
  void set_up(const Content& content);
  std::string where(const std::string& topic, size_t message) const;
  cv::Mat depth_image(size_t message) const;
  cv::Mat color_image(size_t message) const;
  /// Of the first message that can be read; Error when none can.
  cv::Mat first_depth_image() const;
  RosMessage message_of(const Stream& stream, size_t message, std::string& bytes) const;

  RosBag bag_;
  mutable std::mutex bag_lock_;
  Stream depth_, color_;
  double depth_unit_m_ = 0.001;
  ImageCorrection correction_;
  std::vector<std::optional<size_t>> color_of_;  ///< by number of the depth message
};

}  // namespace loci::mapping
