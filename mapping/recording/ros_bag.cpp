#include "mapping/recording/ros_bag.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

constexpr const char* kMagic = "#ROSBAG V";

TimeNs to_ns(const ros::Time& time) {
  return static_cast<TimeNs>(time.sec) * kSecond + static_cast<TimeNs>(time.nsec);
}

/// The library's exceptions as one of ours.
template <typename Work>
auto guarded(const std::filesystem::path& path, const Work& work) {
  const loci::Place place{path.string(), 0, {}};
  const char* reindex = "'rosbag reindex' repairs bags whose recording was interrupted";
  try {
    return work();
  } catch (const rosbag::BagUnindexedException&) {
    throw Error("the bag has no index: it is truncated, or its recording was not finished", place, reindex);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    std::string text = error.what();
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw Error(fmt::format("the bag is truncated or damaged: {}", text), place, reindex);
  }
}

}  // namespace

struct RosBag::Content {
  std::filesystem::path path;
  rosbag::Bag bag;
  std::vector<BagTopic> topics;
  std::map<std::string, std::vector<rosbag::MessageInstance>> messages;
};

bool is_ros_bag(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(9, '\0');
  return file.read(head.data(), 9) && head == kMagic;
}

RosBag::RosBag(const std::filesystem::path& path) : content_(std::make_unique<Content>()) {
  content_->path = path;
  if (!is_ros_bag(path))
    throw Error("this file is no ROS 1 bag", {path.string(), 0, {}}, "a bag begins with '#ROSBAG V2.0'");
  console_bridge::noOutputHandler();
  guarded(path, [this] {
    content_->bag.open(content_->path.string(), rosbag::bagmode::Read);
    rosbag::View view(content_->bag);
    std::map<std::string, BagTopic> topics;
    for (const rosbag::ConnectionInfo* connection : view.getConnections())
      topics[connection->topic] = {connection->topic, connection->datatype, connection->msg_def, 0};
    for (const rosbag::MessageInstance& message : view)
      content_->messages[message.getTopic()].push_back(message);
    for (auto& [name, topic] : topics) {
      topic.messages = content_->messages[name].size();
      content_->topics.push_back(std::move(topic));
    }
  });
}

RosBag::~RosBag() = default;

const std::filesystem::path& RosBag::path() const {
  return content_->path;
}

const std::vector<BagTopic>& RosBag::topics() const {
  return content_->topics;
}

const BagTopic* RosBag::find(const std::string& topic) const {
  for (const BagTopic& each : content_->topics)
    if (each.name == topic) return &each;
  return nullptr;
}

std::vector<TimeNs> RosBag::times(const std::string& topic) const {
  std::vector<TimeNs> times;
  const auto found = content_->messages.find(topic);
  if (found == content_->messages.end()) return times;
  for (const rosbag::MessageInstance& message : found->second) times.push_back(to_ns(message.getTime()));
  return times;
}

std::string RosBag::message(const std::string& topic, size_t i) const {
  return guarded(content_->path, [&] {
    const rosbag::MessageInstance& message = content_->messages.at(topic).at(i);
    std::string bytes(message.size(), '\0');
    ros::serialization::OStream stream(reinterpret_cast<uint8_t*>(bytes.data()),
                                       static_cast<uint32_t>(bytes.size()));
    message.write(stream);
    return bytes;
  });
}

}  // namespace loci::mapping
