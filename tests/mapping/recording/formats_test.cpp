// Recordings as other programs lay them out, written here by the definition of each format.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/convert.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/recording/recording.h"
#include "mapping/recording/ros/bag.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;

class Formats : public testing::Test {
 protected:
  Formats() {
    fs::remove_all(root_);
    make_folder(root_);
  }
  ~Formats() override { fs::remove_all(root_); }

  void write(const std::string& name, const std::string& text) const {
    make_folder((root_ / name).parent_path());
    write_file_atomically(root_ / name, text);
  }
  void write_depth(const std::string& name, uint16_t value, int width = kWidth, int height = kHeight) const {
    make_folder((root_ / name).parent_path());
    write_image(root_ / name, cv::Mat(height, width, CV_16UC1, cv::Scalar(value)));
  }
  void write_color(const std::string& name, int width = kWidth, int height = kHeight) const {
    make_folder((root_ / name).parent_path());
    write_image(root_ / name, cv::Mat(height, width, CV_8UC3, cv::Scalar(10, 20, 30)));
  }
  std::string refusal(const fs::path& path) const {
    try {
      open_recording(path);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }
  /// Poses of the formats below have no floor to be levelled by: z is kept.
  static std::unique_ptr<Recording> open_as_is(const fs::path& path, const std::string& poses = {}) {
    RecordingOptions options;
    options.up = "keep";
    options.poses = poses;
    return open_recording(path, options);
  }

  fs::path root_ = fs::path(testing::TempDir()) /
                   (std::string("formats_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

// Open3D and Redwood
// -----------------------------------------------------------------------------------------

TEST_F(Formats, RedwoodFoldersHaveCameraTrajectoryAndMicroseconds) {
  for (int i = 1; i <= 2; ++i) {
    write_depth("depth/000000" + std::to_string(i) + "-00000003336" + std::to_string(i) + ".png", 2000);
    write_color("image/000000" + std::to_string(i) + "-00000003336" + std::to_string(i) + ".jpg");
  }
  write("camera_intrinsic.json",
        R"({"width": 64, "height": 48, "intrinsic_matrix": [52.5, 0, 0, 0, 52.6, 0, 31.9, 23.9, 1]})");
  write("trajectory.log",
        "0 0 1\n1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 1 2\n1 0 0 1.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto recording = open_as_is(root_);
  EXPECT_EQ(recording->info().format, "redwood");
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.fy, 52.6);
  EXPECT_DOUBLE_EQ(recording->info().camera.color.cx, 31.9);
  ASSERT_EQ(recording->size(), 2U);
  EXPECT_EQ(recording->time_of(1) - recording->time_of(0), 1000);
  EXPECT_FLOAT_EQ(recording->frame(0).depth.at<float>(5, 5), 2);
  EXPECT_NEAR(recording->frame(1).map_from_camera->translation().x(), 1.5, 1e-12);
  write("trajectory.log", "0 0 1\n1 0 0 0.5\n0 1 0 0\n");
  EXPECT_THAT(refusal(root_), HasSubstr("trajectory.log"));
  fs::remove(root_ / "trajectory.log");
  fs::remove(root_ / "image/0000001-000000033361.jpg");
  const auto with_one_color = open_as_is(root_);
  ASSERT_EQ(with_one_color->size(), 2U);
  EXPECT_TRUE(with_one_color->frame(0).color.empty());
  EXPECT_FALSE(with_one_color->frame(1).color.empty());
}

TEST_F(Formats, ImagesOfAFolderArePairedByTheNumbersInTheirNames) {
  for (const int i : {0, 1, 3, 4, 5}) write_depth(fmt::format("depth/{:06}.png", i), 1000);
  for (const int i : {0, 1, 2, 3, 5}) write_color(fmt::format("color/frame{}.jpg", i));
  std::string log;
  for (int i = 0; i < 6; ++i)
    log += fmt::format("{0} {0} {1}\n1 0 0 {0}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", i, i + 1);
  write("scene/trajectory.log", log);
  const auto recording = open_as_is(root_);
  ASSERT_EQ(recording->size(), 5U);
  EXPECT_EQ(recording->color_name_of(2), "frame3");
  EXPECT_TRUE(recording->frame(3).color.empty());
  EXPECT_DOUBLE_EQ(recording->frame(2).map_from_camera->translation().x(), 3);
  EXPECT_THAT(recording->info().problems,
              Contains(testing::AllOf(HasSubstr("1 of 5 colour images"), HasSubstr("frame2.jpg"))));
  write("scene/trajectory.log", log.substr(0, log.find("3 3 4")));
  EXPECT_EQ(open_as_is(root_)->info().frames_with_pose, 2U);
}

TEST_F(Formats, StampsInNamesOfAFolderAreTimes) {
  const auto seconds = [&](const std::string& first, const std::string& second) {
    for (const char* folder : {"depth", "color"}) fs::remove_all(root_ / folder);
    write_depth("depth/" + first + ".png", 1000);
    write_depth("depth/" + second + ".png", 1000);
    const auto recording = open_as_is(root_);
    EXPECT_EQ(recording->info().time_assumed, first.size() < 13);
    return static_cast<double>(recording->time_of(1) - recording->time_of(0)) / 1e9;
  };
  EXPECT_NEAR(seconds("1700000001.900000", "1700000002.100000"), 0.2, 1e-9);
  EXPECT_NEAR(seconds("kinect_1700000001900", "kinect_1700000002100"), 0.2, 1e-9);
  EXPECT_NEAR(seconds("1700000001900000", "1700000002100000"), 0.2, 1e-9);
  EXPECT_NEAR(seconds("1700000001900000000", "1700000002100000000"), 0.2, 1e-9);
  EXPECT_NEAR(seconds("9.900000", "10.100000"), 0.2, 1e-9);
}

TEST_F(Formats, IntrinsicMatricesComeInSeveralOrders) {
  write_depth("depth/0.png", 1000);
  write_color("color/0.jpg");
  const auto camera_of = [&](const std::string& matrix) {
    write("camera_intrinsic.json", R"({"width": 64, "height": 48, "intrinsic_matrix": )" + matrix + "}");
    return open_as_is(root_)->info().camera.depth;
  };
  const PinholeCamera camera{64, 48, 52, 53, 31, 23};
  EXPECT_EQ(camera_of("[52, 0, 0, 0, 53, 0, 31, 23, 1]"), camera);
  EXPECT_EQ(camera_of("[52, 0, 31, 0, 53, 23, 0, 0, 1]"), camera);
  EXPECT_EQ(camera_of("[[52, 0, 31], [0, 53, 23], [0, 0, 1]]"), camera);
  write("camera_intrinsic.json",
        R"({"width": 64, "height": 48, "intrinsic_matrix": [52, 0, 0, 0, 53, 0, 0, 0, 1]})");
  EXPECT_THAT(refusal(root_), HasSubstr("the principal point 0 0 is far from the middle of 64 x 48 pixels"));
  write("camera_intrinsic.json", R"({"intrinsic_matrix": [52, 53]})");
  EXPECT_THAT(refusal(root_), HasSubstr("3 x 3 numbers"));
}

TEST_F(Formats, CamerasAreScaledToSmallerDepth) {
  write_depth("depth/0.png", 1000, 32, 24);
  write_color("color/0.jpg");
  write("camera_intrinsic.json",
        R"({"width": 64, "height": 48, "intrinsic_matrix": [52, 0, 0, 0, 52, 0, 31.5, 23.5, 1]})");
  const auto recording = open_as_is(root_);
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.fx, 26);
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.cx, 15.5);
  EXPECT_DOUBLE_EQ(recording->info().camera.color.fx, 52);
}

TEST_F(Formats, ExportsOfScanNetHaveIntrinsicsAndPosesInFolders) {
  for (const char* name : {"0", "10", "2"}) {
    write_depth(std::string("depth/") + name + ".png", 1000);
    write_color(std::string("color/") + name + ".jpg", 2 * kWidth, 2 * kHeight);
    write(std::string("pose/") + name + ".txt",
          std::string("1 0 0 ") + name + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  }
  write("pose/2.txt", "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
  write("intrinsic/intrinsic_depth.txt", "57 0 32 0\n0 58 24 0\n0 0 1 0\n0 0 0 1\n");
  write("intrinsic/intrinsic_color.txt", "117 0 64 0\n0 118 48 0\n0 0 1 0\n0 0 0 1\n");
  const auto recording = open_as_is(root_);
  ASSERT_EQ(recording->size(), 3U);
  EXPECT_DOUBLE_EQ(recording->info().camera.color.fx, 117);
  EXPECT_EQ(recording->info().camera.color.width, 2 * kWidth);
  EXPECT_FALSE(recording->frame(1).map_from_camera);  // 2, which was lost
  EXPECT_DOUBLE_EQ(recording->frame(2).map_from_camera->translation().x(), 10);
}

TEST_F(Formats, TrajectoriesOfOpen3DMayBeJson) {
  write_depth("depth/00000.png", 2000);
  write_color("color/00000.jpg");
  write("camera_intrinsic.json",
        R"({"width": 64, "height": 48, "intrinsic_matrix": [52.5, 0, 0, 0, 52.6, 0, 31.9, 23.9, 1]})");
  write("trajectory.json", R"({"class_name": "PinholeCameraTrajectory", "parameters": [
      {"extrinsic": [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 2, 0, -3, 1]}]})");  // column by column
  const auto recording = open_as_is(root_);
  const Isometry3d pose = *recording->frame(0).map_from_camera;
  EXPECT_TRUE(pose.translation().isApprox(Vector3d(0, -2, 3))) << pose.translation().transpose();
  EXPECT_TRUE((pose.linear() * Vector3d::UnitX()).isApprox(Vector3d::UnitY()));
  fs::remove(root_ / "trajectory.json");
  write("lounge_trajectory.log", "0 0 1\n1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_EQ(open_as_is(root_)->info().frames_with_pose, 1U);
}

// TUM
// ----------------------------------------------------------------------------------------------------

TEST_F(Formats, SequencesOfTheTumBenchmarkHaveTheirOwnCameras) {
  const auto focal_length = [&](const std::string& name) {
    write_depth(name + "/depth/1.png", 5000, 640, 480);
    write_color(name + "/rgb/1.png", 640, 480);
    write(name + "/depth.txt", "1.0 depth/1.png\n");
    write(name + "/rgb.txt", "1.0 rgb/1.png\n");
    return open_as_is(root_ / name)->info().camera.depth.fx;
  };
  EXPECT_DOUBLE_EQ(focal_length("rgbd_dataset_freiburg1_desk"), 517.3);
  EXPECT_DOUBLE_EQ(focal_length("rgbd_dataset_freiburg3_office"), 535.4);
  EXPECT_DOUBLE_EQ(focal_length("own"), 525);
}

// Replica
// ----------------------------------------------------------------------------------------------------

TEST_F(Formats, ReplicaHasAScaleOfItsOwn) {
  write_depth("results/depth000000.png", 6554);
  write_color("results/frame000000.jpg");
  write("cam_params.json",
        R"({"camera": {"w": 64, "h": 48, "fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5, "scale": 6553.5}})");
  write("traj.txt", "1 0 0 3 0 1 0 0 0 0 1 0 0 0 0 1\n");
  const auto recording = open_as_is(root_);
  EXPECT_EQ(recording->info().format, "replica");
  EXPECT_NEAR(recording->frame(0).depth.at<float>(1, 1), 1.00008, 1e-5);
  EXPECT_DOUBLE_EQ(recording->frame(0).map_from_camera->translation().x(), 3);
  EXPECT_FALSE(recording->frame(0).color.empty());
  write("traj.txt", "1 0 0 3\n");
  EXPECT_EQ(open_as_is(root_)->info().frames_with_pose, 0U);
  write("cam_params.json",
        R"({"w": 64, "h": 48, "fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5, "scale": 1000})");
  EXPECT_NEAR(open_as_is(root_)->frame(0).depth.at<float>(1, 1), 6.554, 1e-5) << "without 'camera'";
}

