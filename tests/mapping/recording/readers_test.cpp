// Recordings in other people's layouts, made here as small as they can be.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "mapping/sensor/pcd.h"
#include "tests/mapping/recording/bag_writer.h"

namespace loci::mapping::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kWidth = 12, kHeight = 10;

class OtherLayouts : public testing::Test {
 protected:
  OtherLayouts() { make_folder(root_); }
  ~OtherLayouts() override { fs::remove_all(root_); }

  static std::string refusal(const fs::path& path) {
    try {
      open_recording(path);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }

  fs::path root_ = fs::path(testing::TempDir()) /
                   (std::string("layouts_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

// TUM RGB-D ------------------------------------------------------------------------------------------------

class Tum : public OtherLayouts {
 protected:
  Tum() {
    make_folder(root_ / "depth");
    make_folder(root_ / "rgb");
    for (const char* stamp : {"1305031102.160407", "1305031102.260000"}) {
      cv::Mat depth(480, 640, CV_16UC1, cv::Scalar(7500));
      depth.at<uint16_t>(3, 4) = 0;
      write_image(root_ / "depth" / (std::string(stamp) + ".png"), depth);
      write_image(root_ / "rgb" / (std::string(stamp) + ".png"),
                  cv::Mat(480, 640, CV_8UC3, cv::Scalar(1, 2, 3)));
    }
    write_file_atomically(root_ / "depth.txt",
                          "# depth maps\n1305031102.160407 depth/1305031102.160407.png\n"
                          "1305031102.260000 depth/1305031102.260000.png\n");
    write_file_atomically(root_ / "rgb.txt",
                          "# colour\n1305031102.175304 rgb/1305031102.160407.png\n"
                          "1305031102.300000 rgb/1305031102.260000.png\n");
    write_file_atomically(
        root_ / "groundtruth.txt",
        "# timestamp tx ty tz qx qy qz qw\n"
        "1305031102.110407 0 0 1 0 0 0 1\n1305031102.210407 1 0 1 0 0 0.70710678 0.70710678\n");
  }
};

TEST_F(Tum, FramesTakeTheNearestColourAndThePoseBetweenItsNeighbours) {
  const auto recording = open_recording(root_);
  EXPECT_EQ(recording->info().format, "tum");
  ASSERT_EQ(recording->size(), 2U);
  const RgbdFrame first = recording->frame(0);
  EXPECT_EQ(first.time_ns, 1305031102160407000);
  EXPECT_FLOAT_EQ(first.depth.at<float>(0, 0), 1.5F);
  EXPECT_TRUE(std::isnan(first.depth.at<float>(3, 4)));
  EXPECT_EQ(first.color.at<cv::Vec3b>(5, 5), cv::Vec3b(1, 2, 3));
  ASSERT_TRUE(first.map_from_camera);
  EXPECT_NEAR(first.map_from_camera->translation().x(), 0.5, 1e-9);
  EXPECT_NEAR(Eigen::AngleAxisd(first.map_from_camera->linear()).angle(), kPi / 4, 1e-6);
  // The second has neither a colour image nor a pose within 20 ms.
  EXPECT_TRUE(recording->frame(1).color.empty());
  EXPECT_FALSE(recording->frame(1).map_from_camera);
}

TEST_F(Tum, ADelayOfTheColourCameraIsTakenOff) {
  RecordingOptions options;
  options.color_delay_s = 0.04;
  const auto recording = open_recording(root_, options);
  EXPECT_TRUE(recording->frame(0).color.empty()) << "its colour would have been taken 25 ms before";
  EXPECT_FALSE(recording->frame(1).color.empty());
}

TEST_F(Tum, ADelayThatLeavesFramesWithoutColourIsProposed) {
  write_file_atomically(root_ / "rgb.txt",
                        "1305031102.210407 rgb/1305031102.160407.png\n"
                        "1305031102.310000 rgb/1305031102.260000.png\n");
  EXPECT_THAT(
      open_recording(root_)->info().problems,
      testing::Contains(HasSubstr("colour is stamped 0.050 s later than depth: if it was taken with it, "
                                  "give --color-delay-s=0.050")));
}

TEST_F(Tum, OneListOfBothImagesIsRead) {
  const auto lists = open_recording(root_);
  for (const char* name : {"depth.txt", "rgb.txt"}) fs::remove(root_ / name);
  for (const char* row :
       {"1305031102.175304 rgb/1305031102.160407.png 1305031102.160407 depth/1305031102.160407.png\n",
        "1305031102.160407 depth/1305031102.160407.png 1305031102.175304 rgb/1305031102.160407.png\n"}) {
    write_file_atomically(root_ / "associations.txt", row);
    const auto recording = open_recording(root_);
    EXPECT_EQ(recording->info().format, "tum");
    EXPECT_EQ(recording->time_of(0), lists->time_of(0));
    EXPECT_FLOAT_EQ(recording->frame(0).depth.at<float>(0, 0), 1.5F);
    EXPECT_FALSE(recording->frame(0).color.empty());
    EXPECT_TRUE(recording->frame(0).map_from_camera);
  }
  write_file_atomically(root_ / "associations.txt", "1 a.png 1 b.png\n");
  EXPECT_THAT(refusal(root_), HasSubstr("associations.txt:1: which of the two images is depth is not clear"));
}

TEST_F(Tum, ATruthOfAnotherClockIsPointedAt) {
  write_file_atomically(root_ / "groundtruth.txt", "12.5 0 0 1 0 0 0 1\n12.6 nan nan nan nan nan nan nan\n");
  EXPECT_THAT(
      open_recording(root_)->info().problems,
      testing::Contains(testing::AllOf(HasSubstr("groundtruth.txt: no frame of the recording has a pose"),
                                       HasSubstr("the poses go from 1970"))));
}

TEST_F(Tum, DepthInMillimetresIsPointedAtAndItsUnitAloneIsADescription) {
  for (const char* stamp : {"1305031102.160407", "1305031102.260000"})
    write_image(root_ / "depth" / (std::string(stamp) + ".png"),
                cv::Mat(480, 640, CV_16UC1, cv::Scalar(1501)));
  const auto advice = HasSubstr("cameras.yaml with 'depth: {unit_m: 0.001}'");
  EXPECT_THAT(open_recording(root_)->info().problems, testing::Contains(advice));
  write_file_atomically(root_ / "cameras.yaml", "depth: {unit_m: 0.001}\n");
  const auto recording = open_recording(root_);
  EXPECT_FLOAT_EQ(recording->frame(0).depth.at<float>(0, 0), 1.501F);
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.fx, 525);
  EXPECT_THAT(recording->info().problems, testing::Not(testing::Contains(advice)));
  write_file_atomically(root_ / "cameras.yaml", "depth: {depth_scale: 1000}\n");
  EXPECT_THAT(refusal(root_), HasSubstr("unit_m"));
}

TEST_F(Tum, DepthAloneIsRead) {
  fs::remove(root_ / "rgb.txt");
  fs::remove(root_ / "groundtruth.txt");
  EXPECT_EQ(open_recording(root_)->info().format, "tum");
}

TEST_F(Tum, BadListsAreNamedWithTheirLine) {
  write_file_atomically(root_ / "groundtruth.txt", "1305031102.1 0 0 1 0 0 0\n");
  EXPECT_THAT(refusal(root_), HasSubstr("groundtruth.txt:1"));
  write_file_atomically(root_ / "groundtruth.txt", "yesterday 0 0 1 0 0 0 1\n");
  EXPECT_THAT(refusal(root_), HasSubstr("'yesterday' is not a stamp"));
  write_file_atomically(root_ / "groundtruth.txt", "5000000000 0 0 1 0 0 0 1\n");
  EXPECT_THAT(refusal(root_), HasSubstr("'5000000000' is not a stamp"));
  fs::remove(root_ / "groundtruth.txt");
  write_file_atomically(root_ / "depth.txt", "1305031102.1 depth/none.png\n");
  EXPECT_THAT(refusal(root_), HasSubstr("none.png"));
}

// PCD series -----------------------------------------------------------------------------------------------

class Pcd : public OtherLayouts {
 protected:
  /// A wavy surface as a camera of f 15, centre 5.5 4.5 sees it.
  void write(const std::string& name, bool backwards = false, int height = kHeight) const {
    const double sign = backwards ? -1 : 1;
    std::string points;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        if (u == 2 && v == 3) {
          points += "nan nan nan 0\n";
          continue;
        }
        const double z = 1 + 0.1 * ((u + v) % 3);
        points += std::to_string((u - 5.5) / 15 * z) + " " + std::to_string(sign * (v - 4.5) / 15 * z) + " " +
                  std::to_string(sign * z) + " 66051\n";  // 0x010203
      }
    write_file_atomically(
        root_ / name, "VERSION 0.7\nFIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH " +
                          std::to_string(height == 1 ? kWidth * kHeight : kWidth) + "\nHEIGHT " +
                          std::to_string(height) + "\nVIEWPOINT 0 0 0 0 1 0 0\nPOINTS 120\nDATA ascii\n" +
                          points);
  }
};

TEST_F(Pcd, TheCameraIsFittedAndPosesStandBesideTheClouds) {
  write("cloud_1.pcd");
  write("cloud_2.pcd");
  write_file_atomically(root_ / "cloud_2.pose.txt", "1 0 0 3\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto recording = open_recording(root_);
  EXPECT_EQ(recording->info().format, "pcd");
  EXPECT_NEAR(recording->info().camera.depth.fx, 15, 0.01);
  EXPECT_NEAR(recording->info().camera.depth.cy, 4.5, 0.01);
  EXPECT_TRUE(recording->info().time_assumed);
  ASSERT_EQ(recording->size(), 2U);
  const RgbdFrame frame = recording->frame(1);
  EXPECT_NEAR(frame.depth.at<float>(1, 1), 1.2, 1e-5);
  EXPECT_TRUE(std::isnan(frame.depth.at<float>(3, 2)));
  EXPECT_EQ(frame.color.at<cv::Vec3b>(0, 0), cv::Vec3b(3, 2, 1));
  ASSERT_TRUE(frame.map_from_camera);
  EXPECT_DOUBLE_EQ(frame.map_from_camera->translation().x(), 3);
  EXPECT_FALSE(recording->frame(0).map_from_camera);
}

TEST_F(Pcd, OneFileWithZBackwardsIsTurnedAndItsNameIsItsTime) {
  write("1305031102.25.pcd", true);
  const auto recording = open_recording(root_ / "1305031102.25.pcd");
  ASSERT_EQ(recording->size(), 1U);
  EXPECT_EQ(recording->time_of(0), 1305031102250000000);
  EXPECT_NEAR(recording->frame(0).depth.at<float>(0, 0), 1, 1e-5);
  EXPECT_GT(recording->info().camera.depth.fy, 0);
}

TEST_F(Pcd, ANameThatIsNoTimeIsNotTakenForOne) {
  for (const char* name : {"9999999999999999999.pcd", "9999999999.pcd"}) {
    write(name);
    const auto recording = open_recording(root_ / name);
    EXPECT_TRUE(recording->info().time_assumed) << name;
    EXPECT_EQ(format_time(recording->time_of(0)), "2000-01-01T00:00:00Z") << name;
  }
}

TEST_F(Pcd, CloudsThatAreNoImagesAreRefused) {
  write("b.pcd", false, 1);
  EXPECT_THAT(refusal(root_), HasSubstr("not organised"));
  write("a.pcd");
  EXPECT_THAT(refusal(root_), HasSubstr("another size than a.pcd"));
}

// ROS 1 bag ------------------------------------------------------------------------------------------------

RawMessage image(TimeNs stamp, const std::string& frame, const std::string& encoding,
                 const std::string& pixels) {
  const auto step = static_cast<uint32_t>(pixels.size() / kHeight);
  MessageBytes bytes;
  bytes.header(stamp, frame).add(uint32_t{kHeight}).add(uint32_t{kWidth}).text(encoding);
  bytes.add(uint8_t{0}).add(step).text(pixels);
  return {"sensor_msgs/Image", "Header header\n", bytes.bytes()};
}

std::string depth_pixels(uint16_t millimetres) {
  std::vector<uint16_t> pixels(kWidth * kHeight, millimetres);
  pixels[0] = 65535;
  return {reinterpret_cast<const char*>(pixels.data()), 2 * pixels.size()};
}

std::string color_pixels() {
  std::string pixels;
  for (int i = 0; i < kWidth * kHeight; ++i) pixels += std::string("\x01\x02\x03", 3);
  return pixels;
}

RawMessage camera_info(const std::string& frame, double f, const std::string& model = "plumb_bob",
                       double k1 = 0) {
  MessageBytes bytes;
  bytes.header(0, frame).add(uint32_t{kHeight}).add(uint32_t{kWidth}).text(model).add(uint32_t{5}).add(k1);
  for (int i = 1; i < 5; ++i) bytes.add(0.0);
  for (const double k : {f, 0.0, 6.0, 0.0, f, 5.0, 0.0, 0.0, 1.0}) bytes.add(k);
  for (int i = 0; i < 9; ++i) bytes.add(i % 4 == 0 ? 1.0 : 0.0);
  for (int i = 0; i < 12; ++i) bytes.add(0.0);
  return {"sensor_msgs/CameraInfo", "", bytes.bytes()};
}

RawMessage transform(TimeNs stamp, const std::string& parent, const std::string& child, double x) {
  MessageBytes bytes;
  bytes.add(uint32_t{1}).header(stamp, parent).text(child);
  for (const double value : {x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) bytes.add(value);
  return {"tf2_msgs/TFMessage", "", bytes.bytes()};
}

class Bag : public OtherLayouts {
 protected:
  std::vector<BagEntry> entries() const {
    std::vector<BagEntry> all = {
        {"/tf_static", 1000 * kSecond, transform(1000 * kSecond, "map", "odom", 10)},
        {"/tf_static", 1000 * kSecond, transform(1000 * kSecond, "/depth_frame", "/color_frame", 0.025)},
        {"/cam/depth/camera_info", 1000 * kSecond, camera_info("depth_frame", 20)},
        {"/cam/rgb/camera_info", 1000 * kSecond, camera_info("color_frame", 18)}};
    for (int i = 0; i < 4; ++i) {
      const TimeNs time = 1000 * kSecond + i * kSecond / 10;
      all.push_back({"/tf", time, transform(time - kSecond / 20, "odom", "depth_frame", i - 0.5)});
      all.push_back(
          {"/cam/depth/image", time, image(time, "depth_frame", "16UC1", depth_pixels(uint16_t(1000 + i)))});
      all.push_back({"/cam/rgb/image", time, image(time + 5'000'000, "color_frame", "rgb8", color_pixels())});
    }
    return all;
  }
  fs::path bag_ = root_ / "small.bag";
};

TEST_F(Bag, GivesPosedFramesWhateverItsCompression) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    write_bag(bag_, entries(), compression);
    const auto recording = open_recording(bag_);
    EXPECT_EQ(recording->info().format, "rosbag");
    EXPECT_EQ(recording->info().map_frame, "map");
    EXPECT_DOUBLE_EQ(recording->info().camera.depth.fx, 20);
    EXPECT_DOUBLE_EQ(recording->info().camera.color.fx, 18);
    EXPECT_DOUBLE_EQ(recording->info().camera.depth_from_color.translation().x(), 0.025);
    ASSERT_EQ(recording->size(), 4U);
    const RgbdFrame frame = recording->frame(2);
    EXPECT_EQ(frame.time_ns, 1000 * kSecond + kSecond / 5);
    EXPECT_TRUE(std::isnan(frame.depth.at<float>(0, 0)));
    EXPECT_FLOAT_EQ(frame.depth.at<float>(4, 4), 1.002F);
    EXPECT_EQ(frame.color.at<cv::Vec3b>(4, 4), cv::Vec3b(3, 2, 1));
    ASSERT_TRUE(frame.map_from_camera);
    EXPECT_NEAR(frame.map_from_camera->translation().x(), 12, 1e-9);  // between 1.5 and 2.5, in odom
    EXPECT_FALSE(recording->frame(3).map_from_camera);                // 50 ms after the last transform
  }
}

TEST_F(Bag, WithoutDepthSaysWhatIsThere) {
  write_bag(bag_,
            {{"/chatter", kSecond, {"std_msgs/String", "string data\n", std::string("\3\0\0\0abc", 7)}}});
  EXPECT_THAT(refusal(bag_), HasSubstr("no depth images"));
  EXPECT_THAT(refusal(bag_), HasSubstr("/chatter (std_msgs/String)"));
}

TEST_F(Bag, TruncatedOrEmptyOrNoneIsOneLine) {
  write_bag(bag_, entries());
  const std::string whole = read_file(bag_);
  for (const double part : {0.95, 0.7, 0.5, 0.1, 0.001}) {
    write_file_atomically(bag_, whole.substr(0, static_cast<size_t>(part * double(whole.size()))));
    EXPECT_THAT(refusal(bag_), HasSubstr("small.bag")) << part;
  }
  write_file_atomically(bag_, "hello");
  EXPECT_THAT(refusal(bag_), HasSubstr("not a ROS 1 bag"));
}

TEST_F(Bag, NoLengthIsBelieved) {
  write_bag(bag_, entries());
  const std::string whole = read_file(bag_);
  const auto with_length_at = [&](size_t at) {
    write_file_atomically(bag_, whole.substr(0, at) + "\xff\xff\xff\x7f" + whole.substr(at + 4));
  };
  const size_t chunk =
      whole.find("compression=none");  // then op, size of the records, and the length of the data
  ASSERT_NE(chunk, std::string::npos);
  with_length_at(chunk + 37);
  EXPECT_THAT(refusal(bag_), HasSubstr("it ends within a record"));
  with_length_at(chunk + 33);
  EXPECT_THAT(refusal(bag_), HasSubstr("a chunk of 2147483647 bytes"));
  with_length_at(whole.find("topic=/cam/depth/image", chunk) - 4);
  EXPECT_EQ(open_recording(bag_)->size(), 4U) << "connections stand behind the chunks, too";
  const size_t index = whole.find("op=\x04", chunk);  // its data: time and place of each message
  ASSERT_NE(index, std::string::npos);
  const size_t entry = whole.find(std::string("\xe8\x03\0\0", 4), index);
  with_length_at(entry + 8);
  EXPECT_THAT(refusal(bag_), HasSubstr("a record is too short"));
}

TEST_F(Bag, BrokenMessagesAreLeftOutAndNamed) {
  std::vector<BagEntry> all = entries();
  all[5].message.bytes.resize(all[5].message.bytes.size() - 40);
  write_bag(bag_, all);
  const auto recording = open_recording(bag_);
  EXPECT_EQ(recording->size(), 3U);
  EXPECT_THAT(recording->info().problems, testing::Contains(HasSubstr("/cam/depth/image[0]")));
}

TEST_F(Bag, ADistortionThatIsNotReadLeavesTheFocalLength) {
  std::vector<BagEntry> all = entries();
  all[2].message = camera_info("depth_frame", 20, "inverse_brown_conrady", 0.1);
  write_bag(bag_, all);
  const auto recording = open_recording(bag_);
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.fx, 20);
  EXPECT_THAT(recording->info().problems,
              testing::Contains(testing::AllOf(HasSubstr("images of /cam/depth/image keep their distortion"),
                                               HasSubstr("'inverse_brown_conrady' is not read"))));
}

TEST_F(Bag, ACameraThatIsAssumedIsAProblem) {
  std::vector<BagEntry> all = entries();
  std::erase_if(all, [](const BagEntry& entry) { return entry.topic == "/cam/rgb/camera_info"; });
  write_bag(bag_, all);
  EXPECT_THAT(open_recording(bag_)->info().problems,
              testing::Contains(HasSubstr("no camera_info of colour: taken as that of depth")));
}

TEST_F(Bag, ColourInAVideoTopicIsNamed) {
  std::vector<BagEntry> all = entries();
  for (BagEntry& entry : all)
    if (entry.topic == "/cam/rgb/image") {
      entry.topic += "/ffmpeg";
      entry.message = {"ffmpeg_image_transport_msgs/FFMPEGPacket", "", "x"};
    }
  write_bag(bag_, all);
  EXPECT_THAT(open_recording(bag_)->info().problems,
              testing::Contains(HasSubstr("/cam/rgb/image/ffmpeg is not read")));
}

TEST_F(Bag, ReadsAsTheFolderThatItWasMadeOf) {
  const fs::path shared = LOCI_SHARED_DIR;
  if (!fs::exists(shared / "data/bag/redkitchen_12.bag")) GTEST_SKIP() << "no shared data";
  const auto bag = open_recording(shared / "data/bag/redkitchen_12.bag");
  const auto folder = open_recording(shared / "data/redkitchen_rgbd");
  ASSERT_EQ(bag->size(), 12U);
  const RgbdFrame one = bag->frame(0);
  for (size_t i = 0; i < folder->size(); ++i) {
    if (folder->index_of(i) != 188 && folder->frame(i).name != "frame-000188") continue;
    const RgbdFrame same = folder->frame(i);
    cv::Mat a = one.depth.clone(), b = same.depth.clone();
    cv::patchNaNs(a, 0);
    cv::patchNaNs(b, 0);
    EXPECT_LT(cv::norm(a, b, cv::NORM_INF), 1e-6);
    EXPECT_EQ(cv::norm(one.color, same.color, cv::NORM_INF), 0);
    ASSERT_TRUE(one.map_from_camera && same.map_from_camera);
    EXPECT_TRUE(one.map_from_camera->isApprox(*same.map_from_camera, 1e-4));
  }
}

}  // namespace
}  // namespace loci::mapping::test
