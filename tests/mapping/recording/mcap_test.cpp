// MCAP that loci writes: every message is what its own definition says, markers lie over the recording, and
// bags with several cameras are read one camera at a time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <map>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/convert.h"
#include "mapping/recording/ros/bag.h"
#include "mapping/recording/ros/mcap_writer.h"
#include "mapping/recording/ros/message_writers.h"
#include "mapping/sensor/kinect.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Decodes CDR by the text of a type, as viewers do: values by path, "markers.1.text".
class Decoder {
 public:
  Decoder(const std::string& definition, std::string_view bytes) : bytes_(bytes.substr(4)) {
    std::string type;
    std::istringstream lines(definition);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("MSG: ")) type = line.substr(5);
      if (line.empty() || line.front() == '=' || line.starts_with("MSG: ")) continue;
      const size_t space = line.find(' ');
      types_[type].emplace_back(line.substr(0, space), line.substr(space + 1));
    }
    read_fields("", "");
  }
  bool at_end() const { return at_ == bytes_.size(); }
  double number(const std::string& path) const { return numbers_.at(path); }
  std::string text(const std::string& path) const { return texts_.at(path); }

 private:
  template <typename T>
  T take() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    T value;
    std::copy_n(bytes_.substr(at_, sizeof(T)).data(), sizeof(T), reinterpret_cast<char*>(&value));
    at_ += sizeof(T);
    return value;
  }
  void read_fields(const std::string& type, const std::string& path) {
    for (const auto& [field_type, name] : types_.at(type)) read(field_type, path + name);
  }
  void read(const std::string& type, const std::string& path) {
    if (const size_t bracket = type.find('['); bracket != std::string::npos) {
      const std::string length = type.substr(bracket + 1, type.size() - bracket - 2);
      const size_t count = length.empty() ? take<uint32_t>() : std::stoul(length);
      numbers_[path + ".size"] = double(count);
      for (size_t i = 0; i < count; ++i) read(type.substr(0, bracket), path + "." + std::to_string(i));
    } else if (type == "string") {
      const uint32_t size = take<uint32_t>();
      texts_[path] = bytes_.substr(at_, size - 1);
      at_ += size;
    } else if (type == "float64") {
      numbers_[path] = take<double>();
    } else if (type == "float32") {
      numbers_[path] = double(take<float>());
    } else if (type == "uint32") {
      numbers_[path] = take<uint32_t>();
    } else if (type == "int32") {
      numbers_[path] = take<int32_t>();
    } else if (type == "uint8" || type == "bool") {
      numbers_[path] = take<uint8_t>();
    } else {
      read_fields(type, path + ".");
    }
  }

  std::string_view bytes_;
  size_t at_ = 0;
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> types_;
  std::map<std::string, double> numbers_;
  std::map<std::string, std::string> texts_;
};

RgbdFrame mcap_frame(TimeNs time) {
  RgbdFrame frame;
  frame.time_ns = time;
  frame.depth = cv::Mat(2, 3, CV_32F, cv::Scalar(1.25));
  frame.color = cv::Mat(2, 3, CV_8UC3, cv::Scalar(10, 20, 30));
  frame.joints = {{"drawer_joint", 0.25}};
  frame.map_from_camera = Isometry3d(Eigen::Translation3d(1, 2, 3));
  return frame;
}

RgbdCamera mcap_camera() {
  RgbdCamera camera = kinect_camera();
  camera.depth.width = camera.color.width = 3;
  camera.depth.height = camera.color.height = 2;
  return camera;
}

TEST(Mcap, EveryMessageIsWhatItsDefinitionSays) {
  const RgbdFrame frame = mcap_frame(5 * kSecond + 7);
  const PinholeCamera camera = mcap_camera().depth;
  const auto whole = [](const MessageType& type, const std::string& message) {
    const Decoder decoder(type.definition, message);
    EXPECT_TRUE(decoder.at_end()) << type.name;
    return decoder;
  };
  const Decoder image = whole(image_type(), image_message(frame.depth, "32FC1", frame.time_ns, "depth"));
  EXPECT_EQ(image.number("header.stamp.sec"), 5);
  EXPECT_EQ(image.number("header.stamp.nanosec"), 7);
  EXPECT_EQ(image.text("header.frame_id"), "depth");
  EXPECT_EQ(image.number("data.size"), 24);
  const Decoder color =
      whole(compressed_image_type(), compressed_image_message(frame.color, frame.time_ns, "color"));
  EXPECT_EQ(color.number("data.1"), 'P');
  const Decoder info = whole(camera_info_type(), camera_info_message(camera, frame.time_ns, "depth"));
  EXPECT_EQ(info.number("width"), 3);
  EXPECT_EQ(info.number("k.0"), camera.fx);
  EXPECT_EQ(info.number("p.6"), camera.cy);
  const Decoder tf =
      whole(transforms_type(), transform_message(*frame.map_from_camera, frame.time_ns, "map", "depth"));
  EXPECT_EQ(tf.text("transforms.0.child_frame_id"), "depth");
  EXPECT_EQ(tf.number("transforms.0.transform.translation.z"), 3);
  EXPECT_EQ(tf.number("transforms.0.transform.rotation.w"), 1);
  const Decoder joints = whole(joint_state_type(), joint_state_message(frame.joints, frame.time_ns));
  EXPECT_EQ(joints.text("name.0"), "drawer_joint");
  EXPECT_EQ(joints.number("position.0"), 0.25);
}