// nerfstudio
// -------------------------------------------------------------------------------------------------

TEST_F(Formats, TransformsJsonIsTurnedFromOpenGlAndDepthMayBeSmaller) {
  write_depth("depth/1.png", 1500, kWidth / 2, kHeight / 2);
  write_color("images/1.jpg");
  const std::string head =
      R"({"fl_x": 60, "fl_y": 62, "cx": 32, "cy": 24, "w": 64, "h": 48, "camera_model": "OPENCV", "frames": [)";
  write("transforms.json", head + R"({"file_path": "images/1.jpg", "depth_file_path": "./depth/1.png",
      "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})");
  const auto recording = open_as_is(root_);
  EXPECT_EQ(recording->info().format, "nerfstudio");
  EXPECT_DOUBLE_EQ(recording->info().camera.color.cx, 31.5);
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.fx, 30);
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.cx, 15.5);
  const RgbdFrame frame = recording->frame(0);
  EXPECT_TRUE((frame.map_from_camera->linear() * Vector3d::UnitZ()).isApprox(-Vector3d::UnitZ()));
  EXPECT_TRUE((frame.map_from_camera->linear() * Vector3d::UnitY()).isApprox(-Vector3d::UnitY()));
  EXPECT_DOUBLE_EQ(frame.map_from_camera->translation().z(), 3);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(1, 1), 1.5);
  write("transforms.json", head + R"({"file_path": "images/1.jpg", "depth_file_path": "../../etc/1.png",
      "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})");
  EXPECT_THAT(refusal(root_), HasSubstr("outside of the folder"));
  write("transforms.json", head + R"({"file_path": "images/1.jpg"}]})");
  EXPECT_THAT(refusal(root_), HasSubstr("names no depth images"));
  const auto with_model = [&](const std::string& model) {
    write("transforms.json",
          R"({"fl_x": 60, "fl_y": 62, "cx": 32, "cy": 24, "w": 64, "h": 48, "camera_model": ")" + model +
              R"(", "frames": [{"file_path": "images/1.jpg", "depth_file_path": "depth/1.png", "k1": 0.1,
                 "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})");
  };
  with_model("FISHEYE624");
  EXPECT_THAT(refusal(root_), HasSubstr("camera_model FISHEYE624 is not read"));
  with_model("SIMPLE_RADIAL");
  EXPECT_THAT(open_as_is(root_)->info().guesses, Contains(HasSubstr("are undistorted")))
      << "distortion may stand in the frames";
}

