// People in real kitchens and on real tables: none where there are none (../shared/data/redkitchen_rgbd,
// osd_*), and those of OpenCV's vtest.avi set into frames of the kitchen, as the depth camera would measure
// them.

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "mapping/recording/recording.h"
#include "perception/annotators/scene_data.h"
#include "tests/support/pedestrians.h"
#include "tests/support/people_frame.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(LOCI_SHARED_DIR) / "data";

TEST(PeopleInKitchens, NobodyIsFoundWhereNobodyIs) {
  if (!fs::exists(kData)) GTEST_SKIP() << "no shared data";
  PeopleDetector detector;
  size_t frames = 0, people = 0;
  for (const auto& [name, step] : {std::pair{"redkitchen_rgbd", 4},
                                   {"osd_scenes", 1},
                                   {"osd_tabletop", 1},
                                   {"osd_changes", 1},
                                   {"osd_changes_2", 1},
                                   {"shelf_bin", 1}}) {
    const auto recording = mapping::open_recording(kData / name);
    for (size_t i = 0; i < recording->size(); i += static_cast<size_t>(step)) {
      const size_t here = detector.detect(people_frame(recording->frame(i))).size();
      EXPECT_EQ(here, 0U) << name << ", frame " << i;
      people += here;
      ++frames;
    }
  }
  std::printf("people-free frames: %zu, people reported: %zu\n", frames, people);
  EXPECT_GT(frames, 100U);
}

/// A pedestrian cut out of the video.
struct CutOut {
  cv::Mat color;
  cv::Mat mask;  ///< CV_8U, 255
};

/// What differs from the median of the frames, the largest piece; `stature_px`: height that it is given.
CutOut cut_out(const Pedestrians& frame, const cv::Rect& box, const cv::Mat& background, double stature_px) {
  const cv::Rect around =
      (box + cv::Size(box.width / 2, box.height / 5) - cv::Point(box.width / 4, box.height / 10)) &
      cv::Rect({}, background.size());
  cv::Mat difference, channels[3];
  cv::absdiff(frame.image(around), background(around), difference);
  cv::split(difference, channels);
  cv::Mat mask = cv::max(channels[0], cv::max(channels[1], channels[2])) > 35;
  const double scale = stature_px / box.height;
  CutOut cut;
  cv::resize(frame.image(around), cut.color, {}, scale, scale, cv::INTER_CUBIC);
  cv::resize(mask, mask, cut.color.size(), 0, 0, cv::INTER_LINEAR);
  mask = mask > 127;
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat::ones(15, 15, CV_8U));
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(7, 7, CV_8U));
  cv::Mat labels, statistics, centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centroids);
  int largest = 1;
  for (int i = 2; i < count; ++i)
    if (statistics.at<int>(i, cv::CC_STAT_AREA) > statistics.at<int>(largest, cv::CC_STAT_AREA)) largest = i;
  cut.mask = labels == largest;
  return cut;
}

/// Sets a cut-out at `z` metres into a frame whose cameras are taken to be one. False where what is around
/// its upper half is not behind it.
bool set_into(mapping::RgbdFrame& frame, const CutOut& cut, const cv::Point& corner, double z) {
  const cv::Rect at = cv::Rect(corner, cut.color.size()) & cv::Rect({}, frame.color.size());
  const cv::Rect upper =
      cv::Rect(at.x - 40, at.y - 20, at.width + 80, at.height * 2 / 3) & cv::Rect({}, frame.color.size());
  if (cv::countNonZero(frame.depth(upper) > z + 0.25) < 0.8 * upper.area()) return false;
  const cv::Mat mask = cut.mask(cv::Rect({}, at.size()));
  cut.color(cv::Rect({}, at.size())).copyTo(frame.color(at), mask);
  frame.depth(at).setTo(z, mask & ~(frame.depth(at) < z - 0.3));
  return true;
}

cv::Mat median_of(const std::vector<Pedestrians>& frames) {
  std::vector<cv::Mat> images;
  for (const Pedestrians& frame : frames) images.push_back(frame.image);
  cv::Mat median = images[0].clone();
  std::vector<uint8_t> values(images.size());
  for (size_t i = 0; i < median.total() * 3; ++i) {
    for (size_t k = 0; k < images.size(); ++k) values[k] = images[k].data[i];
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    median.data[i] = values[values.size() / 2];
  }
  return median;
}

TEST(PeopleInKitchens, MostPeopleWhoStandInViewAreFound) {
  const std::vector<Pedestrians> marked = marked_pedestrians();
  if (marked.empty() || !fs::exists(kData)) GTEST_SKIP() << "needs opencv-doc and the shared data";
  const cv::Mat background = median_of(marked);
  const auto kitchen = mapping::open_recording(kData / "redkitchen_rgbd");
  std::vector<mapping::RgbdFrame> frames;
  for (size_t i = 0; i < kitchen->size(); i += 8) frames.push_back(kitchen->frame(i));
  PeopleDetector detector;
  size_t person_number = 0, all = 0, found = 0, others = 0;
  for (const Pedestrians& frame : marked)
    for (const cv::Rect& box : frame.boxes) {
      if (box.x < 8 || box.y < 8 || box.br().x > background.cols - 8 || box.br().y > background.rows - 8)
        continue;
      const size_t k = ++person_number;
      const double z = 1.9 + 0.1 * static_cast<double>(k % 6);
      const CutOut cut = cut_out(frame, box, background, 1.55 * 528 / z);
      for (size_t attempt = 0; attempt < 120; ++attempt) {
        mapping::RgbdFrame scene = frames[(k * 7 + attempt / 4) % frames.size()];
        scene.depth = scene.depth.clone();
        scene.color = scene.color.clone();
        scene.camera.depth = scene.camera.color;
        scene.camera.depth_from_color.setIdentity();
        scene.map_from_camera.reset();
        const cv::Point corner(static_cast<int>(40 + (k * 97 + attempt * 113) % 440),
                               static_cast<int>(k * 13 % 50));
        if (!set_into(scene, cut, corner, z)) continue;
        const cv::Rect at(corner, cut.color.size());
        bool here = false;
        for (const Person& person : detector.detect(people_frame(scene))) {
          const bool same = (person.body & at).area() > 0.3 * at.area();
          here = here || same;
          others += same ? 0 : 1;
        }
        found += here ? 1 : 0;
        ++all;
        break;
      }
    }
  std::printf("people set into a kitchen: %zu of %zu found, %zu where nobody is\n", found, all, others);
  EXPECT_GT(all, 20U);
  EXPECT_GE(found * 10, all * 7);
  EXPECT_EQ(others, 0U);
}

}  // namespace
}  // namespace loci::perception
