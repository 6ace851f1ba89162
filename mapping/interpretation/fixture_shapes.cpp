#include "mapping/interpretation/fixture_shapes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/quantile.h"

namespace loci::mapping {
namespace {

constexpr double kLineTolerance = 0.012;  // m; registration of the scans and half a bar

}  // namespace

std::vector<FixturePatch> patches_of(const cv::Mat& mask, cv::Mat& labels) {
  cv::Mat stats, centroids;
  const int number = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8);
  std::vector<FixturePatch> patches;
  for (int i = 0; i < number; ++i)
    patches.push_back({{stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                        stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT)},
                       static_cast<size_t>(i)});
  return patches;
}

void join_in_line(std::vector<FixturePatch>& patches) {
  constexpr int kThin = 8;    // cells
  constexpr int kApart = 11;  // cells
  constexpr int kAside = 2;   // cells
  const auto in_line = [](const cv::Rect& a, const cv::Rect& b) {
    const auto along = [](int a0, int a1, int b0, int b1, int a_low, int a_size, int b_low, int b_size) {
      return std::max(a0, b0) - std::min(a1, b1) <= kApart && a_size <= kThin && b_size <= kThin &&
             std::abs(2 * a_low + a_size - 2 * b_low - b_size) <= 2 * kAside;
    };
    return along(a.x, a.x + a.width, b.x, b.x + b.width, a.y, a.height, b.y, b.height) ||
           along(a.y, a.y + a.height, b.y, b.y + b.height, a.x, a.width, b.x, b.width);
  };
  for (size_t i = 1; i < patches.size(); ++i)
    for (size_t k = 1; k < i; ++k) {
      const size_t from = patches[i].cluster;
      const size_t to = patches[k].cluster;
      if (from == to || !in_line(patches[i].cells, patches[k].cells)) continue;
      for (FixturePatch& patch : patches)
        if (patch.cluster == from) patch.cluster = to;
      patches[to].cells |= patches[from].cells;
    }
}

FixtureShape line_through(const std::vector<FixturePoint>& points, Random random) {
  FixtureShape best;
  for (int round = 0; round < 200; ++round) {
    const FixturePoint& a = points[random.index(points.size())];
    const FixturePoint& b = points[random.index(points.size())];
    const Vector2d way(b.u - a.u, b.v - a.v);
    if (way.norm() < 0.01) continue;
    const Vector2d across = Vector2d(-way.y(), way.x()).normalized();
    std::vector<size_t> inliers;
    for (size_t i = 0; i < points.size(); ++i)
      if (std::abs(across.dot(Vector2d(points[i].u - a.u, points[i].v - a.v))) < kLineTolerance)
        inliers.push_back(i);
    if (inliers.size() > best.inliers.size()) best.inliers = std::move(inliers);
  }
  return best;
}

void measure(const std::vector<FixturePoint>& points, FixtureShape& shape) {
  Vector2d mean = Vector2d::Zero();
  for (const size_t i : shape.inliers) mean += Vector2d(points[i].u, points[i].v);
  mean /= static_cast<double>(shape.inliers.size());
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const size_t i : shape.inliers) {
    const Vector2d d = Vector2d(points[i].u, points[i].v) - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  shape.axis = {std::cos(angle), std::sin(angle)};
  const Vector2d across(-shape.axis.y(), shape.axis.x());
  std::vector<double> along;
  std::vector<double> beside;
  for (const size_t i : shape.inliers) {
    const Vector2d d = Vector2d(points[i].u, points[i].v) - mean;
    along.push_back(shape.axis.dot(d));
    beside.push_back(across.dot(d));
  }
  const double low = quantile(along, 0.02);
  const double high = quantile(along, 0.98);
  const double left = quantile(beside, 0.05);
  const double right = quantile(beside, 0.95);
  shape.length = high - low;
  shape.width = (right - left) / 0.9;
  shape.centre = mean + (low + high) / 2 * shape.axis + (left + right) / 2 * across;
}

double mixture_depth(const std::vector<double>& depths, double start, double sigma) {
  double depth = start;
  double share = 0.5;
  for (int round = 0; round < 15; ++round) {
    double sum = 0;
    double weights = 0;
    for (const double d : depths) {
      const double before = share * std::exp(-0.5 * (d - depth) * (d - depth) / (sigma * sigma));
      const double face = (1 - share) * std::exp(-0.5 * d * d / (sigma * sigma)) + 1e-9;
      const double weight = before / (before + face);
      sum += weight * d;
      weights += weight;
    }
    if (weights < 1) break;
    depth = sum / weights;
    share = std::clamp(weights / static_cast<double>(depths.size()), 0.05, 0.95);
  }
  return depth;
}

}  // namespace loci::mapping