TEST_F(Formats, FramesOfAPhoneMayHaveCamerasOfTheirOwn) {
  std::string frames;
  for (const int i : {1, 2}) {
    const std::string name = std::to_string(i);
    cv::Mat color(kHeight, kWidth, CV_8UC3, cv::Scalar::all(0));
    color(cv::Rect(i == 1 ? 40 : 44, 0, kWidth, kHeight) & cv::Rect(0, 0, kWidth, kHeight)).setTo(255);
    make_folder(root_ / "images");
    write_image(root_ / ("images/" + name + ".png"), color);
    write_depth("depth/" + name + ".png", 1500);
    frames +=
        (i == 1 ? "" : ",") + fmt::format(R"({{"fl_x": {}, "fl_y": 60, "cx": 32, "cy": 24, "w": 64, "h": 48,
                "file_path": "images/{}.png", "depth_file_path": "depth/{}.png",
                "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}})",
                                          i == 1 ? 60 : 90, i, i);
  }
  write("transforms.json", R"({"frames": [)" + frames + "]}");
  const auto recording = open_as_is(root_);
  EXPECT_DOUBLE_EQ(recording->frame(1).camera.color.fx, 60);
  // The edge at 44 with f 90 is at 31.5 + 12.5 / 90 * 60 = 39.8 with f 60, as that of the first frame.
  for (const size_t i : {0U, 1U}) {
    const cv::Mat color = recording->frame(i).color;
    EXPECT_LT(color.at<cv::Vec3b>(20, 38)[0], 20) << i;
    EXPECT_GT(color.at<cv::Vec3b>(20, 41)[0], 235) << i;
  }
  EXPECT_FLOAT_EQ(recording->frame(1).depth.at<float>(20, 30), 1.5F);
}