TEST(Mcap, MarkersReplaceThoseBeforeThem) {
  const Marker cup{.group = "object",
                   .id = 4,
                   .map_from_marker = Isometry3d(Eigen::Translation3d(1, 2, 3)),
                   .size = {0.1, 0.2, 0.3},
                   .color = {1, 0, 0, 0.5F}};
  const Marker name{.group = "name", .id = 4, .shape = Marker::Shape::text, .text = "red cup"};
  const Marker table{.group = "table",
                     .shape = Marker::Shape::triangles,
                     .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                     .point_colors = std::vector(3, Marker::Color(0, 1, 0, 1))};
  const Decoder markers(marker_array_type().definition,
                        marker_array_message({cup, name, table}, 9 * kSecond, "map"));
  EXPECT_TRUE(markers.at_end());
  EXPECT_EQ(markers.number("markers.size"), 4);
  EXPECT_EQ(markers.number("markers.0.action"), 3) << "deletes all";
  EXPECT_EQ(markers.number("markers.1.type"), 1) << "a cube";
  EXPECT_EQ(markers.number("markers.1.action"), 0) << "is added";
  EXPECT_EQ(markers.text("markers.1.header.frame_id"), "map");
  EXPECT_EQ(markers.number("markers.1.pose.position.y"), 2);
  EXPECT_EQ(markers.number("markers.1.scale.z"), 0.3);
  EXPECT_EQ(markers.number("markers.1.color.a"), 0.5);
  EXPECT_EQ(markers.number("markers.2.type"), 9);
  EXPECT_EQ(markers.text("markers.2.text"), "red cup");
  EXPECT_EQ(markers.number("markers.3.points.1.x"), 1);
  EXPECT_EQ(markers.number("markers.3.colors.2.g"), 1);
}

/// Frames from memory.
class FrameRecording : public Recording {
 public:
  explicit FrameRecording(std::vector<RgbdFrame> frames) : frames_(std::move(frames)) {
    info_.camera = mcap_camera();
  }
  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return frames_.size(); }
  RgbdFrame frame(size_t i) const override { return frames_.at(i); }
  TimeNs time_of(size_t i) const override { return frames_.at(i).time_ns; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }

 private:
  std::vector<RgbdFrame> frames_;
  RecordingInfo info_;
};

TEST(Mcap, AConvertedRecordingHoldsItsMarkersWhenTheyChange) {
  const TemporaryFolder folder("mcap");
  const fs::path file = folder.path() / "out.mcap";
  ConvertOptions options;
  options.format = RecordingFormat::mcap;
  options.layers.push_back({"/objects", [](const RgbdFrame& frame) {
                              std::optional<std::vector<Marker>> changed;
                              if (frame.time_ns != 2 * kSecond) changed.emplace(1);
                              return changed;
                            }});
  const FrameRecording recording({mcap_frame(kSecond), mcap_frame(2 * kSecond), mcap_frame(3 * kSecond)});
  NoProgress progress;
  EXPECT_EQ(convert_recording(recording, file, options, progress).used(), 3U);
  const RosBag bag(file);
  ASSERT_NE(bag.find("/objects"), nullptr);
  EXPECT_EQ(bag.find("/objects")->type, "visualization_msgs/MarkerArray");
  EXPECT_THAT(bag.times("/objects"), ElementsAre(kSecond, 3 * kSecond));
  EXPECT_EQ(open_recording(file)->size(), 3U);
}

