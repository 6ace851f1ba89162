#include "mapping/recording/pose_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "mapping/base/math/math.h"
#include "mapping/recording/gravity.h"
#include "mapping/recording/posed_recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A kitchen whose poses are changed.
class PoseCheck : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(folder_)) GTEST_SKIP() << "no shared data";
  }
  template <class Change>
  std::unique_ptr<Recording> with(const Change& change) const {
    auto recording = open_recording(folder_);
    std::vector<std::optional<Isometry3d>> poses;
    for (size_t i = 0; i < recording->size(); ++i) poses.push_back(recording->pose_of(i));
    for (auto& pose : poses) change(*pose);
    return with_poses(std::move(recording), poses, "world", true);
  }

  fs::path folder_ = fs::path(LOCI_SHARED_DIR) / "data/redkitchen_rgbd/frames";
};

TEST_F(PoseCheck, PosesThatFitRaiseNoDoubt) {
  const PoseAgreement agreement = check_poses(*open_recording(folder_));
  EXPECT_GT(agreement.compared, 2000U);
  EXPECT_TRUE(agreement.fits()) << agreement.text();
}

TEST_F(PoseCheck, TheCauseOfPosesThatDoNotFitIsNamed) {
  EXPECT_THAT(check_poses(*with([](Isometry3d& pose) { pose = pose.inverse(); })).text(),
              HasSubstr("if they are from the world to the camera"));
  EXPECT_THAT(check_poses(*with([](Isometry3d& pose) { pose.translation() *= 1000; })).text(),
              HasSubstr("in millimetres"));
  EXPECT_THAT(check_poses(*with([](Isometry3d& pose) {
                const Eigen::Quaterniond q(pose.linear());  // x y z w are read from w x y z.
                pose.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
              })).text(),
              HasSubstr("qw before qx qy qz"));
  EXPECT_THAT(check_poses(*with([](Isometry3d& pose) {
                const Eigen::Matrix3d camera_from_body{{0, -1, 0}, {0, 0, -1}, {1, 0, 0}};
                pose.linear() = pose.linear() * camera_from_body;
              })).text(),
              HasSubstr("of a body with x forward and z up"));
}

TEST_F(PoseCheck, TheCauseIsNamedAlsoWherePosesWereTurnedUpright) {
  const Isometry3d turn(Eigen::AngleAxisd(1.2, Vector3d(0.8, 0, 0.6)));
  EXPECT_THAT(
      check_poses(*in_frame(with([](Isometry3d& pose) { pose = pose.inverse(); }), turn, "map")).text(),
      HasSubstr("if they are from the world to the camera"));
}

TEST_F(PoseCheck, TheUnitOfDepthIsNamedWithTheKeyOfTheLayout) {
  const std::string text = check_poses(*with([](Isometry3d& pose) { pose.translation() *= 0.25; })).text();
  EXPECT_THAT(text, HasSubstr("depth is 1/4 of what is read"));
  EXPECT_THAT(text, HasSubstr("unit_m: 0.00025"));
}

/// A recording whose depth and depth camera are changed.
class ChangedDepth : public Recording {
 public:
  using Change = std::function<void(cv::Mat& depth, const PinholeCamera& camera)>;
  ChangedDepth(std::unique_ptr<Recording> recording, Change change, double focal_factor = 1)
      : recording_(std::move(recording)), info_(recording_->info()), change_(std::move(change)) {
    info_.camera.depth.fx *= focal_factor;
    info_.camera.depth.fy *= focal_factor;
  }
  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return recording_->size(); }
  std::optional<Isometry3d> pose_of(size_t i) const override { return recording_->pose_of(i); }
  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame = recording_->frame(i);
    if (change_) change_(frame.depth, frame.camera.depth);
    frame.camera = info_.camera;
    return frame;
  }
  TimeNs time_of(size_t i) const override { return recording_->time_of(i); }
  int64_t index_of(size_t i) const override { return recording_->index_of(i); }

 private:
  std::unique_ptr<Recording> recording_;
  RecordingInfo info_;
  Change change_;
};

TEST_F(PoseCheck, AWrongFocalLengthIsNamedWithTheRightOne) {
  for (const double factor : {0.8, 0.9, 1.2}) {
    const PoseAgreement agreement = check_poses(ChangedDepth(open_recording(folder_), {}, factor));
    EXPECT_THAT(agreement.cause, HasSubstr("the focal length is")) << factor;
    const size_t at = agreement.hint.find("fx: ");
    ASSERT_NE(at, std::string::npos) << agreement.hint;
    EXPECT_NEAR(std::stod(agreement.hint.substr(at + 4)), 585, 9) << factor;
    EXPECT_THAT(agreement.hint, HasSubstr("cameras.yaml"));
  }
}

TEST_F(PoseCheck, DistancesAlongRaysAndMirroredImagesAreNamed) {
  const ChangedDepth along_rays(open_recording(folder_), [](cv::Mat& depth, const PinholeCamera& camera) {
    for (int v = 0; v < depth.rows; ++v)
      for (int u = 0; u < depth.cols; ++u)
        depth.at<float>(v, u) *= static_cast<float>(camera.unproject(u, v, 1).norm());
  });
  EXPECT_THAT(check_poses(along_rays).text(), HasSubstr("'depth: {along_rays: true}'"));
  const ChangedDepth mirrored(open_recording(folder_), [](cv::Mat& depth, const PinholeCamera&) {
    cv::flip(depth.clone(), depth, 1);
  });
  EXPECT_THAT(check_poses(mirrored).text(), HasSubstr("the images are mirrored"));
}