TEST_F(Formats, FloatingPointDepthIsConvertedInAUnitOfItsOwn) {
  make_folder(root_ / "phone/depth");
  const std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (48, 64), }";
  std::string npy = std::string("\x93NUMPY\x01\x00", 8) + '\x76' + '\0' + head;
  npy.resize(127, ' ');
  npy += '\n';
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const float metres = 1.2346F;
    npy.append(reinterpret_cast<const char*>(&metres), sizeof metres);
  }
  write("phone/depth/1.npy", npy);
  write_color("phone/images/1.jpg");
  write("phone/transforms.json", R"({"fl_x": 60, "fl_y": 62, "cx": 32, "cy": 24, "w": 64, "h": 48,
      "depth_unit_scale_factor": 1.0, "frames": [{"file_path": "images/1.jpg", "depth_file_path": "depth/1.npy",
      "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})");
  NoProgress progress;
  convert_recording(*open_as_is(root_ / "phone"), root_ / "out", {.inputs = {}}, progress);
  EXPECT_NEAR(open_as_is(root_ / "out")->frame(0).depth.at<float>(3, 3), 1.2346, 1.5e-4);
}

TEST_F(Formats, JsonOfAnotherTypeIsRefused) {
  write_depth("depth/1.png", 1500);
  write_color("color/1.jpg");
  const auto refusal_of = [&](const std::string& name, const std::string& json) {
    write(name, json);
    const std::string text = refusal(root_);
    fs::remove(root_ / name);
    return text;
  };
  const std::string frames = R"("frames": [{"depth_file_path": "depth/1.png", "file_path": "color/1.jpg",
      "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})";
  const std::string camera = R"({"fl_x": 60, "fl_y": 62, "cx": 32, "cy": 24, "h": 48, )";
  EXPECT_THAT(refusal_of("transforms.json", "[]"), HasSubstr("'frames' is a list"));
  EXPECT_THAT(refusal_of("transforms.json", camera + R"("w": 1e300, )" + frames),
              HasSubstr("positive sizes"));
  EXPECT_THAT(refusal_of("transforms.json", camera + R"("w": 64, "camera_model": 7, )" + frames),
              HasSubstr("the camera model is not a name"));
  const std::string matrix = R"("intrinsic_matrix": [60, 0, 0, 0, 60, 0, 32, 24, 1]})";
  EXPECT_THAT(refusal_of("camera_intrinsic.json", R"({"width": "wide", )" + matrix),
              HasSubstr("positive sizes"));
  EXPECT_THAT(refusal_of("camera_intrinsic.json", R"({"width": 1e300, )" + matrix),
              HasSubstr("positive sizes"));
  write("camera_intrinsic.json", "[]");
  EXPECT_THAT(open_as_is(root_)->info().problems, Contains(HasSubstr("has no intrinsic_matrix")));
}

// Stray Scanner
// ----------------------------------------------------------------------------------------------

TEST_F(Formats, StrayScannerLeavesOutDepthOfLowConfidence) {
  write_depth("depth/000000.png", 1200, 32, 24);
  make_folder(root_ / "confidence");
  cv::Mat confidence(24, 32, CV_8UC1, cv::Scalar(2));
  confidence.at<uint8_t>(3, 4) = 0;
  write_image(root_ / "confidence/000000.png", confidence);
  write("camera_matrix.csv", "1600.0,0.0,960.0\n0.0,1600.0,720.0\n0.0,0.0,1.0\n");
  write("odometry.csv",
        "timestamp, frame, x, y, z, qx, qy, qz, qw\n 75.5, 000000, 0.1, 1.4, 0.3, 0, 0, 0, 1\n");
  const auto recording = open_recording(root_);
  EXPECT_EQ(recording->info().format, "stray-scanner");
  EXPECT_NEAR(recording->info().camera.depth.fx, 1600.0 * 32 / 1920, 1e-9);
  const RgbdFrame frame = recording->frame(0);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(1, 1), 1.2F);
  EXPECT_TRUE(std::isnan(frame.depth.at<float>(3, 4)));
  EXPECT_NEAR(frame.map_from_camera->translation().z(), 1.4, 1e-9);  // y was up
  write("odometry.csv",
        "timestamp, frame, x, y, z, qx, qy, qz, qw\n now, 000000, 0.1, 1.4, 0.3, 0, 0, 0, 1\n");
  EXPECT_THAT(refusal(root_), HasSubstr("odometry.csv:2"));
}

