#include "mapping/tracking/features.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>

#include "mapping/tracking/parameters.h"

namespace loci::mapping::tracking {
namespace {

/// The point behind a pixel of the colour image: its depth is looked up where it would be seen, until it
/// stays.
std::optional<Vector3d> point_behind(const FrameImages& images, const Vector2d& pixel) {
  const ImageLevel& level = images.levels.front();
  const Vector3d ray = level.color_camera.unproject(pixel.x(), pixel.y(), 1);
  double z = 2;
  for (int i = 0; i < 4; ++i) {
    const Vector3d point = images.depth_from_color * Vector3d(ray * z);
    if (point.z() < 0.1) return std::nullopt;
    const Vector2d at = level.depth_camera.project(point);
    if (!level.depth_camera.contains(at)) return std::nullopt;
    const float inverse = level.inverse_depth.at<float>(static_cast<int>(std::lround(at.y())),
                                                        static_cast<int>(std::lround(at.x())));
    if (inverse <= 0) return std::nullopt;
    const double measured = 1 / static_cast<double>(inverse);
    const double change = measured - point.z();
    z += change;
    if (std::abs(change) < 0.01) return images.depth_from_color * Vector3d(ray * z);
  }
  return std::nullopt;  // At an edge of depth.
}

struct Pair {
  Vector3d a, b;
};

std::vector<Pair> mutual_matches(const Features& a, const Features& b) {
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(a.descriptors, b.descriptors, matches);
  std::vector<Pair> pairs;
  for (const cv::DMatch& m : matches)
    if (m.distance <= static_cast<float>(kFeatures.max_distance))
      pairs.push_back({a.points[static_cast<size_t>(m.queryIdx)], b.points[static_cast<size_t>(m.trainIdx)]});
  return pairs;
}

/// Least squares over the chosen pairs.
Isometry3d motion_of(const std::vector<Pair>& pairs, const std::vector<size_t>& chosen) {
  Vector3d mean_a = Vector3d::Zero(), mean_b = Vector3d::Zero();
  double total = 0;
  for (const size_t i : chosen) {
    const double z = pairs[i].a.z() * pairs[i].b.z(), weight = 1 / (z * z + 0.01);
    mean_a += weight * pairs[i].a;
    mean_b += weight * pairs[i].b;
    total += weight;
  }
  mean_a /= total;
  mean_b /= total;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const size_t i : chosen) {
    const double z = pairs[i].a.z() * pairs[i].b.z(), weight = 1 / (z * z + 0.01);
    covariance += weight * (pairs[i].a - mean_a) * (pairs[i].b - mean_b).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign(2, 2) = -1;
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = svd.matrixU() * sign * svd.matrixV().transpose();
  motion.translation() = mean_a - motion.linear() * mean_b;
  return motion;
}

std::vector<size_t> agreeing(const std::vector<Pair>& pairs, const Isometry3d& a_from_b) {
  std::vector<size_t> found;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const double gate = kFeatures.gate_m + kFeatures.gate_per_z2 * pairs[i].a.z() * pairs[i].a.z();
    if ((a_from_b * pairs[i].b - pairs[i].a).squaredNorm() < gate * gate) found.push_back(i);
  }
  return found;
}

}  // namespace

Features features_of(const FrameImages& images) {
  Features features;
  if (images.gray.empty()) return features;
  std::vector<cv::KeyPoint> corners;
  cv::Mat descriptors;
  cv::ORB::create(kFeatures.count, 1.3F, kFeatures.levels, 19, 0, 2, cv::ORB::HARRIS_SCORE, 31, 12)
      ->detectAndCompute(images.gray, cv::noArray(), corners, descriptors);
  for (size_t i = 0; i < corners.size(); ++i) {
    const auto point =
        point_behind(images, {static_cast<double>(corners[i].pt.x), static_cast<double>(corners[i].pt.y)});
    if (!point) continue;
    features.points.push_back(*point);
    features.descriptors.push_back(descriptors.row(static_cast<int>(i)));
  }
  return features;
}

std::optional<FeatureMotion> match(const Features& a, const Features& b, Random random) {
  if (a.points.size() < 3 || b.points.size() < 3) return std::nullopt;
  const std::vector<Pair> pairs = mutual_matches(a, b);
  const auto enough = [&](size_t count) {
    return count >= static_cast<size_t>(kFeatures.min_matches) &&
           static_cast<double>(count) >= kFeatures.min_match_share * static_cast<double>(pairs.size());
  };
  if (pairs.size() < static_cast<size_t>(kFeatures.min_matches)) return std::nullopt;
  std::vector<size_t> best;
  for (int i = 0; i < kFeatures.samples; ++i) {
    std::vector<size_t> sample(3);
    for (size_t& s : sample) s = random.index(pairs.size());
    const auto apart = [&](size_t k, size_t l) {
      const double da = (pairs[sample[k]].a - pairs[sample[l]].a).norm();
      const double db = (pairs[sample[k]].b - pairs[sample[l]].b).norm();
      return da > 0.1 && std::abs(da - db) < 0.05 + 0.05 * da;
    };
    if (!apart(0, 1) || !apart(1, 2) || !apart(0, 2)) continue;
    std::vector<size_t> found = agreeing(pairs, motion_of(pairs, sample));
    if (found.size() > best.size()) best = std::move(found);
  }
  for (int i = 0; i < 3 && best.size() >= 3; ++i) best = agreeing(pairs, motion_of(pairs, best));
  if (best.size() < 3 || !enough(best.size())) return std::nullopt;
  return FeatureMotion{motion_of(pairs, best), best.size(), pairs.size()};
}

AppearanceIndex::AppearanceIndex()
    : cells_(static_cast<size_t>(kFeatures.tables) << static_cast<size_t>(kFeatures.table_bits)) {
  Random random(1);
  std::vector<int> all(256);
  std::iota(all.begin(), all.end(), 0);
  for (int table = 0; table < kFeatures.tables; ++table) {
    for (size_t i = 0; i + 1 < all.size(); ++i) std::swap(all[i], all[i + random.index(all.size() - i)]);
    bits_.emplace_back(all.begin(), all.begin() + kFeatures.table_bits);
  }
}

template <class Visit>
void AppearanceIndex::for_each_cell(const Features& features, const Visit& visit) const {
  for (int row = 0; row < features.descriptors.rows; ++row) {
    const auto* bytes = features.descriptors.ptr<uint8_t>(row);
    for (size_t table = 0; table < bits_.size(); ++table) {
      size_t value = table;
      for (const int bit : bits_[table]) value = 2 * value + ((bytes[bit / 8] >> (bit % 8)) & 1);
      visit(value);
    }
  }
}

void AppearanceIndex::add(const Features& features) {
  const auto number = static_cast<uint32_t>(entries_++);
  for_each_cell(features, [&](size_t cell) { cells_[cell].push_back(number); });
}

std::vector<size_t> AppearanceIndex::similar(const Features& features, size_t count) const {
  std::vector<size_t> votes(entries_), order(entries_);
  for_each_cell(features, [&](size_t cell) {
    for (const uint32_t number : cells_[cell]) ++votes[number];
  });
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return votes[a] > votes[b]; });
  order.resize(std::min(count, order.size()));
  return order;
}

}  // namespace loci::mapping::tracking
