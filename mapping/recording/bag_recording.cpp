#include "mapping/recording/bag_recording.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/recording/ros_messages.h"
#include "mapping/recording/stamped_poses.h"
#include "mapping/sensor/kinect.h"

namespace loci::mapping {
namespace {

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";

std::string parent_of(const std::string& topic) {
  return topic.substr(0, topic.rfind('/'));
}

/// "/camera/depth/image_raw (sensor_msgs/Image), …" for messages.
std::string listing(const std::vector<BagTopic>& topics) {
  std::string text;
  for (const BagTopic& topic : topics)
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", topic.name, topic.type);
  return text.empty() ? "nothing" : text;
}

TransformTree transforms_of(const RosBag& bag) {
  TransformTree tree;
  for (const BagTopic& topic : bag.topics()) {
    if (topic.type != "tf2_msgs/TFMessage" && topic.type != "tf/tfMessage") continue;
    const bool is_static = topic.name.ends_with("tf_static");
    for (size_t i = 0; i < topic.messages; ++i) {
      const std::string where = fmt::format("{}: {}[{}]", bag.path().string(), topic.name, i);
      for (const RosTransform& each : read_ros_transforms(bag.message(topic.name, i), where))
        tree.add(each.parent, each.child, {each.stamp_ns, each.parent_from_child}, is_static);
    }
  }
  tree.finish();
  return tree;
}

}  // namespace

BagRecording::BagRecording(const std::filesystem::path& path) : bag_(path) {
  info_.format = "rosbag";
  info_.path = path.string();
  choose_streams();
  set_cameras();
  add_frames();
  complete_info(info_, frames_);
}

std::string BagRecording::where(const std::string& topic, size_t message) const {
  return fmt::format("{}: {}[{}]", info_.path, topic, message);
}

BagRecording::Stream BagRecording::stream_of(const BagTopic& topic) const {
  Stream stream{topic.name, topic.type == kCompressed, {}, {}};
  const std::vector<TimeNs> recorded = bag_.times(topic.name);
  for (size_t i = 0; i < topic.messages; ++i) {
    const RosHeader header = read_ros_header(bag_.message(topic.name, i), where(topic.name, i));
    if (i == 0) stream.frame = header.frame;
    stream.when.emplace_back(header.stamp_ns != 0 ? header.stamp_ns : recorded[i], i);
  }
  std::stable_sort(stream.when.begin(), stream.when.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return stream;
}

void BagRecording::choose_streams() {
  const BagTopic* depth = nullptr;
  const BagTopic* color = nullptr;
  size_t depths = 0;
  for (const BagTopic& topic : bag_.topics()) {
    const bool compressed = topic.type == kCompressed;
    if ((topic.type != kImage && !compressed) || topic.messages == 0) continue;
    const std::string encoding =
        read_ros_encoding(bag_.message(topic.name, 0), compressed, where(topic.name, 0));
    const bool is_depth = is_depth_encoding(encoding);
    depths += is_depth ? 1 : 0;
    const BagTopic*& best = is_depth ? depth : color;
    if (best == nullptr || topic.messages > best->messages) best = &topic;
  }
  if (depth == nullptr)
    throw Error("the bag has no depth images", {info_.path, 0, {}},
                fmt::format("a {} or {} of 16UC1, 32FC1 or compressedDepth is needed; there is {}", kImage,
                            kCompressed, listing(bag_.topics())));
  depth_ = stream_of(*depth);
  if (color != nullptr) color_ = stream_of(*color);
  info_.guesses.push_back(fmt::format("depth from {}, colour from {}", depth_.topic,
                                      color != nullptr ? color_.topic : "nowhere"));
  if (depths > 1) info_.problems.push_back(fmt::format("{} other depth topics are not read", depths - 1));
}

std::optional<PinholeCamera> BagRecording::camera_of(const Stream& stream) const {
  // camera_info stands beside the image, or one level above where transports have names of their own.
  for (std::string space = parent_of(stream.topic); !space.empty(); space = parent_of(space)) {
    const BagTopic* topic = bag_.find(space + "/camera_info");
    if (topic != nullptr && topic->messages > 0 && topic->type == "sensor_msgs/CameraInfo")
      return read_ros_camera(bag_.message(topic->name, 0), where(topic->name, 0));
  }
  return std::nullopt;
}

void BagRecording::set_cameras() {
  const std::optional<PinholeCamera> depth = camera_of(depth_);
  if (!depth) info_.guesses.emplace_back("no camera_info of depth: a Kinect v1 is assumed");
  info_.camera.depth = depth.value_or(kinect_camera().depth);
  const cv::Mat image =
      read_ros_depth(bag_.message(depth_.topic, 0), depth_.compressed, where(depth_.topic, 0));
  if (image.cols != info_.camera.depth.width || image.rows != info_.camera.depth.height)
    throw Error(fmt::format("depth images are {} x {}, their camera {} x {}", image.cols, image.rows,
                            info_.camera.depth.width, info_.camera.depth.height),
                {where(depth_.topic, 0), 0, {}});
  info_.camera.color = info_.camera.depth;
  if (color_.when.empty()) return;
  const std::optional<PinholeCamera> color = camera_of(color_);
  if (!color) info_.guesses.emplace_back("no camera_info of colour: taken as that of depth");
  info_.camera.color = color.value_or(info_.camera.depth);
}

void BagRecording::add_frames() {
  const TransformTree tree = transforms_of(bag_);
  info_.map_frame = tree.root_of(depth_.frame);
  const bool posed = info_.map_frame != depth_.frame;
  std::vector<TimeNs> depth_times, color_times;
  for (const auto& [time, message] : depth_.when) depth_times.push_back(time);
  for (const auto& [time, message] : color_.when) color_times.push_back(time);
  const auto matches = nearest_in_time(depth_times, color_times);
  color_of_.resize(depth_.when.size());
  for (size_t i = 0; i < depth_.when.size(); ++i) {
    const auto& [time, message] = depth_.when[i];
    FrameFiles frame;
    frame.index = static_cast<int64_t>(message);
    frame.time_ns = time;
    frame.location = {where(depth_.topic, message), 0, {}};
    if (matches[i]) {
      color_of_[message] = color_.when[*matches[i]].second;
      frame.color = color_.topic;
    }
    if (posed) frame.map_from_camera = tree.root_from(depth_.frame, time);
    frames_.push_back(std::move(frame));
  }
  if (color_.when.empty() || color_.frame == depth_.frame) return;
  if (const auto transform = tree.between(depth_.frame, color_.frame, depth_times.front()))
    info_.camera.depth_from_color = *transform;
  else
    info_.guesses.push_back(fmt::format(
        "no transform from {} to {}: colour is taken as registered with depth", color_.frame, depth_.frame));
}

RgbdFrame BagRecording::frame(size_t i) const {
  const FrameFiles& from = frames_.at(i);
  const auto message = static_cast<size_t>(from.index);
  const std::lock_guard lock(bag_lock_);
  RgbdFrame frame;
  frame.index = from.index;
  frame.name = fmt::format("frame-{:06}", from.index);
  frame.time_ns = from.time_ns;
  frame.camera = info_.camera;
  frame.map_from_camera = from.map_from_camera;
  const auto check = [](const cv::Mat& image, const PinholeCamera& camera, const std::string& location) {
    if (image.cols != camera.width || image.rows != camera.height)
      throw Error(fmt::format("the image is {} x {}, its camera {} x {}", image.cols, image.rows,
                              camera.width, camera.height),
                  {location, 0, {}});
  };
  const std::string depth_place = where(depth_.topic, message);
  frame.depth = read_ros_depth(bag_.message(depth_.topic, message), depth_.compressed, depth_place);
  check(frame.depth, info_.camera.depth, depth_place);
  if (const std::optional<size_t> color = color_of_.at(message)) {
    const std::string color_place = where(color_.topic, *color);
    frame.color = read_ros_color(bag_.message(color_.topic, *color), color_.compressed, color_place);
    check(frame.color, info_.camera.color, color_place);
  }
  return frame;
}

}  // namespace loci::mapping