// ScanNet
// ----------------------------------------------------------------------------------------------------

class Sens : public Formats {
 protected:
  template <typename T>
  static void put(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  static void put_matrix(std::string& bytes, float f, float x) {
    for (int i = 0; i < 16; ++i)
      put(bytes, i % 5 == 0 && i < 10 ? f
                 : i == 3             ? x
                 : i % 5 == 0         ? 1.0F
                 : i == 2 || i == 6   ? 16.0F * (f > 1)
                                      : 0.0F);
  }
  /// A stream of two frames of depth 2 m, the second one lost.
  static std::string stream() {
    std::string bytes;
    put(bytes, uint32_t{4});
    put(bytes, uint64_t{5});
    bytes += "Kinec";
    put_matrix(bytes, 30, 0);
    put_matrix(bytes, 1, 0);
    put_matrix(bytes, 31, 0);
    put_matrix(bytes, 1, 0);
    put(bytes, int32_t{1});
    put(bytes, int32_t{1});
    for (const uint32_t side : {32U, 24U, 32U, 24U}) put(bytes, side);
    put(bytes, 1000.0F);
    put(bytes, uint64_t{2});
    const std::vector<unsigned char> png =
        encode_image(cv::Mat(24, 32, CV_8UC3, cv::Scalar(1, 2, 3)), ".png");
    const std::vector<uint16_t> raw(32 * 24, 2000);
    std::vector<Bytef> packed(compressBound(2 * 32 * 24));
    uLongf size = packed.size();
    compress(packed.data(), &size, reinterpret_cast<const Bytef*>(raw.data()), 2 * 32 * 24);
    for (int i = 0; i < 2; ++i) {
      if (i == 0)
        put_matrix(bytes, 1, 0.7F);
      else
        for (int k = 0; k < 16; ++k) put(bytes, -std::numeric_limits<float>::infinity());
      put(bytes, uint64_t{33333});
      put(bytes, static_cast<uint64_t>(33333 * (i + 1)));
      put(bytes, uint64_t{png.size()});
      put(bytes, uint64_t{size});
      bytes.append(png.begin(), png.end());
      bytes.append(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return bytes;
  }
};

TEST_F(Sens, GivesImagesPosesAndStamps) {
  write("scene.sens", stream());
  const auto recording = open_as_is(root_ / "scene.sens");
  EXPECT_EQ(recording->info().format, "scannet");
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.fx, 31);
  EXPECT_DOUBLE_EQ(recording->info().camera.color.cx, 16);
  ASSERT_EQ(recording->size(), 2U);
  const RgbdFrame frame = recording->frame(0);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(3, 3), 2);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(3, 3), cv::Vec3b(1, 2, 3));
  EXPECT_NEAR(frame.map_from_camera->translation().x(), 0.7, 1e-6);
  EXPECT_FALSE(recording->frame(1).map_from_camera);
  EXPECT_EQ(recording->time_of(1) - recording->time_of(0), 33333000);
}

TEST_F(Sens, ColourMayBeRaw) {
  std::string bytes = stream();
  const std::string matrices(4 * 16 * sizeof(float), '\0');
  const size_t color_kind = 4 + 8 + 5 + matrices.size();
  bytes[color_kind] = 0;
  const size_t frame = color_kind + 2 * 4 + 4 * 4 + 4 + 8, sizes = frame + 16 * 4 + 2 * 8;
  uint64_t png = 0;
  std::memcpy(&png, bytes.data() + sizes, sizeof png);
  std::string raw;
  for (int i = 0; i < 32 * 24; ++i) raw += "\3\2\1";  // red first
  const uint64_t size = raw.size();
  std::memcpy(bytes.data() + sizes, &size, sizeof size);
  bytes.replace(sizes + 2 * sizeof size, png, raw);
  write("raw.sens", bytes);
  EXPECT_EQ(open_as_is(root_ / "raw.sens")->frame(0).color.at<cv::Vec3b>(3, 3), cv::Vec3b(1, 2, 3));
}

