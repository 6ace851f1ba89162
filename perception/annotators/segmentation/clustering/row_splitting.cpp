#include "perception/annotators/segmentation/clustering/row_splitting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/sensor/depth_noise.h"

namespace loci::perception {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kMinArea = 0.001f;  ///< m², as seen: of the smallest objects

/// A gap in the footprint of an object: side 0 lies below `at` along `across`.
struct Gap {
  Vector2f across = Vector2f::UnitX();
  float at = 0;
  float filled = 1;  ///< what is measured in it, relative to the sides
};

/// One side of a cut.
struct Side {
  std::vector<size_t> members;
  float bottom = 0, distance = 0;  ///< metres
  float right = 0, left = 0;       ///< bearings from that of the object's middle, radians
};

/// Cuts one object.
class RowCut {
 public:
  RowCut(const StackCloud& cloud, const std::vector<size_t>& members) : cloud_(cloud), members_(members) {
    Vector2f mean = Vector2f::Zero();
    for (const size_t i : members) {
      mean += place(i) / static_cast<float>(members.size());
      mean_depth_ += depth(i) / static_cast<float>(members.size());
    }
    ahead_ = (mean - cloud.viewpoint).normalized();
  }

  /// Both sides, from the first gap that parts two objects, emptiest first.
  std::optional<std::array<std::vector<size_t>, 2>> sides() const {
    std::vector<Gap> gaps;
    constexpr int kDirections = 16;
    for (int k = 0; k < kDirections; ++k) {
      const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / kDirections;
      if (const std::optional<Gap> gap = emptiest({std::cos(angle), std::sin(angle)})) gaps.push_back(*gap);
    }
    std::ranges::stable_sort(gaps, {}, &Gap::filled);
    for (const Gap& gap : gaps) {
      std::array<Side, 2> parts;
      for (const size_t i : members_) parts[gap.across.dot(place(i)) < gap.at ? 0 : 1].members.push_back(i);
      for (Side& side : parts) measure(side);
      if (are_two(parts)) return std::array{std::move(parts[0].members), std::move(parts[1].members)};
    }
    return std::nullopt;
  }

 private:
  Vector2f place(size_t i) const { return cloud_.points[i].head<2>(); }
  const cv::Vec3f& measured(int pixel) const { return cloud_.image_points.ptr<cv::Vec3f>()[pixel]; }
  float depth(size_t i) const { return measured(cloud_.pixels[i])[2]; }
  float noise(float z) const { return static_cast<float>(mapping::depth_noise(static_cast<double>(z))); }
  /// What a pixel stands for at the object's distance, m².
  float pixel_area() const {
    const float side = mean_depth_ / static_cast<float>(cloud_.focal_px);
    return side * side;
  }

  /// The emptiest gap across a direction; unset where it is not much emptier than either side.
  std::optional<Gap> emptiest(const Vector2f& across) const {
    constexpr float kBin = 0.005f;      // m
    constexpr size_t kGapBins = 4;      // as wide as the largest gap inside one object
    constexpr float kMaxFilled = 0.2f;  // handles, and what noise scatters
    std::vector<float> along;
    for (const size_t i : members_) along.push_back(across.dot(place(i)));
    const auto [low, high] = std::ranges::minmax(along);
    std::vector<int> count(static_cast<size_t>((high - low) / kBin) + 1);
    for (const float s : along) ++count[static_cast<size_t>((s - low) / kBin)];
    if (count.size() < 3 * kGapBins) return std::nullopt;
    std::vector<int> band(count.size() - kGapBins + 1);  // of kGapBins from each on
    for (size_t b = 0; b < band.size(); ++b)
      for (size_t k = 0; k < kGapBins; ++k) band[b] += count[b + k];
    std::vector<int> below(band), above(band);  // most up to each, most from each on
    for (size_t b = 1; b < band.size(); ++b) {
      below[b] = std::max(below[b - 1], band[b]);
      above[band.size() - 1 - b] = std::max(above[band.size() - b], band[band.size() - 1 - b]);
    }
    Gap best{across, 0, kMaxFilled};
    bool found = false;
    for (size_t b = kGapBins; b + kGapBins < band.size(); ++b) {
      const auto least = static_cast<float>(std::min(below[b - kGapBins], above[b + kGapBins]));
      const float filled = static_cast<float>(band[b]) / least;
      if (!(filled < best.filled)) continue;
      found = true;
      best.filled = filled;
      best.at = low + kBin * (static_cast<float>(b) + 0.5f * static_cast<float>(kGapBins));
    }
    return found ? std::optional(best) : std::nullopt;
  }

