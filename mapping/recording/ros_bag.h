#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/time.h"

namespace loci::mapping {

/// A topic of a bag.
struct BagTopic {
  std::string name;        ///< "/camera/depth/image_raw"
  std::string type;        ///< "sensor_msgs/Image"
  std::string definition;  ///< as `rosmsg show --raw`: the text with those of all types that it uses
  size_t messages = 0;
};

/// What the module of mapping/recording/rosbag implements.
class BagReader {
 public:
  virtual ~BagReader() = default;
  virtual const std::vector<BagTopic>& topics() const = 0;
  virtual std::vector<TimeNs> times(const std::string& topic) const = 0;
  virtual std::string message(const std::string& topic, size_t i) const = 0;
};

/// A ROS 1 bag (format 2.0, chunks plain, bz2 or lz4), read only. One thread at a time. librosbag-storage is
/// loaded with the first bag: it brings two dozen libraries that most commands do not need.
class RosBag {
 public:
  /// Error when the file is missing, not a bag, truncated or was not closed.
  explicit RosBag(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  const std::vector<BagTopic>& topics() const { return reader_->topics(); }  ///< sorted by name
  /// Topic of a name; nullptr when there is none.
  const BagTopic* find(const std::string& topic) const;
  /// When the messages of a topic were recorded, ascending. Empty for an unknown topic.
  std::vector<TimeNs> times(const std::string& topic) const { return reader_->times(topic); }
  /// Message number `i` of a topic as it was serialised. Error when the file is damaged there.
  std::string message(const std::string& topic, size_t i) const { return reader_->message(topic, i); }

 private:
  std::filesystem::path path_;
  std::unique_ptr<BagReader> reader_;
};

/// Whether a file begins as a bag does.
bool is_ros_bag(const std::filesystem::path& path);

}  // namespace loci::mapping