TEST_F(Sens, TruncatedGivesWhatIsWholeAndLiesAreRefused) {
  const std::string whole = stream();
  write("scene.sens", whole.substr(0, whole.size() - 10));
  EXPECT_THAT(open_as_is(root_ / "scene.sens")->info().problems,
              Contains(HasSubstr("1 of 2 frames are whole")));
  for (size_t size = 4; size < whole.size() / 2; size += 97) {
    write("scene.sens", whole.substr(0, size));
    EXPECT_THAT(refusal(root_ / "scene.sens"), HasSubstr("scene.sens"));
  }
  std::string damaged = whole;
  std::memset(damaged.data() + damaged.size() - 12, 0xff, 12);
  write("scene.sens", damaged);
  EXPECT_THAT(open_as_is(root_ / "scene.sens")->frame(1).damage, HasSubstr("scene.sens"));
  std::string lie = whole;
  std::memset(lie.data() + 4, 0xff, 8);
  write("scene.sens", lie);
  EXPECT_THAT(refusal(root_ / "scene.sens"), HasSubstr("too long"));
}

// What is known and not read
// ---------------------------------------------------------------------------------

TEST_F(Formats, ForeignFormatsAreRefusedWithTheCommandThatConvertsThem) {
  write("a.mkv", "\x1a\x45\xdf\xa3 and so on");
  EXPECT_THAT(refusal(root_ / "a.mkv"), HasSubstr("azure_kinect_mkv_reader.py --input"));
  write("a.r3d", "PK\3\4");
  EXPECT_THAT(refusal(root_ / "a.r3d"), HasSubstr("ns-process-data record3d"));
  write("a.zip", "PK\3\4");
  EXPECT_THAT(refusal(root_ / "a.zip"), HasSubstr("unzip"));
  write("a.tar.zst", "\x28\xb5\x2f\xfd");
  EXPECT_THAT(refusal(root_ / "a.tar.zst"), HasSubstr("zstd -d"));
  write("a.tar.gz", "\x1f\x8b\x08\x01");
  EXPECT_THAT(refusal(root_ / "a.tar.gz"), HasSubstr("tar xzf"));
  const std::vector<std::array<const char*, 3>> table = {
      {"a.svo2", "", "svo_export.py --mode 4 --input_svo_file"},
      {"a.oni", "NI10", "pcl_oni2pcd"},
      {"a.klg", "\1", "depth.txt and rgb.txt"},
      {"a.xef", "EVENTS1", "KinectXEFTools"},
      {"map.db", "SQLite format 3", "rtabmap-export --images"},
      {"a.ply", "ply\nformat", "pcl_ply2pcd"},
      {"a.MP4", "ftyp", "a video alone has no depth"},
      {"a.e57", "ASTM-E57", "loci-map interpret takes scans as PCD"},
      {"a.npz", "PK\3\4", "numpy.save"},
      {"a.tar.bz2", "BZh9", "tar xjf"},
      {"a.tar.xz",
       "\xfd"
       "7zXZ",
       "tar xJf"},
      {"a.7z", "7z\xbc\xaf", "7z x"}};
  for (const auto& [name, bytes, text] : table) {
    write(std::string("folder/") + name, bytes + std::string("..."));
    EXPECT_THAT(refusal(root_ / "folder" / name), HasSubstr(text));
    EXPECT_THAT(refusal(root_ / "folder"), HasSubstr(text)) << "in a folder of nothing else";
    fs::remove_all(root_ / "folder");
  }
  write("a.mcap", "");
  EXPECT_THAT(refusal(root_ / "a.mcap"), HasSubstr("the file is empty"));
}

TEST_F(Formats, DepthImagesOfOtherKindsAreNamed) {
  write_color("color/0.png");
  write("depth/0.pfm", "Pf");
  EXPECT_THAT(refusal(root_), HasSubstr("0.pfm: depth as .pfm is not read; write"));
}

// Poses from elsewhere
// ---------------------------------------------------------------------------------------