  void measure(Side& side) const {
    std::vector<float> heights, bearings;
    Vector2f mean = Vector2f::Zero();
    for (const size_t i : side.members) {
      heights.push_back(cloud_.points[i].z());
      const Vector2f to = place(i) - cloud_.viewpoint;
      mean += to / static_cast<float>(side.members.size());
      bearings.push_back(std::atan2(ahead_.x() * to.y() - ahead_.y() * to.x(), ahead_.dot(to)));
    }
    if (side.members.empty()) return;
    side.distance = mean.norm();
    side.bottom = quantile(heights, 0.02);
    side.right = quantile(bearings, 0.02);
    side.left = quantile(bearings, 0.98);
  }

  /// Both are large enough and stand, and the farther one is seen beside the nearer one: the far wall of a
  /// vessel is seen above the near one.
  bool are_two(const std::array<Side, 2>& sides) const {
    constexpr float kMaxBetween = 0.7f, kMaxBottom = 0.025f;
    for (const Side& side : sides)
      if (static_cast<float>(side.members.size()) * pixel_area() < kMinArea) return false;
    const size_t nearest = sides[0].distance < sides[1].distance ? 0 : 1;
    const Side &near = sides[nearest], &far = sides[1 - nearest];
    const float floor = kMaxBottom + noise(mean_depth_);
    if (near.bottom > floor || far.bottom > floor) return false;
    const float between = std::min(near.left, far.left) - std::max(near.right, far.right);
    if (between > kMaxBetween * std::min(far.left - far.right, near.left - near.right)) return false;
    return begins_behind(near, far);
  }

  /// Whether two sides meet in the image, and mostly by a step of the depth.
  bool begins_behind(const Side& near, const Side& far) const {
    constexpr int kFar = 6, kMinContact = 6;
    constexpr float kMinStep = 0.015f, kSigmas = 4;
    const int cols = cloud_.image_points.cols, rows = cloud_.image_points.rows;
    std::vector<int> own, other;
    for (const size_t i : near.members) own.push_back(cloud_.pixels[i]);
    for (const size_t i : far.members) other.push_back(cloud_.pixels[i]);
    std::ranges::sort(own);
    std::ranges::sort(other);
    int steps = 0, smooth = 0;
    for (const int pixel : own)
      for (const auto& [du, dv] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}})
        for (int k = 1; k <= kFar; ++k) {
          const int u = pixel % cols + k * du, v = pixel / cols + k * dv;
          if (u < 0 || v < 0 || u >= cols || v >= rows) break;
          const int at = v * cols + u;
          if (std::ranges::binary_search(own, at)) break;
          if (!std::ranges::binary_search(other, at)) continue;
          const float z = measured(pixel)[2];
          ++(measured(at)[2] - z > kMinStep + kSigmas * noise(z) ? steps : smooth);
          break;
        }
    return steps >= kMinContact && steps > 2 * smooth;
  }

  const StackCloud& cloud_;
  const std::vector<size_t>& members_;
  Vector2f ahead_;
  float mean_depth_ = 0;
};

}  // namespace

std::vector<std::vector<size_t>> split_row(const StackCloud& cloud, std::vector<size_t> members) {
  std::vector<std::vector<size_t>> parts;
  if (!members.empty())
    if (const auto sides = RowCut(cloud, members).sides()) {
      for (const std::vector<size_t>& side : *sides)
        for (std::vector<size_t>& part : split_row(cloud, side)) parts.push_back(std::move(part));
      return parts;
    }
  parts.push_back(std::move(members));
  return parts;
}

}  // namespace loci::perception
