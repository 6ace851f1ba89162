#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/time.h"

namespace loci::mapping {

/// What was published under one name.
struct BagTopic {
  std::string name;        ///< "/camera/depth/image_raw"
  std::string type;        ///< "sensor_msgs/Image"
  std::string definition;  ///< as `rosmsg show --raw`: the text with those of all types that it uses
  size_t messages = 0;
};

/// A ROS 1 bag (format 2.0, chunks plain, bz2 or lz4), read only. One thread at a time.
class RosBag {
 public:
  /// Error when it is missing, no bag, truncated or was not closed.
  explicit RosBag(const std::filesystem::path& path);
  ~RosBag();
  RosBag(const RosBag&) = delete;
  RosBag& operator=(const RosBag&) = delete;

  const std::filesystem::path& path() const;
  const std::vector<BagTopic>& topics() const;  ///< sorted by name
  /// Topic of a name; nullptr when there is none.
  const BagTopic* find(const std::string& topic) const;
  /// When the messages of a topic were recorded, ascending. Empty for a topic that is not there.
  std::vector<TimeNs> times(const std::string& topic) const;
  /// Message number `i` of a topic as it was serialised. Error when the file is damaged there.
  std::string message(const std::string& topic, size_t i) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// Whether a file begins as a bag does.
bool is_ros_bag(const std::filesystem::path& path);

}  // namespace loci::mapping