class Poses : public Formats {
 protected:
  Poses() {
    RgbdCamera camera;
    camera.depth = camera.color = {kWidth, kHeight, 60, 60, 32, 24};
    camera.depth_from_color.translation().x() = 0.1;
    RecordingWriter writer(root_ / "rec", camera, "");
    for (int i = 0; i < 3; ++i) {
      RgbdFrame frame;
      frame.index = 5 + i;
      frame.time_ns = (100 + i) * kSecond;
      frame.depth = cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(1));
      writer.add(frame);
    }
    writer.finish();
  }
  Vector3d position(const Recording& recording, size_t i) const {
    return recording.frame(i).map_from_camera->translation();
  }
  std::unique_ptr<Recording> with(const std::string& text) const {
    write("poses.txt", text);
    return open_as_is(root_ / "rec", (root_ / "poses.txt").string());
  }
  std::string refusal_of(const std::string& text) const {
    try {
      with(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(Poses, OfTumAreTakenAtTheTimeOfTheFrame) {
  const auto recording = with("# stamp\n99.9 1 0 0 0 0 0 1\n100.1 2 0 0 0 0 0 1\n101 5 0 0 0 0 0 1\n");
  EXPECT_EQ(recording->info().frames_with_pose, 2U);
  EXPECT_NEAR(position(*recording, 0).x(), 1.5, 1e-9);
  EXPECT_NEAR(position(*recording, 1).x(), 5, 1e-9);
  EXPECT_FALSE(recording->frame(2).map_from_camera);
  EXPECT_THAT(recording->info().guesses, testing::Not(Contains(HasSubstr("no poses"))));
  EXPECT_THAT(refusal_of("1 1 0 0 0 0 0 1\n"), HasSubstr("no frame of the recording has a pose"));
}

TEST_F(Poses, OfKittiBelongToTheFramesInOrder) {
  const std::string row = "1 0 0 0.5 0 1 0 0 0 0 1 0\n";
  EXPECT_NEAR(position(*with(row + row + "1 0 0 7 0 1 0 0 0 0 1 0\n"), 2).x(), 7, 1e-9);
  EXPECT_THAT(refusal_of(row), HasSubstr("1 poses for 3 frames"));
}

TEST_F(Poses, OfG2oHaveTheIndexOfTheFrame) {
  const auto recording = with("VERTEX_SE3:QUAT 6 3 0 0 0 0 0 1\nEDGE_SE3:QUAT 5 6 1 0 0 0 0 0 1\n");
  EXPECT_FALSE(recording->frame(0).map_from_camera);
  EXPECT_NEAR(position(*recording, 1).x(), 3, 1e-9);
}

TEST_F(Poses, OfColmapAreOfTheColourCameraAndWorldToCamera) {
  const auto recording = with(
      "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, "
      "NAME\n"
      "1 1 0 0 0 -2 0 0 1 rgb/000006_color.png\n10.5 20.5 -1\n2 1 0 0 0 -4 0 0 1 rgb/000007_color.png\n\n");
  EXPECT_FALSE(recording->frame(0).map_from_camera);
  EXPECT_NEAR(position(*recording, 1).x(), 2 - 0.1, 1e-9);
  EXPECT_NEAR(position(*recording, 2).x(), 4 - 0.1, 1e-9);
}

TEST_F(Poses, OfColmapMayBelongToColourImagesWithNamesOrStampsOfTheirOwn) {
  const fs::path folder = root_ / "tum";
  std::string depths, colors;
  for (const std::string stamp : {"1700000001.100000", "1700000002.100000"}) {
    write_depth("tum/depth/" + stamp + ".png", 5000);
    write_color("tum/rgb/" + stamp + "_left.png");
    depths += stamp + " depth/" + stamp + ".png\n";
    colors += stamp + " rgb/" + stamp + "_left.png\n";
  }
  write("tum/depth.txt", depths);
  const auto position_by = [&](const std::string& image) {
    write("images.txt", "# IMAGE_ID\n1 1 0 0 0 -2 0 0 1 " + image + "\n\n");
    const auto recording = open_as_is(folder, (root_ / "images.txt").string());
    EXPECT_EQ(recording->info().frames_with_pose, 1U);
    return recording->frame(1).map_from_camera.value_or(Isometry3d::Identity()).translation().x();
  };
  EXPECT_DOUBLE_EQ(position_by("rgb/1700000002.104000.png"), 2)
      << "the digits behind the point are no number";
  write("tum/rgb.txt", colors);
  EXPECT_DOUBLE_EQ(position_by("rgb/1700000002.100000_left.png"), 2);
}

TEST_F(Poses, OfAnotherKindAreRefusedWithTheirLine) {
  EXPECT_THAT(refusal_of("hello world\n"), HasSubstr("poses.txt:1: no poses of a known format"));
  EXPECT_THAT(refusal_of("VERTEX_SE3:QUAT 6 3 0 0 0 0 x 1\n"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(refusal_of("VERTEX_SE3:QUAT 1e300 3 0 0 0 0 0 1\n"),
              HasSubstr("'1e300' is not a whole number"));
  EXPECT_THAT(refusal_of(""), HasSubstr("has no poses"));
}

// What is up: gravity_test.cpp
// ---------------------------------------------------------------------------------------------------

TEST_F(Formats, ATumFolderWhoseWorldHasYDownIsTurnedUpright) {
  const fs::path source = fs::path(LOCI_SHARED_DIR) / "data/redkitchen_rgbd";
  if (!fs::exists(source)) GTEST_SKIP() << "no shared data";
  NoProgress progress;
  const auto original = open_recording(source);
  convert_recording(*original, root_ / "tum", {.format = RecordingFormat::tum, .every = 20, .inputs = {}},
                    progress);
  const Isometry3d y_down(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()));
  std::string poses;
  for (size_t i = 0; i < original->size(); i += 20) {
    const TimeNs time = original->time_of(i);
    poses += fmt::format("{}.{:09}", time / kSecond, time % kSecond);
    for (const double value : values_from_pose(y_down * *original->frame(i).map_from_camera))
      poses += fmt::format(" {}", value);
    poses += "\n";
  }
  write("tum/groundtruth.txt", poses);
  const auto turned = open_recording(root_ / "tum");
  EXPECT_THAT(turned->info().guesses, Contains(HasSubstr("turned upright")));
  for (size_t i = 0; i < turned->size(); ++i) {
    const Isometry3d truth = *original->frame(20 * i).map_from_camera;
    const Vector3d up_in_camera = truth.linear().transpose() * Vector3d::UnitZ();
    EXPECT_GT((turned->frame(i).map_from_camera->linear() * up_in_camera).z(), 0.98);
  }
  RecordingOptions options;
  options.up = "-y";
  EXPECT_GT((open_recording(root_ / "tum", options)->frame(0).map_from_camera->linear() *
             original->frame(0).map_from_camera->linear().transpose() * Vector3d::UnitZ())
                .z(),
            0.9999);
  options.up = "keep";
  EXPECT_THAT(open_recording(root_ / "tum", options)->info().guesses,
              testing::Not(Contains(HasSubstr("turned upright"))));
}

// Convert
// ----------------------------------------------------------------------------------------------------

TEST_F(Formats, ConvertedRecordingsComeBackEqual) {
  const fs::path source = fs::path(LOCI_SHARED_DIR) / "data/ros2/redkitchen_ros2_db3";
  if (!fs::exists(source)) GTEST_SKIP() << "no shared data";
  const auto original = open_recording(source);
  NoProgress progress;
  for (const auto format : {RecordingFormat::loci, RecordingFormat::mcap, RecordingFormat::tum}) {
    const fs::path out =
        root_ / (format == RecordingFormat::mcap ? "copy.mcap" : std::to_string(int(format)));
    EXPECT_EQ(convert_recording(*original, out, {.format = format, .inputs = {source}}, progress).used(), 6U);
    const auto copy = open_recording(out);
    ASSERT_EQ(copy->size(), 6U);
    EXPECT_TRUE(
        copy->info().camera.depth_from_color.isApprox(original->info().camera.depth_from_color, 1e-9));
    for (const size_t i : {size_t{0}, size_t{5}}) {
      const RgbdFrame a = original->frame(i), b = copy->frame(i);
      EXPECT_EQ(a.time_ns, b.time_ns);
      EXPECT_EQ(a.camera.color, b.camera.color);
      EXPECT_LT((a.map_from_camera->matrix() - b.map_from_camera->matrix()).cwiseAbs().maxCoeff(), 1e-8);
      EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0);
      EXPECT_EQ(cv::countNonZero((a.depth == a.depth) != (b.depth == b.depth)), 0);
      cv::Mat difference = cv::abs(a.depth - b.depth);
      cv::patchNaNs(difference, 0);
      EXPECT_LT(cv::norm(difference, cv::NORM_INF), 1e-6);
      const std::string joint = "kitchen_drawer_1_joint";
      if (format != RecordingFormat::tum) {
        EXPECT_EQ(a.joints.at(joint), b.joints.at(joint));
      }
    }
  }
}

TEST_F(Formats, TimesThatWereMadeUpStaySoInEveryFormat) {
  for (const char* name : {"made_up/000000.depth.png", "made_up/000040.depth.png"})
    write_depth(name, 1500, 640, 480);
  const auto original = open_recording(root_ / "made_up");
  ASSERT_TRUE(original->info().time_assumed);
  NoProgress progress;
  for (const auto format : {RecordingFormat::loci, RecordingFormat::mcap, RecordingFormat::tum}) {
    const fs::path out =
        root_ / (format == RecordingFormat::mcap ? "copy.mcap" : std::to_string(int(format)));
    convert_recording(*original, out, {.format = format, .inputs = {root_ / "made_up"}}, progress);
    EXPECT_TRUE(open_recording(out)->info().time_assumed) << int(format);
    RecordingOptions options;
    options.start = "2026-05-01T08:30:00Z";
    EXPECT_EQ(format_time(open_recording(out, options)->time_of(0)), options.start) << int(format);
  }
}

TEST_F(Formats, ConvertNeverReplacesItsInputOrOtherPeoplesFiles) {
  write_depth("rec/depth/1.png", 1000, 640, 480);
  write_color("rec/color/1.png", 640, 480);
  std::ofstream(root_ / "precious.mcap") << "a thesis";
  const auto recording = open_recording(root_ / "rec");
  NoProgress progress;
  for (const auto format : {RecordingFormat::loci, RecordingFormat::tum})
    EXPECT_THROW(
        convert_recording(*recording, root_ / "rec", {.format = format, .inputs = {root_ / "rec"}}, progress),
        Error);
  EXPECT_THROW(convert_recording(*recording, root_ / "precious.mcap",
                                 {.format = RecordingFormat::mcap, .inputs = {}}, progress),
               Error);
  EXPECT_EQ(read_file(root_ / "precious.mcap"), "a thesis");
  EXPECT_EQ(open_recording(root_ / "rec")->size(), 1U);
}

}  // namespace
}  // namespace loci::mapping
