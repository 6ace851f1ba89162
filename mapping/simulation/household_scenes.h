#pragma once

#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// What a Kinect's correlation window does to the disparity, as measured on the tables of real images: each
/// value is that of the surface around it, which rounds edges and corners, and its error is shared by
/// neighbours (their correlation falls linearly to nothing at 8 pixels).
cv::Mat seen_through_window(const cv::Mat& depth, double focal_times_baseline, Random draw);

/// How the objects of a table are put: apart from each other with now and then one on top, or as stacks of up
/// to four that stand close.
enum class Arrangement { spread, stacked };

/// Tables with drawn household objects before a Kinect at drawn distances, heights and in drawn light:
/// endless examples for a classifier. Same seed, same bytes.
class HouseholdScenes : public Recording {
 public:
  HouseholdScenes(size_t scenes, const Random& random, Arrangement arrangement = Arrangement::spread);

  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return info_.frames; }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }
  RgbdFrame frame(size_t i) const override;

  /// Of the frame that was read last. CV_16U: 1 = the table, 20, 30, ... = its objects, 0 = nothing.
  const cv::Mat& labels() const { return labels_; }
  /// The class of object 20, 30, ... of that frame; "other" for what has none.
  const std::string& class_of(int object) const { return classes_.at(static_cast<size_t>(object / 10 - 2)); }

 private:
  Random random_;
  Arrangement arrangement_;
  RecordingInfo info_;
  mutable cv::Mat labels_;
  mutable std::vector<std::string> classes_;
};

}  // namespace loci::mapping
