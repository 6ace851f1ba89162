#include "perception/annotators/segmentation/clustering/color_splitting.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "perception/annotators/segmentation/clustering/color_contrast.h"

namespace loci::perception {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// Parts a set of points in the plane: side 0 lies below `at` along `across`.
struct Cut {
  Vector2f across = Vector2f::UnitX();
  float at = 0;
};

/// Cuts one object.
class ColorCut {
 public:
  ColorCut(const std::vector<Vector3f>& points, const std::vector<Vector3f>& normals,
           const std::vector<float>& areas, const std::vector<cv::Vec3b>& lab,
           const std::vector<size_t>& members)
      : points_(points), normals_(normals), areas_(areas), lab_(lab), members_(members) {}

  /// Both sides; unset = it is one object.
  std::optional<std::array<std::vector<size_t>, 2>> sides() const {
    if (!is_flat_object(members_)) return std::nullopt;  // nor are both sides
    const std::optional<std::vector<bool>> second = two_colors();
    if (!second) return std::nullopt;
    const std::optional<Cut> cut = line_between(*second);
    if (!cut) return std::nullopt;
    std::array<std::vector<size_t>, 2> sides;
    for (const size_t i : members_) sides[along(i, *cut) < cut->at ? 0 : 1].push_back(i);
    for (const std::vector<size_t>& side : sides)
      if (!is_flat_object(side) || !is_narrow_at(side, *cut)) return std::nullopt;
    return sides;
  }

 private:
  Vector3f color(size_t i) const { return lab_vector(lab_[i]); }
  float along(size_t i, const Cut& cut) const { return cut.across.dot(points_[i].head<2>()); }

  /// Which members have the second of the object's two main colours (2-means, from those that differ most);
  /// unset where those are not of two objects.
  std::optional<std::vector<bool>> two_colors() const {
    constexpr int kRounds = 8;
    Vector3f mean = Vector3f::Zero();
    for (const size_t i : members_) mean += color(i) / static_cast<float>(members_.size());
    const auto farthest_from = [&](const Vector3f& from) {
      return color(
          *std::ranges::max_element(members_, {}, [&](size_t i) { return lab_distance(color(i), from); }));
    };
    std::array<Vector3f, 2> centre;
    centre[0] = farthest_from(mean);
    centre[1] = farthest_from(centre[0]);
    std::vector<bool> second(members_.size());
    for (int round = 0; round < kRounds; ++round) {
      std::array<Vector3f, 2> sum{Vector3f::Zero(), Vector3f::Zero()};
      std::array<float, 2> count{};
      for (size_t k = 0; k < members_.size(); ++k) {
        const Vector3f own = color(members_[k]);
        second[k] = lab_distance(own, centre[1]) < lab_distance(own, centre[0]);
        sum[second[k] ? 1 : 0] += own;
        count[second[k] ? 1 : 0] += 1;
      }
      if (count[0] == 0 || count[1] == 0) return std::nullopt;
      for (size_t side = 0; side < 2; ++side) centre[side] = sum[side] / count[side];
    }
    if (!is_other_color(centre[0], centre[1])) return std::nullopt;
    return second;
  }