TEST_F(PoseCheck, FramesWithoutDepthAreNamed) {
  EXPECT_FALSE(missing_depth(*open_recording(folder_)));
  const ChangedDepth blind(open_recording(folder_),
                           [](cv::Mat& depth, const PinholeCamera&) { depth.setTo(0); });
  EXPECT_THAT(problems_of(blind, {}), testing::Contains(HasSubstr("12 of 12 frames that were looked at")));
}

TEST_F(PoseCheck, AHeightThatNoRoomHasIsNamed) {
  EXPECT_FALSE(implausible_height(*open_recording(folder_)));
  const ChangedDepth large(open_recording(folder_),
                           [](cv::Mat& depth, const PinholeCamera&) { depth *= 10; });
  EXPECT_THAT(implausible_height(large).value_or(""), HasSubstr("unit_m in cameras.yaml"));
}

TEST_F(PoseCheck, LatePosesOfAVideoAreNamedWithTheirDelay) {
  const auto late_by = [](size_t shift) {
    auto recording = open_recording(fs::path(LOCI_SHARED_DIR) / "data/redkitchen_30hz/frames");
    std::vector<std::optional<Isometry3d>> poses;
    for (size_t i = 0; i < recording->size(); ++i)
      poses.push_back(recording->pose_of(i < shift ? 0 : i - shift));
    return check_poses(*with_poses(std::move(recording), poses, "world", true));
  };
  EXPECT_TRUE(late_by(0).fits()) << late_by(0).text();
  EXPECT_THAT(late_by(12).text(), HasSubstr("if they are late by about 12 frames"));
  EXPECT_THAT(late_by(60).text(), HasSubstr("if they are late by about 60 frames"));
}

/// A long, flat wall, seen in turn from four places that are 4 m apart.
class LongWall : public Recording {
 public:
  LongWall() { info_.frames = info_.frames_with_pose = size(); }
  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return 48; }
  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame;
    frame.camera = info_.camera;
    frame.depth = cv::Mat(480, 640, CV_32F, cv::Scalar(2));
    frame.map_from_camera = Isometry3d(Eigen::Translation3d(4.0 * static_cast<double>(i % 4), 0, 0));
    return frame;
  }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }

 private:
  RecordingInfo info_;
};

TEST(PoseCheckOfViews, ThatDoNotMeetRaisesNoDoubt) {
  // Of one place, as poses in millimetres would be, all would agree.
  const PoseAgreement agreement = check_poses(LongWall());
  EXPECT_TRUE(agreement.fits()) << agreement.text();
}

TEST_F(PoseCheck, AnotherDirectionThatIsUpIsNamedWithItsOption) {
  const Isometry3d y_down(Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitX()));
  const auto turned = in_frame(open_recording(folder_), y_down, "map");
  RecordingOptions options;
  const std::vector<std::string> doubts = doubts_about_poses(*turned, options);
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_THAT(doubts[0], HasSubstr("give --up=y"));
}

TEST_F(PoseCheck, AGivenDirectionThatIsNotUpIsNamed) {
  const Isometry3d y_down(Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitX()));
  const auto doubts_of = [&](const std::string& up, bool has_poses) {
    RecordingOptions options;
    options.up = up;
    auto recording = open_recording(folder_);
    const std::vector<std::optional<Isometry3d>> none(recording->size());
    recording =
        has_poses ? turned_upright(in_frame(std::move(recording), y_down, "map"), parse_direction(up), "map")
                  : with_up(with_poses(std::move(recording), none, "", false), parse_direction(up));
    return doubts_about_poses(*recording, options);
  };
  EXPECT_THAT(doubts_of("y", true), testing::IsEmpty());
  EXPECT_THAT(doubts_of("-y", true),
              testing::ElementsAre(testing::AllOf(HasSubstr("--up=-y is not up"), HasSubstr("give --up=y"))));
  EXPECT_THAT(doubts_of("-y", false), testing::IsEmpty());
  EXPECT_THAT(doubts_of("y", false), testing::ElementsAre(HasSubstr("--up=y is not up")));
}

TEST_F(PoseCheck, PosesThatNeverMoveDoNotFitACameraThatDoes) {
  const fs::path video = fs::path(LOCI_SHARED_DIR) / "data/redkitchen_30hz/frames";
  auto recording = open_recording(video);
  const std::vector<std::optional<Isometry3d>> poses(recording->size(), Isometry3d::Identity());
  const PoseAgreement agreement = check_poses(*with_poses(std::move(recording), poses, "world", true));
  EXPECT_FALSE(agreement.fits());
  EXPECT_THAT(agreement.text(), HasSubstr("the poses never move"));
  const fs::path still = fs::path(LOCI_SHARED_DIR) / "data/osd_changes";
  auto fixed = open_recording(still);
  const std::vector<std::optional<Isometry3d>> same(fixed->size(), Isometry3d::Identity());
  EXPECT_TRUE(check_poses(*with_poses(std::move(fixed), same, "world", true)).fits());
}

}  // namespace
}  // namespace loci::mapping
