#include "mapping/recording/recording.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <functional>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

RgbdCamera small_camera() {
  RgbdCamera camera;
  camera.depth = {8, 6, 10, 10, 4, 3};
  camera.color = {8, 6, 9, 9, 4, 3};
  camera.depth_from_color.translation().x() = 0.022;
  return camera;
}

RgbdFrame small_frame(int64_t index) {
  RgbdFrame frame;
  frame.index = index;
  frame.time_ns = 1000 * kSecond + index * kSecond;
  frame.camera = small_camera();
  frame.depth = cv::Mat(6, 8, CV_32F, cv::Scalar(1.5));
  frame.depth.at<float>(2, 3) = std::numeric_limits<float>::quiet_NaN();
  frame.color = cv::Mat(6, 8, CV_8UC3, cv::Scalar(1, 2, 3));
  frame.map_from_camera = Isometry3d(Eigen::AngleAxisd(0.5, Vector3d::UnitX()));
  frame.map_from_camera->translation() << static_cast<double>(index), 0, 1;
  return frame;
}

class RecordingFiles : public testing::Test {
 protected:
  ~RecordingFiles() override { fs::remove_all(root_); }

  fs::path write_small(int frames = 3) {
    RecordingWriter writer(rec_, small_camera(), "map");
    for (int i = 0; i < frames; ++i) writer.add(small_frame(i));
    writer.finish();
    return rec_;
  }
  /// A 7-Scenes folder of three frames.
  void write_seven_scenes() {
    make_folder(rec_);
    for (int i : {0, 3, 7}) {
      const std::string stem = (rec_ / ("frame-00000" + std::to_string(i))).string();
      write_image(stem + ".depth.png", cv::Mat(480, 640, CV_16UC1, cv::Scalar(1500)));
      write_image(stem + ".color.png", cv::Mat(480, 640, CV_8UC3, cv::Scalar(9, 9, 9)));
      write_file_atomically(stem + ".pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    }
  }
  void replace_in(const char* file, const std::string& from, const std::string& to) {
    std::string text = read_file(rec_ / file);
    ASSERT_NE(text.find(from), std::string::npos);
    write_file_atomically(rec_ / file, text.replace(text.find(from), from.size(), to));
  }
  std::string refusal() {
    try {
      open_recording(rec_);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }

  fs::path root_ =
      fs::path(testing::TempDir()) /
      (std::string("recording_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path rec_ = root_ / "REC";
};

TEST_F(RecordingFiles, WrittenOnesComeBackEqual) {
  write_small();
  const auto recording = open_recording(rec_);
  EXPECT_EQ(recording->info().format, "loci");
  EXPECT_EQ(recording->info().map_frame, "map");
  EXPECT_EQ(recording->info().frames_with_pose, 3U);
  EXPECT_FALSE(recording->info().time_assumed);
  ASSERT_EQ(recording->size(), 3U);
  const RgbdFrame frame = recording->frame(2);
  const RgbdFrame expected = small_frame(2);
  EXPECT_EQ(frame.index, 2);
  EXPECT_EQ(frame.name, "000002");
  EXPECT_EQ(frame.time_ns, expected.time_ns);
  EXPECT_EQ(frame.camera.depth, expected.camera.depth);
  EXPECT_TRUE(frame.map_from_camera->isApprox(*expected.map_from_camera, 1e-8));
  EXPECT_TRUE(std::isnan(frame.depth.at<float>(2, 3)));
  EXPECT_FLOAT_EQ(frame.depth.at<float>(0, 0), 1.5F);
  EXPECT_EQ(cv::norm(frame.color, expected.color, cv::NORM_INF), 0);
}

TEST_F(RecordingFiles, UnfinishedWritingLeavesTheOldRecording) {
  write_small(3);
  {
    RecordingWriter writer(rec_, small_camera(), "map");
    writer.add(small_frame(0));
  }
  EXPECT_EQ(open_recording(rec_)->size(), 3U);
  write_small(2);
  EXPECT_EQ(open_recording(rec_)->size(), 2U);
  EXPECT_FALSE(fs::exists(rec_ / "frames/000002_depth.png"));
}

TEST_F(RecordingFiles, WriterRefusesFolderWithOtherThings) {
  make_folder(rec_);
  write_file_atomically(rec_ / "thesis.txt", "precious");
  EXPECT_THROW(RecordingWriter(rec_, small_camera(), "map"), Error);
}

TEST_F(RecordingFiles, OnlyARecordingIsReplacedByForce) {
  write_small(3);
  write_file_atomically(rec_ / "notes.txt", "mine");
  EXPECT_THROW(RecordingWriter(rec_, small_camera(), "map"), Error);
  {
    RecordingWriter writer(rec_, small_camera(), "map", {.force = true});
    writer.add(small_frame(0));
    writer.finish();
  }
  EXPECT_EQ(open_recording(rec_)->size(), 1U);
  make_folder(root_ / "home");
  write_file_atomically(root_ / "home/thesis.txt", "precious");
  EXPECT_THROW(RecordingWriter(root_ / "home", small_camera(), "map", {.force = true}), Error);
}

TEST_F(RecordingFiles, DepthAlongRaysIsTurnedIntoZ) {
  write_small();
  replace_in("recording.yaml", "depth_scale", "depth_along_rays: true\ndepth_scale");
  const cv::Mat depth = open_recording(rec_)->frame(0).depth;
  EXPECT_NEAR(depth.at<float>(3, 4), 1.5, 1e-6);  // The principal point.
  EXPECT_NEAR(depth.at<float>(0, 0), 1.5 / small_camera().depth.unproject(0, 0, 1).norm(), 1e-6);
  EXPECT_TRUE(std::isnan(depth.at<float>(2, 3)));
}

TEST_F(RecordingFiles, AClockThatIsSetBackGoesOn) {
  const auto with_seconds = [&](const std::vector<double>& seconds) {
    write_small();
    std::string rows = "index,time_ns,depth\n";
    for (size_t i = 0; i < seconds.size(); ++i)
      rows += fmt::format("{},{},frames/000000_depth.png\n", i,
                          static_cast<TimeNs>((1.7e9 + seconds[i]) * 10) * (kSecond / 10));
    write_file_atomically(rec_ / "frames.csv", rows);
    return open_recording(rec_);
  };
  const auto order = [](const Recording& recording) {
    std::vector<int64_t> indices;
    for (size_t i = 0; i < recording.size(); ++i) indices.push_back(recording.index_of(i));
    return indices;
  };
  const auto back = with_seconds({0, 0.5, 1, 1.5, 2, 2.5, 3, 1, 1.5, 2, 2.5, 3, 3.5, 4});
  EXPECT_THAT(order(*back), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13));
  EXPECT_EQ(back->time_of(7) - back->time_of(6), kSecond / 2);
  EXPECT_THAT(back->info().problems,
              testing::Contains(testing::AllOf(HasSubstr("frames.csv:9"), HasSubstr("goes back by 2.000 s"),
                                               HasSubstr("2.500 s are added"))));
  // By name: 1, 10, 11, 12, 2, 3 …
  const auto by_name = with_seconds({1, 10, 11, 12, 2, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_THAT(order(*by_name), testing::ElementsAre(0, 4, 5, 6, 7, 8, 9, 10, 11, 1, 2, 3));
  const auto swapped = with_seconds({0, 1, 3, 2, 4, 5});
  EXPECT_THAT(order(*swapped), testing::ElementsAre(0, 1, 3, 2, 4, 5));
}

TEST_F(RecordingFiles, WriterLeavesOtherPeoplesFilesAlone) {
  write_small();
  // Neighbours that only look as if they were ours.
  for (const char* name : {"REC.old", "REC.partial"}) {
    make_folder(root_ / name);
    write_file_atomically(root_ / name / "thesis.txt", "precious");
  }
  write_small(2);
  EXPECT_EQ(read_file(root_ / "REC.old/thesis.txt"), "precious");
  EXPECT_EQ(read_file(root_ / "REC.partial/thesis.txt"), "precious");
  // A file among ours.
  write_file_atomically(rec_ / "frames/notes.txt", "precious");
  EXPECT_THROW(write_small(), Error);
  EXPECT_EQ(read_file(rec_ / "frames/notes.txt"), "precious");
  fs::remove(rec_ / "frames/notes.txt");
  // What the command reads, under another name.
  fs::create_directory_symlink(rec_, root_ / "link");
  EXPECT_THROW(RecordingWriter(rec_, small_camera(), "map", {.inputs = {root_ / "link"}}), Error);
  EXPECT_EQ(open_recording(rec_)->size(), 2U);
  for (const auto& entry : fs::directory_iterator(root_))
    EXPECT_EQ(entry.path().string().find(".tmp"), std::string::npos) << entry.path();
}

TEST_F(RecordingFiles, ARecordingThatLociDidNotWriteIsNotReplaced) {
  write_small();
  fs::remove(rec_ / ".loci-recording");
  EXPECT_THROW(write_small(), Error);
  EXPECT_EQ(open_recording(rec_)->size(), 3U);
}

TEST_F(RecordingFiles, WhatNeverEndsIsNotRead) {
  write_small();
  const fs::path depth = rec_ / "frames/000000_depth.png";
  for (const bool pipe : {false, true}) {
    fs::remove(depth);
    if (pipe)
      ASSERT_EQ(::mkfifo(depth.c_str(), 0600), 0);
    else
      fs::create_symlink("/dev/zero", depth);
    const auto recording = open_recording(rec_);
    EXPECT_FALSE(recording->frame(0).damage.empty());
    EXPECT_TRUE(recording->frame(1).damage.empty());
  }
}

TEST_F(RecordingFiles, JointsAreTheLatestAtTheTimeOfTheFrame) {
  RecordingWriter writer(rec_, small_camera(), "map");
  for (int i = 0; i < 4; ++i) {
    RgbdFrame frame = small_frame(i);
    if (i == 1 || i == 2) frame.joints["drawer_1_joint"] = 0.3;
    writer.add(frame);
  }
  writer.finish();
  const auto recording = open_recording(rec_);
  EXPECT_TRUE(recording->frame(0).joints.empty());
  EXPECT_EQ(recording->frame(1).joints.at("drawer_1_joint"), 0.3);
  EXPECT_EQ(recording->frame(2).joints.at("drawer_1_joint"), 0.3);
  EXPECT_EQ(recording->frame(3).joints.at("drawer_1_joint"), 0);
}

TEST_F(RecordingFiles, EmptyPosesAreUnknown) {
  RecordingWriter writer(rec_, small_camera(), "map");
  RgbdFrame frame = small_frame(0);
  frame.map_from_camera.reset();
  writer.add(frame);
  writer.finish();
  const auto recording = open_recording(rec_);
  EXPECT_FALSE(recording->frame(0).map_from_camera.has_value());
  EXPECT_EQ(recording->info().map_frame, "");
}

TEST_F(RecordingFiles, WithoutStampsTimeComesFromTheNumberInTheName) {
  write_small();
  fs::rename(rec_ / "frames/000002_depth.png", rec_ / "frames/000032_depth.png");
  write_file_atomically(rec_ / "frames.csv", "depth\nframes/000000_depth.png\nframes/000032_depth.png\n");
  const auto recording = open_recording(rec_);
  EXPECT_TRUE(recording->info().time_assumed);
  EXPECT_EQ(format_time(recording->time_of(0)), "2000-01-01T00:00:00Z");
  EXPECT_EQ(format_time(recording->time_of(1)), "2000-01-01T00:00:01.066666666Z");
}

TEST_F(RecordingFiles, FewFramesWithoutStampsAreNoVideo) {
  write_small();
  write_file_atomically(rec_ / "frames.csv", "depth\nframes/000000_depth.png\nframes/000002_depth.png\n");
  const auto recording = open_recording(rec_);
  EXPECT_EQ(recording->time_of(1) - recording->time_of(0), 60 * kSecond);
  EXPECT_THAT(recording->info().guesses,
              testing::Contains(testing::AllOf(HasSubstr("a minute apart"), HasSubstr("--seconds-apart"))));
  RecordingOptions options;
  options.seconds_apart = 0.2;
  const auto faster = open_recording(rec_, options);
  EXPECT_EQ(faster->time_of(1) - faster->time_of(0), kSecond / 5);
  EXPECT_EQ(faster->frame(1).time_ns, faster->time_of(1));
  EXPECT_EQ(faster->info().last_time, faster->time_of(1));
  write_small();
  EXPECT_THROW(open_recording(rec_, options), Error) << "it has stamps";
}

TEST_F(RecordingFiles, AStartIsThatOfFramesWithoutStamps) {
  write_small();
  write_file_atomically(rec_ / "frames.csv", "depth\nframes/000000_depth.png\nframes/000002_depth.png\n");
  RecordingOptions options;
  options.start = "2026-05-01T08:30:00Z";
  options.seconds_apart = 0.2;
  const auto recording = open_recording(rec_, options);
  EXPECT_EQ(format_time(recording->info().first_time), options.start);
  EXPECT_EQ(format_time(recording->frame(1).time_ns), "2026-05-01T08:30:00.2Z");
  EXPECT_EQ(recording->info().last_time, recording->time_of(1));
  options.start = "3026-05-01T08:30:00Z";
  EXPECT_THROW(open_recording(rec_, options), Error) << "too far off";
  write_small();
  options = {};
  options.start = "2026-05-01T08:30:00Z";
  EXPECT_THROW(open_recording(rec_, options), Error) << "it has stamps";
}

TEST_F(RecordingFiles, FramesWithoutAStampGetOneBetweenTheirNeighbours) {
  const auto with_stamps = [&](const std::vector<std::string>& stamps) {
    write_small();
    std::string rows = "time_ns,depth\n";
    for (const std::string& stamp : stamps) rows += stamp + ",frames/000000_depth.png\n";
    write_file_atomically(rec_ / "frames.csv", rows);
  };
  const TimeNs begin = 1'700'000'000 * kSecond;
  const std::string first = std::to_string(begin), later = std::to_string(begin + 2 * kSecond);
  with_stamps({"", first, "", later, ""});
  const auto recording = open_recording(rec_);
  EXPECT_FALSE(recording->info().time_assumed);
  for (size_t i = 0; i < 5; ++i)
    EXPECT_EQ(recording->time_of(i), begin + (static_cast<TimeNs>(i) - 1) * kSecond);
  EXPECT_THAT(recording->info().problems,
              testing::Contains(
                  testing::AllOf(HasSubstr("3 of 5 frames have no time stamp"), HasSubstr("frames.csv:2"))));
  with_stamps({"", first, ""});
  EXPECT_THAT(refusal(), HasSubstr("only one frame has a time stamp"));
  with_stamps({later, "", first});
  EXPECT_THAT(refusal(), HasSubstr("frames.csv:4: the stamps go back here"));
}

TEST_F(RecordingFiles, StampsInAnotherUnitArePointedAt) {
  write_small();
  write_file_atomically(rec_ / "frames.csv",
                        "time_ns,depth\n1700000000000,frames/000000_depth.png\n"
                        "1700000000033,frames/000001_depth.png\n");
  EXPECT_THAT(open_recording(rec_)->info().problems,
              testing::Contains(HasSubstr("the stamps look like milliseconds, multiply them by 1000000")));
}

TEST_F(RecordingFiles, FramesThatWereLostHaveNoPose) {
  write_small();
  write_file_atomically(rec_ / "frames.csv",
                        "\xef\xbb\xbfindex,time_ns,depth,x,y,z,qx,qy,qz,qw\n"
                        "0,1000000000,frames/000000_depth.png,nan,0,0,0,0,0,1\n"
                        "1,2000000000,frames/000001_depth.png,0,0,0,0,0,0,0\n"
                        "2,3000000000,frames/000002_depth.png,1,0,0,0,0,0,1\n");
  const auto recording = open_recording(rec_);
  EXPECT_EQ(recording->info().frames_with_pose, 1U);
  EXPECT_TRUE(recording->frame(2).map_from_camera);
  EXPECT_THAT(recording->info().problems,
              testing::Contains(testing::AllOf(HasSubstr("2 of 3 frames have no pose, the first is"),
                                               HasSubstr("frames.csv:2"))));
}

TEST_F(RecordingFiles, MissingAndEmptyFoldersAreRefused) {
  EXPECT_THAT(refusal(), HasSubstr("no such recording"));
  make_folder(rec_);
  EXPECT_THAT(refusal(), HasSubstr("the folder is empty"));
  write_small();
  fs::rename(rec_, root_ / "inner");
  rec_ = root_;
  EXPECT_THAT(refusal(), HasSubstr("inner'?"));
}

TEST_F(RecordingFiles, BadRowsAreRefusedWithTheirLine) {
  write_small();
  const std::string good = read_file(rec_ / "frames.csv");
  const auto with_row = [&](const std::string& row) {
    write_file_atomically(rec_ / "frames.csv", "index,time_ns,color,depth,x,y,z,qx,qy,qz,qw\n" + row + "\n");
    return refusal();
  };
  const std::string images = "0,1,frames/000000_color.png,frames/000000_depth.png,";
  EXPECT_THAT(with_row(images + "none,0,0,0,0,0,1"), HasSubstr("frames.csv:2"));
  EXPECT_THAT(with_row(images + "0,0,0,0.5,0,0,1"), HasSubstr("not of unit length"));
  EXPECT_THAT(with_row(images + "0,0,0,,,,"), HasSubstr("the pose is not complete"));
  EXPECT_THAT(with_row("0,-9223372036854775808,,frames/000000_depth.png,,,,,,,"),
              HasSubstr("frames.csv:2: the time stamp is too far off"));
  EXPECT_THAT(with_row("0,1,,frames/absent.png,,,,,,,"), HasSubstr("absent.png: no such file"));
  EXPECT_THAT(with_row("0,1,,frames/000000_color.png,,,,,,,"), HasSubstr("16-bit grey"));
  write_file_atomically(rec_ / "frames.csv", "index,time_ns,color,dpth\n");
  EXPECT_THAT(refusal(), HasSubstr("the column 'depth' is missing; did you mean 'dpth'?"));
  write_file_atomically(rec_ / "frames.csv", good.substr(0, good.find('\n') + 1));
  EXPECT_THAT(refusal(), HasSubstr("has no frames"));
}

TEST_F(RecordingFiles, SlightlyLongQuaternionIsNormalised) {
  write_small();
  write_file_atomically(rec_ / "frames.csv",
                        "index,time_ns,color,depth,x,y,z,qx,qy,qz,qw\n"
                        "0,1,,frames/000000_depth.png,0,0,0,0,0,0,1.005\n");
  EXPECT_TRUE(open_recording(rec_)->frame(0).map_from_camera->linear().isIdentity(1e-12));
}

TEST_F(RecordingFiles, ATruncatedImageIsNamedWhenOpeningAndCostsItsFrameOnly) {
  write_small();
  const fs::path image = rec_ / "frames/000001_depth.png";
  const std::string bytes = read_file(image);
  write_file_atomically(image, bytes.substr(0, bytes.size() / 2));
  const auto recording = open_recording(rec_);
  EXPECT_THAT(recording->info().problems,
              testing::ElementsAre(testing::AllOf(HasSubstr("1 of 3 frames have images that cannot be read"),
                                                  HasSubstr("000001_depth.png: the image is truncated"))));
  EXPECT_THAT(recording->frame(1).damage, HasSubstr("000001_depth.png: the image is truncated"));
  EXPECT_FALSE(has_depth(recording->frame(1)));
  EXPECT_FALSE(recording->frame(1).color.empty());
  EXPECT_TRUE(recording->frame(2).damage.empty());
  for (const char* name : {"000000", "000002"})
    fs::remove(rec_ / "frames" / (std::string(name) + "_depth.png"));
  EXPECT_THAT(refusal(), HasSubstr("000000_depth.png: no such file"));
}

TEST_F(RecordingFiles, AnImageThatBreaksLaterIsNamedWithItsFrame) {
  write_small();
  const auto recording = open_recording(rec_);
  fs::remove(rec_ / "frames/000001_color.png");
  const RgbdFrame frame = recording->frame(1);
  EXPECT_THAT(frame.damage, HasSubstr("000001_color.png"));
  EXPECT_TRUE(frame.color.empty());
  EXPECT_TRUE(has_depth(frame));
}

TEST_F(RecordingFiles, DepthThatNoRoomHasIsPointedAt) {
  write_small();
  replace_in("recording.yaml", "depth_scale: 0.001", "depth_scale: 0.01");
  EXPECT_THAT(open_recording(rec_)->info().problems,
              testing::Contains(HasSubstr("the median depth of the first frame is 15 m: check its unit")));
}

TEST_F(RecordingFiles, ImagesOfAnotherSizeDoNotBelong) {
  write_small();
  write_image(rec_ / "frames/000001_color.png", cv::Mat(12, 16, CV_8UC3, cv::Scalar(0, 0, 0)));
  EXPECT_THAT(refusal(), HasSubstr("16 x 12, the colour camera 8 x 6"));
}

TEST_F(RecordingFiles, DescriptionIsReadStrictly) {
  write_small();
  replace_in("recording.yaml", "depth_scale", "depth_scal");
  EXPECT_THAT(refusal(), HasSubstr("unknown key 'depth_scal'; did you mean 'depth_scale'?"));
  write_small();
  replace_in("recording.yaml", "cx:", "cxx:");
  EXPECT_THAT(refusal(), HasSubstr("unknown key 'cxx'; did you mean 'cx'?"));
}

TEST_F(RecordingFiles, SevenScenesWithoutDescriptionIsAKinect) {
  write_seven_scenes();
  const auto recording = open_recording(rec_);
  EXPECT_EQ(recording->info().format, "7-scenes");
  EXPECT_EQ(recording->info().camera.color.fx, 528);
  EXPECT_EQ(recording->info().map_frame, "world");
  EXPECT_THAT(recording->info().guesses, testing::Contains(HasSubstr("Kinect")));
  EXPECT_EQ(recording->time_of(1) - recording->time_of(0), 60 * kSecond);
}

TEST_F(RecordingFiles, ADescribedCameraHasNotTheBaselineOfTheOneThatWasAssumed) {
  write_seven_scenes();
  EXPECT_NEAR(open_recording(rec_)->info().camera.depth_from_color.translation().x(), 0.022, 0.01);
  const std::string camera = "{width: 640, height: 480, fx: 600, fy: 600, cx: 320, cy: 240}";
  for (const std::string& text : {"depth: " + camera, "depth: " + camera + "\ncolor: " + camera}) {
    write_file_atomically(rec_ / "cameras.yaml", text + "\n");
    const auto recording = open_recording(rec_);
    EXPECT_TRUE(recording->info().camera.depth_from_color.isApprox(Isometry3d::Identity()));
    EXPECT_THAT(recording->info().guesses, testing::Contains(HasSubstr("colour is taken as")));
  }
  write_file_atomically(rec_ / "cameras.yaml", "depth: {unit_m: 0.001}\n");
  EXPECT_NEAR(open_recording(rec_)->info().camera.depth_from_color.translation().x(), 0.022, 0.01);
}

TEST_F(RecordingFiles, ImagesThatDoNotFitAnAssumedCameraSayHowToDescribeIt) {
  make_folder(rec_);
  write_image(rec_ / "frame-000000.depth.png", cv::Mat(720, 1280, CV_16UC1, cv::Scalar(1500)));
  EXPECT_THAT(refusal(),
              HasSubstr("write a cameras.yaml beside the images: 'depth: {width: 1280, height: 720"));
}

TEST_F(RecordingFiles, APartOfSevenScenesThatIsMissingCostsItsFrameOnly) {
  write_seven_scenes();
  fs::remove(rec_ / "frame-000000.pose.txt");
  fs::remove(rec_ / "frame-000003.color.png");
  fs::remove(rec_ / "frame-000007.depth.png");
  write_file_atomically(rec_ / "._frame-000009.depth.png", "of macOS");
  const auto recording = open_recording(rec_);
  ASSERT_EQ(recording->size(), 2U);
  EXPECT_FALSE(recording->frame(0).map_from_camera);
  EXPECT_TRUE(recording->frame(1).map_from_camera);
  EXPECT_TRUE(recording->frame(1).color.empty());
  const auto one_names = [](const char* what, const char* frame) {
    return testing::Contains(testing::AllOf(HasSubstr(what), HasSubstr(frame)));
  };
  const std::vector<std::string>& problems = recording->info().problems;
  EXPECT_THAT(problems, one_names("1 of 2 frames have no pose", "frame-000000"));
  EXPECT_THAT(problems, one_names("1 of 2 frames have no colour", "frame-000003"));
  EXPECT_THAT(problems, one_names("1 of 3 frames have no depth image", "frame-000007"));
}

TEST_F(RecordingFiles, SevenScenesPartsMustBelongTogether) {
  write_seven_scenes();
  for (const int i : {0, 3, 7})
    fs::rename(rec_ / fmt::format("frame-{:06}.color.png", i),
               rec_ / fmt::format("image-{:06}.color.png", i));
  EXPECT_THAT(refusal(), HasSubstr("do not belong together"));
}

TEST_F(RecordingFiles, StampsInNamesAreSecondsWithDecimals) {
  for (const char* stamp : {"1700000001.166667", "1700000000.900000", "1700000009.000001"}) {
    make_folder(rec_);
    write_image(rec_ / (std::string(stamp) + ".depth.png"), cv::Mat(480, 640, CV_16UC1, cv::Scalar(1500)));
  }
  const auto recording = open_recording(rec_);
  EXPECT_FALSE(recording->info().time_assumed);
  EXPECT_EQ(recording->name_of(0), "1700000000.900000");
  EXPECT_EQ(recording->time_of(1), 1'700'000'001'166'667'000);
  EXPECT_EQ(recording->time_of(2), 1'700'000'009'000'001'000);
  EXPECT_THAT(recording->info().problems, testing::Not(testing::Contains(HasSubstr("go back"))));
}

TEST_F(RecordingFiles, SevenScenesPosesAreChecked) {
  const auto with_pose = [&](const std::string& text) {
    write_seven_scenes();
    write_file_atomically(rec_ / "frame-000003.pose.txt", text);
    return refusal();
  };
  EXPECT_EQ(with_pose("1.004 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), "no error");
  EXPECT_THAT(with_pose("1.1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), HasSubstr("not orthonormal"));
  EXPECT_EQ(with_pose("nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), "no error");
  EXPECT_THAT(with_pose("1 0 0 0\n0 1 0 0\n"),
              HasSubstr("000003.pose.txt: a pose is 16 numbers, this file has 8"));
}

TEST(SharedRecordings, RedkitchenIsEqualInBothLayouts) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/redkitchen_rgbd";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data";
  const auto own = open_recording(folder);
  const auto seven = open_recording(folder / "frames");
  EXPECT_EQ(own->info().format, "loci");
  EXPECT_EQ(seven->info().format, "7-scenes");
  EXPECT_EQ(own->info().map_frame, seven->info().map_frame);
  EXPECT_EQ(own->info().camera.color, seven->info().camera.color);
  EXPECT_TRUE(own->info().camera.depth_from_color.isApprox(seven->info().camera.depth_from_color, 1e-12));
  ASSERT_EQ(own->size(), 160U);
  ASSERT_EQ(seven->size(), 160U);
  for (size_t i = 0; i < own->size(); ++i) {
    EXPECT_EQ(own->time_of(i), seven->time_of(i));
    EXPECT_EQ(own->index_of(i), seven->index_of(i));
    if (i % 20 != 0 && i != 26) continue;  // 26 is original frame 163, the first with 65535.
    const RgbdFrame a = own->frame(i);
    const RgbdFrame b = seven->frame(i);
    EXPECT_EQ(a.name, b.name);
    EXPECT_LT((a.map_from_camera->matrix() - b.map_from_camera->matrix()).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0);
    EXPECT_EQ(cv::countNonZero(a.depth != b.depth), cv::countNonZero(a.depth != a.depth));  // NaN differs.
    EXPECT_EQ(cv::countNonZero((a.depth == a.depth) != (b.depth == b.depth)), 0);
    double largest = 0;
    cv::minMaxLoc(a.depth, nullptr, &largest, nullptr, nullptr, a.depth == a.depth);
    EXPECT_LT(largest, 4.0);
  }
}

TEST(SharedRecordings, OsdChangesHasAFixedCamera) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/osd_changes";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data";
  const auto recording = open_recording(folder);
  EXPECT_EQ(recording->size(), 10U);
  EXPECT_EQ(recording->info().map_frame, "table");
  EXPECT_TRUE(recording->info().time_assumed);
  EXPECT_EQ(recording->frame(3).name, "learn36");
  EXPECT_EQ(recording->time_of(1) - recording->time_of(0), 60 * kSecond);
}

}  // namespace
}  // namespace loci::mapping
