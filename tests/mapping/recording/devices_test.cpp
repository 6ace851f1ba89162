// Bags as other devices write them, serialised here and written by rosbag.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "mapping/recording/ros/messages.h"
#include "tests/mapping/recording/bag_writer.h"

namespace loci::mapping::devices {
namespace {

namespace fs = std::filesystem;
using test::BagEntry;
using test::MessageBytes;
using test::write_bag;
using testing::Contains;
using testing::HasSubstr;

constexpr TimeNs kTime = 1'700'000'000 * kSecond;
constexpr int kWidth = 16, kHeight = 8;

/// sensor_msgs/Image of `rows` bytes per row.
std::string image(const std::string& encoding, const std::string& pixels, size_t row, bool big_endian = false,
                  const std::string& frame = "camera") {
  return MessageBytes()
      .header(kTime, frame)
      .add(uint32_t{kHeight})
      .add(uint32_t{kWidth})
      .text(encoding)
      .add(static_cast<uint8_t>(big_endian))
      .add(static_cast<uint32_t>(row))
      .text(pixels)
      .bytes();
}

template <typename T>
std::string repeated(std::vector<T> pixel, bool swapped = false) {
  std::string bytes;
  for (int i = 0; i < kWidth * kHeight; ++i)
    for (const T value : pixel) {
      std::array<char, sizeof(T)> raw{};
      std::memcpy(raw.data(), &value, sizeof(T));
      if (swapped) std::reverse(raw.begin(), raw.end());
      bytes.append(raw.data(), raw.size());
    }
  return bytes;
}

std::string camera_info(const std::string& frame, double f) {
  MessageBytes bytes;
  bytes.header(kTime, frame).add(uint32_t{kHeight}).add(uint32_t{kWidth}).text("plumb_bob").add(uint32_t{0});
  for (const double value : {f, 0.0, 7.5, 0.0, f, 3.5, 0.0, 0.0, 1.0}) bytes.add(value);
  for (int i = 0; i < 9; ++i) bytes.add(i % 4 == 0 ? 1.0 : 0.0);
  for (const double value : {f, 0.0, 7.5, 0.0, 0.0, f, 3.5, 0.0, 0.0, 0.0, 1.0, 0.0}) bytes.add(value);
  for (int i = 0; i < 6; ++i) bytes.add(uint32_t{0});
  return bytes.add(uint8_t{0}).bytes();
}

BagEntry entry(const std::string& topic, const std::string& type, const std::string& bytes,
               TimeNs time = kTime) {
  return {topic, time, {type, "", bytes}};
}

RosMessage message(const std::string& bytes) {
  return {bytes, Serialization::ros1, "message"};
}

std::string depth_image(const std::string& frame = "camera") {
  return image("16UC1", repeated<uint16_t>({1500}), 2 * kWidth, false, frame);
}

TEST(Devices, PixelsMayBeBigEndian) {
  const std::string shorts = image("16UC1", repeated<uint16_t>({1500}, true), 2 * kWidth, true);
  EXPECT_FLOAT_EQ(read_ros_depth(message(shorts), false).at<float>(3, 3), 1.5F);
  const std::string floats = image("32FC1", repeated<float>({2.25F}, true), 4 * kWidth, true);
  EXPECT_FLOAT_EQ(read_ros_depth(message(floats), false).at<float>(3, 3), 2.25F);
}

TEST(Devices, ColourMayHaveSixteenBitsAndChromaInRowsOfItsOwn) {
  const auto pixel = [](const std::string& bytes) {
    return read_ros_color(message(bytes), false).at<cv::Vec3b>(3, 3);
  };
  EXPECT_EQ(pixel(image("rgb16", repeated<uint16_t>({10 * 257, 20 * 257, 30 * 257}), 6 * kWidth)),
            cv::Vec3b(30, 20, 10));
  EXPECT_EQ(pixel(image("bgra16", repeated<uint16_t>({2570, 5140, 7710, 65535}), 8 * kWidth)),
            cv::Vec3b(10, 20, 30));
  EXPECT_EQ(pixel(image("mono16", repeated<uint16_t>({100 * 257}, true), 2 * kWidth, true)),
            cv::Vec3b(100, 100, 100));
  // Y 81, U 90, V 240 is red (BT.601).
  std::string nv12(kWidth * kHeight, '\x51'), nv21 = nv12;
  for (int i = 0; i < kWidth * kHeight / 4; ++i) {
    nv12 += "\x5a\xf0";
    nv21 += "\xf0\x5a";
  }
  for (const auto& [encoding, bytes] : {std::pair("nv12", nv12), std::pair("nv21", nv21)}) {
    const cv::Vec3b red = pixel(image(encoding, bytes, kWidth));
    EXPECT_GT(red[2], 250) << encoding;
    EXPECT_LT(red[0] + red[1], 6) << encoding;
  }
  EXPECT_THROW(pixel(image("nv21", std::string(kWidth * kHeight, '\x51'), kWidth)), Error);
}

TEST(Devices, DepthMayBePackedByTheTransportForColour) {
  const auto png = encode_image(cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(1500)), ".png");
  const std::string packed = MessageBytes()
                                 .header(kTime, "camera")
                                 .text("16UC1; png compressed ")
                                 .text(std::string(png.begin(), png.end()))
                                 .bytes();
  EXPECT_FLOAT_EQ(read_ros_depth(message(packed), true).at<float>(3, 3), 1.5F);
}

TEST(Devices, CameraInfoIsFoundByItsFrameWhereItsTopicHasAnotherName) {
  const TemporaryFolder folder("devices");
  const fs::path bag = folder.path() / "names.bag";
  write_bag(bag, {entry("/d", "sensor_msgs/Image", depth_image("depth_optical")),
                  entry("/d_info", "sensor_msgs/CameraInfo", camera_info("depth_optical", 20)),
                  entry("/c_info", "sensor_msgs/CameraInfo", camera_info("color_optical", 30)),
                  entry("/c", "sensor_msgs/Image",
                        image("rgb8", repeated<uint8_t>({1, 2, 3}), 3 * kWidth, false, "color_optical"))});
  const auto recording = open_recording(bag);
  EXPECT_EQ(recording->info().camera.depth.fx, 20);
  EXPECT_EQ(recording->info().camera.color.fx, 30);
  EXPECT_TRUE(recording->info().problems.empty());
}

TEST(Devices, WithoutCameraInfoTheCameraMayBeDescribedBesideTheBag) {
  const TemporaryFolder folder("devices");
  const fs::path bag = folder.path() / "bare.bag";
  write_bag(bag, {entry("/depth/image", "sensor_msgs/Image", depth_image())});
  EXPECT_THROW(open_recording(bag), Error);  // A Kinect has more pixels.
  write_file_atomically(folder.path() / "cameras.yaml",
                        "depth: {width: 16, height: 8, fx: 20, fy: 21, cx: 7.5, cy: 3.5, unit_m: 0.002}\n");
  const auto recording = open_recording(bag);
  EXPECT_EQ(recording->info().camera.depth.fy, 21);
  EXPECT_FLOAT_EQ(recording->frame(0).depth.at<float>(3, 3), 3.0F);
  EXPECT_THAT(recording->info().guesses, Contains(HasSubstr("cameras.yaml")));
}

TEST(Devices, InfraredOfSixteenBitsIsNotDepth) {
  const TemporaryFolder folder("devices");
  const fs::path bag = folder.path() / "ir.bag";
  const std::string infrared = image("mono16", repeated<uint16_t>({900}), 2 * kWidth);
  write_bag(bag, {entry("/k4a/depth/image_raw", "sensor_msgs/Image", depth_image()),
                  entry("/k4a/depth/camera_info", "sensor_msgs/CameraInfo", camera_info("camera", 20)),
                  entry("/k4a/ir/image_raw", "sensor_msgs/Image", infrared),
                  entry("/k4a/ir/image_raw", "sensor_msgs/Image", infrared, kTime + kSecond)});
  const auto recording = open_recording(bag);
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_EQ(recording->info().camera_names.size(), 1U);
  EXPECT_FLOAT_EQ(recording->frame(0).depth.at<float>(3, 3), 1.5F);
}

TEST(Devices, ColourThatCannotBeReadIsNamedOnOpening) {
  const TemporaryFolder folder("devices");
  const fs::path bag = folder.path() / "odd.bag";
  write_bag(bag, {entry("/camera/depth/image_raw", "sensor_msgs/Image", depth_image()),
                  entry("/camera/depth/camera_info", "sensor_msgs/CameraInfo", camera_info("camera", 20)),
                  entry("/camera/color/camera_info", "sensor_msgs/CameraInfo", camera_info("camera", 20)),
                  entry("/camera/color/image_raw", "sensor_msgs/Image",
                        image("odd8", repeated<uint8_t>({1}), kWidth))});
  EXPECT_THAT(open_recording(bag)->info().problems, Contains(HasSubstr("'odd8' are not read")));
}

}  // namespace
}  // namespace loci::mapping::devices
