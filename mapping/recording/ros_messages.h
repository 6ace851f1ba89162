#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/time.h"
#include "mapping/sensor/camera.h"

namespace loci::mapping {

// The messages that make an RGB-D recording, from the bytes that ROS 1 serialised. All throw Error when bytes
// are missing; `where` names the message.

/// std_msgs/Header, with which the others begin. The frame comes without a leading slash.
struct RosHeader {
  TimeNs stamp_ns = 0;
  std::string frame;
};
RosHeader read_ros_header(std::string_view message, const std::string& where);

/// What a sensor_msgs/Image or CompressedImage says before its pixels: "16UC1", "rgb8; jpeg compressed bgr8".
std::string read_ros_encoding(std::string_view message, bool compressed, const std::string& where);

/// Whether images of this encoding or format are depth.
bool is_depth_encoding(const std::string& encoding);

/// Depth in metres (CV_32F, NaN = none) of 16UC1, mono16 (mm; 0 and 65535 are none), 32FC1 (m), or of
/// compressedDepth PNGs.
cv::Mat read_ros_depth(std::string_view message, bool compressed, const std::string& where);
/// Colour (CV_8UC3, BGR) of rgb8, bgr8, rgba8, bgra8, mono8, or of compressed PNG and JPEG.
cv::Mat read_ros_color(std::string_view message, bool compressed, const std::string& where);

/// sensor_msgs/CameraInfo: size and the rectified projection P where it is set, else K.
PinholeCamera read_ros_camera(std::string_view message, const std::string& where);

/// One geometry_msgs/TransformStamped of a tf message.
struct RosTransform {
  TimeNs stamp_ns = 0;
  std::string parent, child;
  Isometry3d parent_from_child = Isometry3d::Identity();
};
std::vector<RosTransform> read_ros_transforms(std::string_view message, const std::string& where);

}  // namespace loci::mapping
