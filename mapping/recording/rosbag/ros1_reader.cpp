#include "mapping/recording/ros/bag.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <map>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

TimeNs to_ns(const ros::Time& time) {
  return static_cast<TimeNs>(time.sec) * kSecond + static_cast<TimeNs>(time.nsec);
}

/// The library's exceptions as one of ours.
template <typename Work>
auto guarded(const std::filesystem::path& path, const Work& work) {
  const FileLocation location{path.string(), 0, {}};
  const char* reindex = "'rosbag reindex' repairs bags whose recording was interrupted";
  try {
    return work();
  } catch (const rosbag::BagUnindexedException&) {
    throw Error("the bag has no index: it is truncated, or its recording was not finished", location,
                reindex);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    std::string text = error.what();
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw Error(fmt::format("the bag is truncated or damaged: {}", text), location, reindex);
  }
}

class RosbagReader : public BagReader {
 public:
  explicit RosbagReader(std::filesystem::path path) : path_(std::move(path)) {
    console_bridge::noOutputHandler();
    guarded(path_, [this] {
      bag_.open(path_.string(), rosbag::bagmode::Read);
      rosbag::View view(bag_);
      std::map<std::string, BagTopic> topics;
      for (const rosbag::ConnectionInfo* connection : view.getConnections())
        topics[connection->topic] = {connection->topic, connection->datatype, connection->msg_def, 0};
      for (const rosbag::MessageInstance& message : view) messages_[message.getTopic()].push_back(message);
      for (auto& [name, topic] : topics) {
        topic.messages = messages_[name].size();
        topics_.push_back(std::move(topic));
      }
    });
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<TimeNs> times(const std::string& topic) const override {
    std::vector<TimeNs> times;
    const auto found = messages_.find(topic);
    if (found == messages_.end()) return times;
    for (const rosbag::MessageInstance& message : found->second) times.push_back(to_ns(message.getTime()));
    return times;
  }

  std::string message(const std::string& topic, size_t i) const override {
    return guarded(path_, [&] {
      const rosbag::MessageInstance& message = messages_.at(topic).at(i);
      std::string bytes(message.size(), '\0');
      ros::serialization::OStream stream(reinterpret_cast<uint8_t*>(bytes.data()),
                                         static_cast<uint32_t>(bytes.size()));
      message.write(stream);
      return bytes;
    });
  }

 private:
  std::filesystem::path path_;
  rosbag::Bag bag_;
  std::vector<BagTopic> topics_;
  std::map<std::string, std::vector<rosbag::MessageInstance>> messages_;
};

}  // namespace
}  // namespace loci::mapping

extern "C" loci::mapping::BagReader* loci_open_bag(const std::filesystem::path& path) {
  return new loci::mapping::RosbagReader(path);
}
