#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/time.h"
#include "mapping/recording/markers.h"
#include "mapping/sensor/frame.h"

namespace loci::mapping {

// Messages of ROS 2 in CDR, and the texts that define their types for MCAP.

/// Serialises the fields of a message as CDR (little endian).
class CdrWriter {
 public:
  template <typename T>
  CdrWriter& add(T value) {
    while ((bytes_.size() - kHead) % sizeof(T) != 0) bytes_ += '\0';
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  CdrWriter& text(std::string_view value) {
    add(static_cast<uint32_t>(value.size() + 1));
    bytes_ += value;
    bytes_ += '\0';
    return *this;
  }
  CdrWriter& data(std::string_view value) {
    add(static_cast<uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  /// std_msgs/Header.
  CdrWriter& header(TimeNs stamp, std::string_view frame);
  const std::string& bytes() const { return bytes_; }

 private:
  static constexpr size_t kHead = 4;
  std::string bytes_ = std::string("\0\1\0\0", kHead);
};

/// A type's name, as in "sensor_msgs/msg/Image", and its fields with those of all types that it uses.
struct MessageType {
  std::string name;
  std::string definition;
};
MessageType image_type();
MessageType compressed_image_type();
MessageType camera_info_type();
MessageType transforms_type();
MessageType joint_state_type();
MessageType marker_array_type();

/// `encoding` names the type of the pixels: "16UC1", "32FC1".
std::string image_message(const cv::Mat& image, const char* encoding, TimeNs time, const std::string& frame);
/// Colour (CV_8UC3, BGR) as PNG.
std::string compressed_image_message(const cv::Mat& image, TimeNs time, const std::string& frame);
std::string camera_info_message(const PinholeCamera& camera, TimeNs time, const std::string& frame);
/// One transform: the pose of `child` in `parent`.
std::string transform_message(const Isometry3d& pose, TimeNs time, const std::string& parent,
                              const std::string& child);
std::string joint_state_message(const JointState& joints, TimeNs time);
/// In place of all markers of the topic so far.
std::string marker_array_message(const std::vector<Marker>& markers, TimeNs time, const std::string& frame);

}  // namespace loci::mapping