/// A bag with two cameras; that of the back has no colour of its own.
fs::path two_cameras(const fs::path& folder) {
  McapWriter writer(folder / "two.mcap", {});
  const auto channel = [&](const std::string& topic, const MessageType& type) {
    return writer.add_channel(topic, type.name, type.definition);
  };
  const uint16_t front = channel("/front/depth/image_rect", image_type());
  const uint16_t front_info = channel("/front/depth/camera_info", camera_info_type());
  const uint16_t color = channel("/front/color/image_rect/compressed", compressed_image_type());
  const uint16_t back = channel("/back/depth/image_rect", image_type());
  const uint16_t back_info = channel("/back/depth/camera_info", camera_info_type());
  PinholeCamera camera = mcap_camera().depth;
  for (TimeNs time = kSecond; time <= 3 * kSecond; time += kSecond) {
    const RgbdFrame frame = mcap_frame(time);
    writer.add(front_info, time, camera_info_message(camera, time, "front"));
    writer.add(front, time, image_message(frame.depth, "32FC1", time, "front"));
    writer.add(color, time, compressed_image_message(frame.color, time, "front"));
    if (time == kSecond) continue;
    PinholeCamera other = camera;
    other.fx = 100;
    writer.add(back_info, time, camera_info_message(other, time, "back"));
    writer.add(back, time, image_message(frame.depth * 2, "32FC1", time, "back"));
  }
  writer.finish();
  return folder / "two.mcap";
}

/// sensor_msgs/Imu.
std::string acceleration_message(TimeNs time, const std::string& frame, const Vector3d& acceleration) {
  CdrWriter cdr;
  cdr.header(time, frame);
  for (int i = 0; i < 4 + 9 + 3 + 9; ++i) cdr.add(0.0);  // Orientation and turn rate, with covariances.
  for (const double value : acceleration) cdr.add(value);
  for (int i = 0; i < 9; ++i) cdr.add(0.0);
  return cdr.bytes();
}

TEST(Mcap, AnImuAtRestMeasuresWhatIsUp) {
  const TemporaryFolder folder("imu");
  const auto up_of = [&](const Vector3d& acceleration) {
    const fs::path file = folder.path() / "imu.mcap";
    McapWriter writer(file, {});
    const uint16_t depth =
        writer.add_channel("/depth/image_rect", image_type().name, image_type().definition);
    const uint16_t camera =
        writer.add_channel("/depth/camera_info", camera_info_type().name, camera_info_type().definition);
    const uint16_t imu = writer.add_channel("/imu", "sensor_msgs/msg/Imu", "");
    writer.add(camera, kSecond, camera_info_message(mcap_camera().depth, kSecond, "camera"));
    writer.add(depth, kSecond, image_message(mcap_frame(kSecond).depth, "32FC1", kSecond, "camera"));
    for (int i = 0; i < 5; ++i)
      writer.add(imu, kSecond + i, acceleration_message(kSecond + i, "camera", acceleration));
    writer.finish();
    return open_recording(file)->info().up_in_camera;
  };
  const auto up = up_of({2, -9.6, 0});
  ASSERT_TRUE(up);
  EXPECT_LT((*up - Vector3d(2, -9.6, 0).normalized()).norm(), 1e-9);
  EXPECT_FALSE(up_of({0, -14, 0})) << "it is shaken";
}

TEST(Mcap, AnImageWhoseTimeIsTooFarOffIsLeftOut) {
  const TemporaryFolder folder("far");
  const fs::path file = folder.path() / "far.mcap";
  McapWriter writer(file, {});
  const uint16_t depth = writer.add_channel("/depth/image_rect", image_type().name, image_type().definition);
  const auto add = [&](TimeNs recorded) {  // without a stamp of its own
    writer.add(depth, recorded,
               image_message(cv::Mat(480, 640, CV_32F, cv::Scalar(1)), "32FC1", 0, "camera"));
  };
  add(kSecond);
  add(std::numeric_limits<TimeNs>::max());
  writer.finish();
  const auto recording = open_recording(file);
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_THAT(joined(recording->info().problems, "; "), HasSubstr("the time stamp is too far off"));
}

TEST(Mcap, OfSeveralCamerasOneIsReadAndTheOthersAreNamed) {
  const TemporaryFolder folder("cameras");
  const fs::path file = two_cameras(folder.path());
  const auto front = open_recording(file);
  EXPECT_THAT(front->info().camera_names, ElementsAre("front", "back"));
  EXPECT_THAT(joined(front->info().guesses, "; "), HasSubstr("not back (choose with --camera NAME)"));
  EXPECT_EQ(front->size(), 3U);
  EXPECT_FALSE(front->frame(0).color.empty());

  RecordingOptions options;
  options.camera = "back";
  const auto back = open_recording(file, options);
  EXPECT_EQ(back->size(), 2U);
  EXPECT_EQ(back->info().camera.depth.fx, 100);
  EXPECT_FLOAT_EQ(back->frame(0).depth.at<float>(0, 0), 2.5F);
  EXPECT_TRUE(back->frame(0).color.empty()) << "the colour of the front is not the back's";

  options.camera = "side";
  try {
    open_recording(file, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("has no camera side"));
    EXPECT_THAT(error.what(), HasSubstr("back, front"));
  }
}

}  // namespace
}  // namespace loci::mapping
