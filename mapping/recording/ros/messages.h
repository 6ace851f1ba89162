#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/time.h"
#include "mapping/recording/rectification.h"
#include "mapping/recording/ros/bag.h"

namespace loci::mapping {

// The messages that make an RGB-D recording, from the bytes that ROS 1 or ROS 2 (CDR) serialised: the two
// differ in alignment, the end of texts and the header only. All readers throw Error when bytes are missing.

/// One message; `where` names it in errors.
struct RosMessage {
  std::string_view bytes;
  Serialization serialization = Serialization::ros1;
  std::string where;
};

/// std_msgs/Header, with which the others begin. The frame comes without a leading slash.
struct RosHeader {
  TimeNs stamp_ns = 0;
  std::string frame;
};
RosHeader read_ros_header(const RosMessage& message);

/// What a sensor_msgs/Image or CompressedImage says before its pixels: "16UC1", "rgb8; jpeg compressed bgr8".
std::string read_ros_encoding(const RosMessage& message, bool compressed);

/// Whether images of this encoding or format are depth.
bool is_depth_encoding(const std::string& encoding);

/// Depth in metres (CV_32F, NaN = none) of 16UC1, mono16 (`unit_m` metres; 0 and 65535 are none), 32FC1 (m),
/// of compressedDepth (PNG or RVL) of either, or of 16UC1 as compressed PNG.
cv::Mat read_ros_depth(const RosMessage& message, bool compressed, double unit_m = 0.001);
/// Colour (CV_8UC3, BGR) of rgb, bgr, rgba, bgra and mono of 8 or 16 bits, YUV 4:2:2, NV12, NV21, Bayer
/// patterns, or of compressed PNG and JPEG.
cv::Mat read_ros_color(const RosMessage& message, bool compressed);

/// sensor_msgs/CameraInfo.
struct RosCamera {
  std::string frame;               ///< of its header
  PinholeCamera raw;               ///< K: of the image as it was taken
  Distortion distortion;           ///< of that image
  std::string distortion_problem;  ///< why its distortion cannot be undone; empty where it can
  PinholeCamera rectified;         ///< P, or K where P is not set: of the rectified image
};
RosCamera read_ros_camera(const RosMessage& message);

/// One geometry_msgs/TransformStamped of a tf message.
struct RosTransform {
  TimeNs stamp_ns = 0;
  std::string parent, child;
  Isometry3d parent_from_child = Isometry3d::Identity();
};
std::vector<RosTransform> read_ros_transforms(const RosMessage& message);

/// geometry_msgs/Transform alone.
Isometry3d read_ros_transform(const RosMessage& message);

/// sensor_msgs/JointState: positions by name.
struct RosJoints {
  TimeNs stamp_ns = 0;
  JointState positions;
};
RosJoints read_ros_joints(const RosMessage& message);

/// Acceleration of sensor_msgs/Imu, m/s², in the frame of its header: at rest it points up.
struct RosAcceleration {
  RosHeader header;
  Vector3d acceleration = Vector3d::Zero();
};
RosAcceleration read_ros_acceleration(const RosMessage& message);

/// std_msgs/Float32.
float read_ros_float(const RosMessage& message);

}  // namespace loci::mapping
