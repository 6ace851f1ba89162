#include "mapping/recording/view_agreement.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"

namespace loci::mapping {
namespace {

constexpr double kFar = 30;  ///< depths that cameras are apart: between metres and millimetres

void compare(const cv::Mat& from, const cv::Mat& to, const Isometry3d& to_from_from,
             const DepthReading& reading, ViewCounts& counts) {
  const int step = std::max(1, std::max(from.cols, from.rows) / kViews.samples);
  for (int v = step / 2; v < from.rows; v += step)
    for (int u = step / 2; u < from.cols; u += step) {
      const auto depth = static_cast<double>(from.at<float>(v, u));
      if (!(depth > 0)) continue;
      ++counts.sampled;
      const Vector3d point = to_from_from * reading.camera.unproject(u, v, reading.z(u, v, depth));
      if (point.z() <= 0) continue;
      const Vector2d pixel = reading.camera.project(point);
      if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= to.cols - 1 && pixel.y() <= to.rows - 1))
        continue;
      const auto x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
      const auto there = static_cast<double>(to.at<float>(y, x));
      if (!(there > 0)) continue;
      const double measured = reading.z(x, y, there), difference = std::abs(measured - point.z());
      const double tolerance = kViews.tolerance_m + kViews.tolerance_share * measured;
      ++counts.compared;
      if (difference < tolerance) ++counts.agreeing;
      counts.difference_m += std::min(difference, tolerance);
    }
}

}  // namespace

double DepthReading::z(double u, double v, double depth) const {
  return along_rays ? depth / camera.unproject(u, v, 1).norm() : depth;
}

double ViewCounts::share() const {
  return compared == 0 ? 0 : static_cast<double>(agreeing) / static_cast<double>(compared);
}

double ViewCounts::mean_difference_m() const {
  return compared == 0 ? 0 : difference_m / static_cast<double>(compared);
}

ViewCounts& ViewCounts::operator+=(const ViewCounts& other) {
  sampled += other.sampled;
  compared += other.compared;
  agreeing += other.agreeing;
  difference_m += other.difference_m;
  return *this;
}

ViewCounts sum(const CountsByGap& counts) {
  ViewCounts sum;
  for (const ViewCounts& of_gap : counts) sum += of_gap;
  return sum;
}

ViewCounts worst(const CountsByGap& counts) {
  std::optional<ViewCounts> worst;
  for (const ViewCounts& of_gap : counts)
    if (of_gap.says_something() && (!worst || of_gap.share() < worst->share())) worst = of_gap;
  return worst.value_or(sum(counts));
}

Views::Views(const Recording& recording)
    : recording_(recording),
      as_read_{recording.info().camera.depth},
      step_(std::max<size_t>(1, recording.size() / kViews.places)) {}

const cv::Mat& Views::depth(size_t i) {
  const auto [at, is_new] = depths_.try_emplace(i);
  if (is_new) at->second = recording_.frame(i).depth;
  return at->second;
}

CountsByGap Views::counts(const PoseOf& pose, const DepthReading& reading) {
  CountsByGap counts;
  for (size_t first = 0; first < recording_.size(); first += step_)
    for (size_t g = 0; g < kViews.gaps.size(); ++g) {
      const size_t second = first + kViews.gaps[g];
      if (second >= recording_.size()) continue;
      const auto from = pose(first), to = pose(second);
      if (from && to) compare(depth(first), depth(second), to->inverse() * *from, reading, counts[g]);
    }
  return counts;
}

ViewCounts Views::counts_with_first(const PoseOf& pose) {
  ViewCounts counts;
  const auto from = pose(0);
  for (size_t second = step_; from && second < recording_.size(); second += step_)
    if (const auto to = pose(second))
      compare(depth(0), depth(second), to->inverse() * *from, as_read_, counts);
  return counts;
}

bool Views::far_apart(const PoseOf& pose) {
  Eigen::AlignedBox3d positions;
  std::vector<double> depths;
  for (size_t i = 0; i < recording_.size(); i += step_) {
    if (const auto at = pose(i)) positions.extend(at->translation());
    const cv::Mat& image = depth(i);
    const auto middle = static_cast<double>(image.at<float>(image.rows / 2, image.cols / 2));
    if (middle > 0) depths.push_back(middle);
  }
  return !positions.isEmpty() && !depths.empty() && positions.diagonal().norm() > kFar * median(depths);
}

}  // namespace loci::mapping