  /// The line that parts the colours (Fisher's discriminant); unset where they are mixed.
  std::optional<Cut> line_between(const std::vector<bool>& second) const {
    constexpr double kMaxMixed = 0.05;  // share of points on the wrong side: shadows, and pixels at the rims
    std::array<Vector2f, 2> mean{Vector2f::Zero(), Vector2f::Zero()};
    std::array<float, 2> count{};
    for (size_t k = 0; k < members_.size(); ++k) {
      mean[second[k] ? 1 : 0] += points_[members_[k]].head<2>();
      count[second[k] ? 1 : 0] += 1;
    }
    for (size_t side = 0; side < 2; ++side) mean[side] /= count[side];
    Eigen::Matrix2f scatter = Eigen::Matrix2f::Identity() * 1e-6f;
    for (size_t k = 0; k < members_.size(); ++k) {
      const Vector2f offset = points_[members_[k]].head<2>() - mean[second[k] ? 1 : 0];
      scatter += offset * offset.transpose() / static_cast<float>(members_.size());
    }
    Cut cut;
    cut.across = (scatter.inverse() * (mean[1] - mean[0])).normalized();
    std::vector<std::pair<float, bool>> order;
    for (size_t k = 0; k < members_.size(); ++k) order.emplace_back(along(members_[k], cut), second[k]);
    std::ranges::sort(order);
    auto wrong = static_cast<int>(count[0]);  // everything on side 1
    int fewest = wrong;
    for (size_t k = 0; k + 1 < order.size(); ++k) {
      wrong += order[k].second ? 1 : -1;
      if (wrong >= fewest) continue;
      fewest = wrong;
      cut.at = (order[k].first + order[k + 1].first) / 2;
    }
    if (fewest > kMaxMixed * static_cast<double>(members_.size())) return std::nullopt;
    return cut;
  }

  /// Seen from above, and as large as the smallest objects.
  bool is_flat_object(const std::vector<size_t>& side) const {
    constexpr float kMinArea = 0.001f;  // m²
    constexpr float kLevel = 0.7f;      // cosine: less than 45 degrees
    float area = 0, level = 0;
    for (const size_t i : side) {
      area += areas_[i];
      if (normals_[i].z() > kLevel) level += areas_[i];
    }
    return area >= kMinArea && 2 * level >= area;
  }

  /// Whether a side touches the other along a smaller part of the cut than it is wide.
  bool is_narrow_at(const std::vector<size_t>& side, const Cut& cut) const {
    constexpr float kMinBand = 0.005f;  // m
    constexpr float kMaxShare = 0.6f;   // a circle of 8 cm is half as wide within the band
    constexpr float kStray = 0.005f;    // share of points beyond the edge
    constexpr size_t kBins = 12;        // across the side
    const Vector2f line(-cut.across.y(), cut.across.x());
    std::vector<std::pair<float, float>> from_cut;  // distance, and position along the cut
    float area = 0;
    for (const size_t i : side) {
      from_cut.emplace_back(std::abs(along(i, cut) - cut.at), line.dot(points_[i].head<2>()));
      area += areas_[i];
    }
    std::ranges::sort(from_cut);
    const auto [low, high] =
        std::ranges::minmax(from_cut, {}, [](const std::pair<float, float>& point) { return point.second; });
    const auto count = static_cast<float>(side.size());
    const float band = std::max(kMinBand, 2 * std::sqrt(area / count));  // twice the points' spacing
    const float limit = from_cut[static_cast<size_t>(kStray * count)].first + band;
    std::array<bool, kBins> touches{};
    for (const auto& [distance, at] : from_cut)
      if (distance <= limit) {
        const float share = (at - low.second) / std::max(1e-6f, high.second - low.second);
        touches[std::min(kBins - 1, static_cast<size_t>(share * kBins))] = true;
      }
    return static_cast<float>(std::ranges::count(touches, true)) < kMaxShare * kBins;
  }

  const std::vector<Vector3f>& points_;
  const std::vector<Vector3f>& normals_;
  const std::vector<float>& areas_;
  const std::vector<cv::Vec3b>& lab_;
  const std::vector<size_t>& members_;
};

}  // namespace

std::vector<std::vector<size_t>> split_colors(const std::vector<Vector3f>& points,
                                              const std::vector<Vector3f>& normals,
                                              const std::vector<float>& areas,
                                              const std::vector<cv::Vec3b>& lab,
                                              std::vector<size_t> members) {
  std::vector<std::vector<size_t>> parts;
  if (!lab.empty() && !members.empty())
    if (const auto sides = ColorCut(points, normals, areas, lab, members).sides()) {
      for (const std::vector<size_t>& side : *sides)
        for (std::vector<size_t>& part : split_colors(points, normals, areas, lab, side))
          parts.push_back(std::move(part));
      return parts;
    }
  parts.push_back(std::move(members));
  return parts;
}

}  // namespace loci::perception
