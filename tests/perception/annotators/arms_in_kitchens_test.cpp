// Arms that reach into views of a real kitchen and of real tables (../shared/data/redkitchen_rgbd, osd_*):
// drawn ones are set into the frames as the depth camera would measure them; where nobody reaches in, none is
// found.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "mapping/recording/gravity.h"
#include "mapping/recording/recording.h"
#include "perception/detection/arms.h"
#include "tests/support/drawn_arm.h"
#include "tests/support/people_frame.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(LOCI_SHARED_DIR) / "data";

/// Every `step`-th frame; with a pose in which z is up where the recording has none.
std::vector<mapping::RgbdFrame> frames_of(const std::string& name, size_t step) {
  const auto recording = mapping::open_recording(kData / name);
  const std::optional<Vector3d> up = mapping::find_up(*recording);
  std::vector<mapping::RgbdFrame> frames;
  for (size_t i = 0; i < recording->size(); i += step) {
    frames.push_back(recording->frame(i));
    if (!frames.back().map_from_camera && up)
      frames.back().map_from_camera = Isometry3d(Eigen::Quaterniond::FromTwoVectors(*up, Vector3d::UnitZ()));
  }
  return frames;
}

TEST(ArmsInKitchens, NoneIsFoundWhereNobodyReachesIn) {
  if (!fs::exists(kData)) GTEST_SKIP() << "no shared data";
  size_t frames = 0, arms = 0;
  for (const auto& [name, step] : {std::pair{"redkitchen_rgbd", 3},
                                   {"osd_scenes", 2},
                                   {"osd_tabletop", 2},
                                   {"osd_changes", 1},
                                   {"osd_changes_2", 1},
                                   {"shelf_bin", 1}})
    for (const mapping::RgbdFrame& frame : frames_of(name, static_cast<size_t>(step))) {
      arms += find_arms(people_frame(frame)).size();
      ++frames;
    }
  std::printf("frames without arms: %zu, arms reported: %zu\n", frames, arms);
  EXPECT_GT(frames, 80U);
  EXPECT_LE(arms * 100, frames) << "the back of a wooden chair beside the table";
}

struct FoundArm {
  bool arm = false;
  size_t elsewhere = 0;  ///< persons who are somewhere else
  double share = 0;      ///< of the arm's pixels
};

FoundArm look_for(const mapping::RgbdFrame& frame, const cv::Mat& truth) {
  FoundArm found;
  for (const Person& person : find_arms(people_frame(frame))) {
    double same = 0;
    for (const int pixel : person.pixels) same += truth.data[pixel] != 0 ? 1 : 0;
    const bool of_arm = 2 * same > static_cast<double>(person.pixels.size());
    found.arm = found.arm || of_arm;
    found.elsewhere += of_arm ? 0 : 1;
    found.share += same / cv::countNonZero(truth);
  }
  return found;
}

TEST(ArmsInKitchens, MostThatReachInAreFound) {
  if (!fs::exists(kData)) GTEST_SKIP() << "no shared data";
  const char* seed = std::getenv("LOCI_ARMS_SEED");
  Random draw(seed != nullptr ? std::stoul(seed) : 1);
  size_t all = 0, found = 0, elsewhere = 0, covered = 0;
  for (const auto& [name, step] : {std::pair{"redkitchen_rgbd", 8}, {"osd_changes", 1}, {"osd_changes_2", 1}})
    for (const mapping::RgbdFrame& frame : frames_of(name, static_cast<size_t>(step)))
      for (int attempt = 0; attempt < 60; ++attempt) {
        mapping::RgbdFrame scene = frame;
        const std::optional<cv::Mat> truth = set_arm_into(scene, draw);
        if (!truth) continue;
        const FoundArm here = look_for(scene, *truth);
        ++all;
        found += here.arm ? 1 : 0;
        covered += here.share > 0.7 ? 1 : 0;
        elsewhere += here.elsewhere;
        break;
      }
  std::printf("arms set into real frames: %zu of %zu found, %zu with most of their pixels, %zu elsewhere\n",
              found, all, covered, elsewhere);
  EXPECT_GT(all, 30U);
  EXPECT_GE(found * 10, all * 7);
  EXPECT_GE(covered * 10, found * 8);
  EXPECT_EQ(elsewhere, 0U);
}

}  // namespace
}  // namespace loci::perception
