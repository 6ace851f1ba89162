#include "mapping/recording/ros/ros_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "mapping/base/text/text.h"
#include "mapping/base/time_limits.h"
#include "mapping/recording/formats/layouts.h"
#include "mapping/sensor/kinect.h"

namespace loci::mapping {
namespace {

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";
constexpr const char* kCameraInfo = "sensor_msgs/CameraInfo";
constexpr const char* kJointState = "sensor_msgs/JointState";
constexpr const char* kImu = "sensor_msgs/Imu";
constexpr const char* kTransform = "geometry_msgs/Transform";
constexpr const char* kFloat = "std_msgs/Float32";

bool is_tf(const BagTopic& topic) {
  return topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
}

bool is_used(const BagTopic& topic) {
  for (const char* type : {kImage, kCompressed, kCameraInfo, kJointState, kImu, kTransform, kFloat})
    if (topic.type == type) return true;
  return is_tf(topic);
}

/// Images of transports that are not read.
bool is_video(const BagTopic& topic) {
  for (const char* type : {"FFMPEGPacket", "CompressedVideo", "theora_image_transport", "H264Packet"})
    if (topic.type.find(type) != std::string::npos) return true;
  return false;
}

std::string parent_of(const std::string& topic) {
  const size_t slash = topic.rfind('/');
  return slash == std::string::npos ? std::string() : topic.substr(0, slash);
}

/// How many levels of their names two topics share from the start.
size_t shared_levels(const std::string& a, const std::string& b) {
  const std::vector<std::string> levels_a = split(a, '/'), levels_b = split(b, '/');
  size_t count = 0;
  while (count < std::min(levels_a.size(), levels_b.size()) && levels_a[count] == levels_b[count]) ++count;
  return count;
}

/// The camera that a topic of depth images is of: what stands before its first level about depth or images,
/// "head/kinect" of "/head/kinect/depth/image_raw" and of "/head/kinect/aligned_depth_to_color/image_raw".
std::string camera_name(const std::string& topic) {
  std::string name;
  for (const std::string& level : split(topic, '/')) {
    if (level.empty()) continue;
    const std::string lower = lower_case(level);
    if (!name.empty() &&
        (lower.find("depth") != std::string::npos || lower.find("image") != std::string::npos))
      break;
    name += (name.empty() ? "" : "/") + level;
  }
  return name;
}

/// "/camera/depth/image_raw (sensor_msgs/Image), …" for messages.
std::string listing(const std::vector<BagTopic>& topics) {
  constexpr size_t kMax = 12;
  std::string text;
  for (size_t i = 0; i < std::min(kMax, topics.size()); ++i)
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", topics[i].name, topics[i].type);
  if (topics.size() > kMax) text += fmt::format(" and {} more", topics.size() - kMax);
  return text.empty() ? "nothing" : text;
}

bool names_a_world(const std::string& frame) {
  return frame == "map" || frame == "world" || frame == "odom";
}

void check_image_size(const cv::Mat& image, const PinholeCamera& camera, const std::string& where) {
  if (image.cols == camera.width && image.rows == camera.height) return;
  throw Error(fmt::format("the image is {} x {}, its camera {} x {}", image.cols, image.rows, camera.width,
                          camera.height),
              {where, 0, {}});
}

}  // namespace

/// Infrared and confidence images have 16 bits as depth has; their names say what they are.
bool RosRecording::Stream::is_depth() const {
  if (!is_depth_encoding(encoding)) return false;
  const std::vector<std::string> words = words_of(lower_case(topic), "/_-");
  const auto has = [&](std::string_view word) { return std::ranges::find(words, word) != words.end(); };
  constexpr std::array<std::string_view, 11> kOthers = {"ir",        "infra",      "infra1",   "infra2",
                                                        "rgb",       "infrared",   "color",    "colour",
                                                        "amplitude", "confidence", "intensity"};
  return has("depth") || std::ranges::none_of(kOthers, has);
}

bool RosRecording::Stream::has_colors() const {
  return !encoding.starts_with("mono") && !encoding.starts_with("8UC1");
}

RosRecording::RosRecording(const std::filesystem::path& path, const RecordingOptions& options,
                           Progress* progress)
    : bag_(path, progress) {
  info_.format = is_ros1_bag(path) ? "rosbag" : "rosbag2";
  info_.path = path.string();
  const Content content = read_content();
  choose_streams(content, options);
  set_cameras(content);
  add_frames(content, options.color_delay_s);
  set_joints(content.joints);
  complete_info(info_, frames_);
  set_up(content);
}

std::string RosRecording::where(const std::string& topic, size_t message) const {
  return fmt::format("{}: {}[{}]", info_.path, topic, message);
}

RosMessage RosRecording::message_of(const Stream& stream, size_t message, std::string& bytes) const {
  bytes = bag_.message(stream.topic, message);
  return {bytes, stream.serialization, where(stream.topic, message)};
}

void RosRecording::take(const BagTopic& topic, size_t i, TimeNs recorded, const RosMessage& message,
                        Content& content) const {
  if (topic.type == kImage || topic.type == kCompressed) {
    const bool compressed = topic.type == kCompressed;
    const RosHeader header = read_ros_header(message);
    const TimeNs time = header.stamp_ns != 0 ? header.stamp_ns : recorded;
    if (!is_within_limits(time)) throw Error("the time stamp is too far off", {message.where, 0, {}});
    const std::string encoding =
        read_ros_encoding(message, compressed);  // Finds messages that are cut off, too.
    Stream& stream = content.images[topic.name];
    if (stream.when.empty()) {
      stream.topic = topic.name;
      stream.serialization = topic.serialization;
      stream.compressed = compressed;
      stream.encoding = encoding;
      stream.frame = header.frame;
    }
    stream.when.emplace_back(time, i);
  } else if (topic.type == kCameraInfo) {
    if (!content.cameras.contains(topic.name)) content.cameras[topic.name] = read_ros_camera(message);
  } else if (is_tf(topic)) {
    for (const RosTransform& each : read_ros_transforms(message))
      content.transforms.add(each.parent, each.child, {each.stamp_ns, each.parent_from_child},
                             topic.name.ends_with("tf_static"));
  } else if (topic.type == kJointState) {
    content.joints.push_back(read_ros_joints(message));
  } else if (topic.type == kImu) {
    content.accelerations.push_back(read_ros_acceleration(message));
  } else if (topic.type == kTransform) {
    content.extrinsics[topic.name] = read_ros_transform(message);
  } else if (topic.name.ends_with("Depth Units/value") || topic.name.ends_with("Depth_Units/value")) {
    const double unit = static_cast<double>(read_ros_float(message));
    if (unit > 1e-6 && unit < 0.1) content.depth_unit_m = unit;
  }
}

RosRecording::Content RosRecording::read_content() {
  Content content;
  size_t broken = 0;
  std::string first_broken;
  bag_.visit(is_used, [&](const BagTopic& topic, size_t i, TimeNs recorded, std::string_view bytes) {
    try {
      take(topic, i, recorded, {bytes, topic.serialization, where(topic.name, i)}, content);
    } catch (const Error& error) {
      if (broken++ == 0) first_broken = error.what();
    }
  });
  content.transforms.finish();
  info_.problems = bag_.problems();
  if (broken > 0)
    info_.problems.push_back(fmt::format("left out: {} ({})", counted(broken, "message"), first_broken));
  for (auto& [name, stream] : content.images)
    std::stable_sort(stream.when.begin(), stream.when.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  return content;
}

const RosRecording::Stream* RosRecording::color_for(const Stream& depth, const Content& content) const {
  // Colour that has more of its name in common with another camera's depth is that camera's.
  const auto is_of_another = [&](const Stream& color) {
    return std::ranges::any_of(content.images, [&](const auto& image) {
      const Stream& other = image.second;
      return other.is_depth() && camera_name(other.topic) != camera_name(depth.topic) &&
             shared_levels(color.topic, other.topic) > shared_levels(color.topic, depth.topic);
    });
  };
  const auto rank = [&](const Stream& stream) {
    return std::tuple(stream.has_colors(), shared_levels(stream.topic, depth.topic), stream.when.size());
  };
  const Stream* best = nullptr;
  for (const auto& [name, stream] : content.images)
    if (!stream.is_depth() && !is_of_another(stream) && (best == nullptr || rank(stream) > rank(*best)))
      best = &stream;
  return best;
}

const RosRecording::Stream& RosRecording::chosen(const std::string& topic, const Content& content,
                                                 bool depth) const {
  std::vector<std::string> names;
  for (const auto& [name, stream] : content.images) {
    if (stream.is_depth() != depth) continue;
    if (name == topic) return stream;
    names.push_back(name);
  }
  throw Error(fmt::format("the bag has no {} topic {}", depth ? "depth" : "colour", topic),
              {info_.path, 0, "--topics"},
              names.empty() ? "" : fmt::format("it has {}", joined(names, ", ")));
}

std::vector<const RosRecording::Stream*> RosRecording::depths_of_camera(const Content& content,
                                                                        const RecordingOptions& options) {
  std::map<std::string, std::vector<const Stream*>> cameras;
  for (const auto& [name, stream] : content.images)
    if (stream.is_depth()) cameras[camera_name(name)].push_back(&stream);
  if (cameras.empty())
    throw Error("the bag has no depth images", {info_.path, 0, {}},
                fmt::format("a {} or {} of 16UC1, 32FC1 or compressedDepth is needed; there is {}", kImage,
                            kCompressed, listing(bag_.topics())));
  const auto most_images = [](const auto& camera) {
    size_t most = 0;
    for (const Stream* depth : camera.second) most = std::max(most, depth->when.size());
    return most;
  };
  auto read = std::ranges::max_element(cameras, {}, most_images);
  if (!options.topics.empty())
    read = cameras.find(camera_name(chosen(split(options.topics, ',')[0], content, true).topic));
  std::vector<std::string> names;
  for (const auto& [name, depths] : cameras) names.push_back(name);
  if (!options.camera.empty()) {
    if (!options.topics.empty())
      throw Error("a camera and topics say the same", {info_.path, 0, "--camera"}, "give one of them");
    read = cameras.find(options.camera);
    if (read == cameras.end())
      throw Error(fmt::format("the bag has no camera {}", options.camera), {info_.path, 0, "--camera"},
                  fmt::format("it has {}", joined(names, ", ")));
  }
  std::erase(names, read->first);
  if (!names.empty())
    info_.guesses.push_back(fmt::format("read is the camera {}, not {} (choose with --camera NAME)",
                                        read->first, joined(names, ", ")));
  info_.camera_names = std::move(names);
  info_.camera_names.insert(info_.camera_names.begin(), read->first);
  return read->second;
}

void RosRecording::choose_streams(const Content& content, const RecordingOptions& options) {
  const std::vector<const Stream*> depths = depths_of_camera(content, options);
  // Depth that was warped to the colour camera is second to the depth that it was made of, even where a few
  // messages of that were lost.
  size_t most = 0;
  for (const Stream* depth : depths) most = std::max(most, depth->when.size());
  const auto rank = [&](const Stream* depth) {
    const Stream* color = color_for(*depth, content);
    return std::tuple(4 * depth->when.size() >= 3 * most, color == nullptr || color->frame != depth->frame,
                      !depth->compressed, depth->when.size());
  };
  const std::vector<std::string> wanted =
      options.topics.empty() ? std::vector<std::string>() : split(options.topics, ',');
  depth_ = wanted.empty() ? **std::ranges::max_element(depths, {}, rank) : chosen(wanted[0], content, true);
  const Stream* color = wanted.size() > 1 ? &chosen(wanted[1], content, false) : color_for(depth_, content);
  if (color != nullptr) color_ = *color;
  info_.guesses.push_back(fmt::format("depth from {}, colour from {}", depth_.topic,
                                      color != nullptr ? color_.topic : "nowhere"));
  if (color == nullptr)
    for (const BagTopic& topic : bag_.topics())
      if (is_video(topic))
        info_.problems.push_back(fmt::format(
            "{} is not read: it is {}; record image_raw or compressed (JPEG)", topic.name, topic.type));
  std::vector<std::string> others;
  for (const Stream* depth : depths)
    if (depth->topic != depth_.topic) others.push_back(depth->topic);
  if (!others.empty())
    info_.guesses.push_back(
        fmt::format("not read: depth from {} (choose with --topics DEPTH,COLOUR)", joined(others, ", ")));
}

std::optional<RosCamera> RosRecording::camera_of(const Stream& stream, const Content& content) const {
  // camera_info stands beside the image, or one level above where transports have names of their own;
  // librealsense puts it beside "image".
  for (std::string space = parent_of(stream.topic); !space.empty(); space = parent_of(space))
    for (const char* name : {"/camera_info", "/info/camera_info"})
      if (const auto found = content.cameras.find(space + name); found != content.cameras.end())
        return found->second;
  // Under another name, but of the same optical frame.
  for (const auto& [name, camera] : content.cameras)
    if (!stream.frame.empty() && camera.frame == stream.frame) return camera;
  return std::nullopt;
}

PinholeCamera RosRecording::pinhole_of(const Stream& stream, const RosCamera& camera, Rectifier& rectifier) {
  const bool rectified = stream.topic.find("rect") != std::string::npos;
  if (!rectified && !camera.distortion_problem.empty())
    info_.problems.push_back(
        fmt::format("images of {} keep their distortion: {}", stream.topic, camera.distortion_problem));
  if (!rectified && camera.distortion.model != Distortion::Model::none) {
    rectifier = Rectifier(camera.raw, camera.distortion);
    info_.guesses.push_back(fmt::format("images of {} are undistorted on reading", stream.topic));
  }
  return rectified ? camera.rectified : camera.raw;
}

void RosRecording::set_cameras(const Content& content) {
  depth_unit_m_ = content.depth_unit_m;
  set_depth_camera(content);
  const cv::Mat first = first_depth_image();
  if (const std::string why = implausible_because(first); !why.empty()) info_.problems.push_back(why);
  correction_.close_grid_holes = has_grid_holes(first);
  if (correction_.close_grid_holes)
    info_.guesses.emplace_back("depth was warped to another camera: the grid of holes is closed");
  if (!color_.when.empty()) set_color_camera(content);
}

void RosRecording::set_depth_camera(const Content& content) {
  info_.camera = kinect_camera();
  info_.camera.depth_from_color = Isometry3d::Identity();
  if (const auto depth = camera_of(depth_, content)) {
    info_.camera.depth = pinhole_of(depth_, *depth, correction_.depth);
  } else if (const auto file = beside_or_above(info_.path, "cameras.yaml"); !file.empty()) {
    FileRecordingContent described;
    read_cameras(file, described);
    info_.camera = described.info.camera;
    depth_unit_m_ = described.depth_scale;
    info_.guesses.push_back(
        fmt::format("no camera_info of depth: the cameras are those of {}", file.string()));
    return;
  } else {
    info_.problems.emplace_back(
        "no camera_info of depth: a Kinect v1 is assumed; record its camera_info, too, or describe the "
        "camera in a cameras.yaml beside the bag");
  }
  info_.camera.color = info_.camera.depth;
}

void RosRecording::set_color_camera(const Content& content) {
  if (const auto color = camera_of(color_, content))
    info_.camera.color = pinhole_of(color_, *color, correction_.color);
  else if (info_.camera.color == info_.camera.depth)
    info_.problems.emplace_back("no camera_info of colour: taken as that of depth");
  try {
    color_image(color_.when.front().second);
  } catch (const Error& error) {
    info_.problems.push_back(fmt::format("the first colour image cannot be read ({})", error.what()));
  }
}

cv::Mat RosRecording::depth_image(size_t message) const {
  std::string bytes;
  cv::Mat image = read_ros_depth(message_of(depth_, message, bytes), depth_.compressed, depth_unit_m_);
  check_image_size(image, info_.camera.depth, where(depth_.topic, message));
  return image;
}

cv::Mat RosRecording::color_image(size_t message) const {
  std::string bytes;
  cv::Mat color = read_ros_color(message_of(color_, message, bytes), color_.compressed);
  check_image_size(color, info_.camera.color, where(color_.topic, message));
  return color;
}

cv::Mat RosRecording::first_depth_image() const {
  std::optional<Error> first;
  for (const auto& [time, message] : depth_.when) {
    try {
      return depth_image(message);
    } catch (const Error& error) {
      if (!first) first = error;
    }
  }
  throw Error(*first);
}

void RosRecording::set_color_pose(const Content& content, TimeNs time) {
  if (color_.when.empty()) return;
  if (!content.extrinsics.empty()) {  // librealsense names transforms, not frames.
    const auto from_reference = [&](const Stream& stream) -> std::optional<Isometry3d> {
      const std::string space = parent_of(parent_of(stream.topic)) + "/tf/";
      for (const auto& [name, pose] : content.extrinsics)
        if (name.starts_with(space)) return pose;
      return std::nullopt;
    };
    const auto depth = from_reference(depth_), color = from_reference(color_);
    if (depth && color) info_.camera.depth_from_color = *depth * color->inverse();
    return;
  }
  if (color_.frame == depth_.frame) return;
  if (const auto transform = content.transforms.between(depth_.frame, color_.frame, time))
    info_.camera.depth_from_color = *transform;
  else
    info_.guesses.push_back(fmt::format(
        "no transform from {} to {}: colour is taken as registered with depth", color_.frame, depth_.frame));
}

void RosRecording::add_frames(const Content& content, double color_delay_s) {
  const TransformTree& tree = content.transforms;
  info_.map_frame = tree.root_of(depth_.frame);
  const bool moves = tree.moves(depth_.frame);
  const bool posed = info_.map_frame != depth_.frame && (moves || names_a_world(info_.map_frame));
  if (!posed && info_.map_frame != depth_.frame)
    info_.guesses.push_back(fmt::format("{} is only fixed to {}: where the camera is is not known",
                                        depth_.frame, info_.map_frame));
  info_.levelled = names_a_world(info_.map_frame);
  std::vector<TimeNs> depth_times, color_times;
  for (const auto& [time, message] : depth_.when) depth_times.push_back(time);
  for (const auto& [time, message] : color_.when)
    color_times.push_back(time - static_cast<TimeNs>(color_delay_s * static_cast<double>(kSecond)));
  const auto matches = nearest_in_time(depth_times, color_times);
  if (const std::string why = unmatched_because(depth_times, color_times); !why.empty())
    info_.problems.push_back(why);
  size_t most = 0;
  for (const auto& [time, message] : depth_.when) most = std::max(most, message);
  color_of_.resize(most + 1);
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
  set_color_pose(content, depth_times.front());
}

void RosRecording::set_joints(std::vector<RosJoints> joints) {
  std::stable_sort(joints.begin(), joints.end(),
                   [](const RosJoints& a, const RosJoints& b) { return a.stamp_ns < b.stamp_ns; });
  JointState now;
  size_t next = 0;
  for (FrameFiles& frame : frames_) {  // Ascending in time, as stream stamps are.
    for (; next < joints.size() && joints[next].stamp_ns <= frame.time_ns; ++next)
      for (const auto& [name, position] : joints[next].positions) now[name] = position;
    frame.joints = now;
  }
}

void RosRecording::set_up(const Content& content) {
  constexpr TimeNs kNear = kSecond / 2;
  constexpr double kGravity = 9.81, kMaxDeviation = 1;
  Vector3d sum = Vector3d::Zero();
  size_t samples = 0;
  for (const RosAcceleration& each : content.accelerations) {
    if (std::abs(each.header.stamp_ns - info_.first_time) > kNear) continue;
    const auto camera_from_imu =
        content.transforms.between(depth_.frame, each.header.frame, info_.first_time);
    if (!camera_from_imu || !each.acceleration.allFinite()) continue;
    sum += camera_from_imu->linear() * each.acceleration;
    ++samples;
  }
  if (samples == 0) return;
  const Vector3d mean = sum / static_cast<double>(samples);
  if (std::abs(mean.norm() - kGravity) < kMaxDeviation) info_.up_in_camera = mean.normalized();
}

RgbdFrame RosRecording::frame(size_t i) const {
  const FrameFiles& from = frames_.at(i);
  const auto message = static_cast<size_t>(from.index);
  const std::lock_guard lock(bag_lock_);
  RgbdFrame frame;
  frame.index = from.index;
  frame.name = fmt::format("frame-{:06}", from.index);
  frame.time_ns = from.time_ns;
  frame.camera = info_.camera;
  frame.map_from_camera = from.map_from_camera;
  frame.joints = from.joints;
  read_images(
      frame, [&] { return depth_image(message); },
      [&] {
        const std::optional<size_t> number = color_of_.at(message);
        return number ? color_image(*number) : cv::Mat();
      });
  correction_.apply(frame);
  return frame;
}

}  // namespace loci::mapping
