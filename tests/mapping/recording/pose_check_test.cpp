#include "mapping/recording/pose_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/math/math.h"
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

TEST_F(PoseCheck, AnotherDirectionThatIsUpIsNamedWithItsOption) {
  const Isometry3d y_down(Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitX()));
  const auto turned = in_frame(open_recording(folder_), y_down, "map");
  RecordingOptions options;
  const std::vector<std::string> doubts = doubts_about_poses(*turned, options);
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_THAT(doubts[0], HasSubstr("give --up=y"));
  options.up = "y";
  EXPECT_TRUE(doubts_about_poses(*turned, options).empty());
}

}  // namespace
}  // namespace loci::mapping
