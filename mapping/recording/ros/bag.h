#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/time.h"

namespace loci::mapping {

/// How the bytes of messages are laid out.
enum class Serialization { ros1, cdr, other };

/// A topic of a bag.
struct BagTopic {
  std::string name;        ///< "/camera/depth/image_raw"
  std::string type;        ///< "sensor_msgs/Image", in ROS 2 too
  std::string definition;  ///< as `rosmsg show --raw`: the text with those of all types that it uses
  size_t messages = 0;
  Serialization serialization = Serialization::ros1;
};

/// The topics with their messages in order of the time of recording, and counted.
template <typename Messages>
std::vector<BagTopic> with_sorted_messages(const std::map<std::string, BagTopic>& topics,
                                           Messages& messages) {
  std::vector<BagTopic> sorted;
  for (const auto& [name, topic] : topics) {
    auto& of_topic = messages[name];
    std::ranges::stable_sort(of_topic, {}, [](const auto& message) { return message.time; });
    sorted.push_back(topic);
    sorted.back().messages = of_topic.size();
  }
  return sorted;
}

/// When the messages of a topic were recorded; empty for an unknown topic.
template <typename Messages>
std::vector<TimeNs> times_in(const Messages& messages, const std::string& topic) {
  std::vector<TimeNs> times;
  if (const auto found = messages.find(topic); found != messages.end())
    for (const auto& message : found->second) times.push_back(message.time);
  return times;
}

/// BagReader::visit for messages that stand `at` a place in a `chunk`: each chunk is unpacked once.
template <typename Message, typename Wanted, typename Visitor, typename BytesOf>
void visit_as_stored(const std::vector<BagTopic>& topics,
                     const std::map<std::string, std::vector<Message>>& messages, const Wanted& wanted,
                     const Visitor& visitor, const BytesOf& bytes_of) {
  struct Visit {
    const BagTopic* topic;
    size_t number;
    const Message* message;
  };
  std::vector<Visit> visits;
  for (const BagTopic& topic : topics) {
    if (!wanted(topic)) continue;
    const std::vector<Message>& of_topic = messages.at(topic.name);
    for (size_t i = 0; i < of_topic.size(); ++i) visits.push_back({&topic, i, &of_topic[i]});
  }
  std::ranges::sort(visits, {},
                    [](const Visit& each) { return std::pair(each.message->chunk, each.message->at); });
  for (const Visit& each : visits)
    visitor(*each.topic, each.number, each.message->time, bytes_of(*each.message));
}

/// A bag of one storage format. Messages of a topic are numbered in order of the time of recording.
class BagReader {
 public:
  /// Topic, number of the message, and its bytes, which are valid during the call.
  using Visitor =
      std::function<void(const BagTopic& topic, size_t i, TimeNs recorded, std::string_view bytes)>;

  virtual ~BagReader() = default;
  /// Sorted by name.
  virtual const std::vector<BagTopic>& topics() const = 0;
  virtual std::vector<TimeNs> times(const std::string& topic) const = 0;
  virtual std::string message(const std::string& topic, size_t i) const = 0;
  /// All messages of the topics that `wanted` accepts, in the order that is fastest to read.
  virtual void visit(const std::function<bool(const BagTopic&)>& wanted, const Visitor& visitor) const {
    for (const BagTopic& topic : topics()) {
      if (!wanted(topic)) continue;
      const std::vector<TimeNs> recorded = times(topic.name);
      for (size_t i = 0; i < recorded.size(); ++i) visitor(topic, i, recorded[i], message(topic.name, i));
    }
  }
  /// What could not be read, a line each.
  virtual std::vector<std::string> problems() const { return {}; }
};

/// A bag of ROS 1 (format 2.0, chunks plain, bz2 or lz4) or ROS 2 (MCAP, SQLite, a folder of these), read
/// only; files that are compressed as a whole are unpacked into the temporary folder. One thread at a time.
/// Damaged MCAP and SQLite files give what is whole.
class RosBag {
 public:
  /// Error when the path is missing or holds no bag; for ROS 1 also when it is truncated or was not closed.
  explicit RosBag(const std::filesystem::path& path, Progress* progress = nullptr);

  const std::filesystem::path& path() const { return path_; }
  const std::vector<BagTopic>& topics() const { return reader_->topics(); }  ///< sorted by name
  /// Topic of a name; nullptr when there is none.
  const BagTopic* find(const std::string& topic) const;
  /// When the messages of a topic were recorded, ascending. Empty for an unknown topic.
  std::vector<TimeNs> times(const std::string& topic) const { return reader_->times(topic); }
  /// Message number `i` of a topic as it was serialised. Error when the file is damaged there.
  std::string message(const std::string& topic, size_t i) const { return reader_->message(topic, i); }
  void visit(const std::function<bool(const BagTopic&)>& wanted, const BagReader::Visitor& visitor) const {
    reader_->visit(wanted, visitor);
  }
  std::vector<std::string> problems() const;

 private:
  std::filesystem::path path_;
  std::vector<std::string> problems_;
  std::unique_ptr<BagReader> reader_;
};

/// Whether a file begins as a bag of ROS 1 does, or is named NAME.bag.gz or the like.
bool is_ros1_bag(const std::filesystem::path& path);
/// Whether a path is an MCAP file, a database of rosbag2, one of them compressed as a whole, or a folder with
/// such files.
bool is_ros2_bag(const std::filesystem::path& path);

/// Readers of single storage formats; Error when the file cannot be read at all. Messages have `name` for the
/// file, which may be removed once it is opened.
std::unique_ptr<BagReader> open_ros1_bag(const std::filesystem::path& path,
                                         const std::filesystem::path& name);
std::unique_ptr<BagReader> open_mcap(const std::filesystem::path& path, const std::filesystem::path& name);
std::unique_ptr<BagReader> open_sqlite_bag(const std::filesystem::path& path,
                                           const std::filesystem::path& name);

}  // namespace loci::mapping
