#include "perception/annotators/segmentation/clustering/stack_splitting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>

#include "mapping/base/math/log_odds.h"
#include "mapping/base/math/math.h"
#include "mapping/sensor/depth_noise.h"
#include "perception/annotators/segmentation/clustering/color_contrast.h"

namespace loci::perception {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int kMinPart = 150;  ///< pixels of each part: outlines and colours of fewer tell little

/// A value at a height, as a line says that was fitted on one side of it.
struct Extrapolation {
  float value = 0;
  float variance = 0;  ///< in units of that of one measurement
};

/// A line through measurements over the height; its slope is small unless they show otherwise.
class LineFit {
 public:
  /// `ridge`: m², variance of one measurement over that of slopes.
  explicit LineFit(float ridge) : ridge_(ridge) {}

  void add(float height, float value) {
    ++count_;
    z_ += height;
    v_ += value;
    zz_ += height * height;
    zv_ += height * value;
    vv_ += value * value;
  }
  int count() const { return count_; }
  /// Sum of the squared residuals.
  float residual() const { return std::max(0.0f, vv_ - v_ * v_ / n() - along() * along() / spread()); }
  Extrapolation at(float height) const {
    const float from = height - z_ / n();
    return {v_ / n() + along() / spread() * from, 1 / n() + from * from / spread()};
  }

 private:
  float n() const { return static_cast<float>(count_); }
  float along() const { return zv_ - z_ * v_ / n(); }
  float spread() const { return zz_ - z_ * z_ / n() + ridge_; }

  float ridge_;
  int count_ = 0;
  float z_ = 0, v_ = 0, zz_ = 0, zv_ = 0, vv_ = 0;
};

/// A point of an object as seen from the viewpoint.
struct Seen {
  float across = 0;    ///< bearing from the object's middle times its distance, to the left, metres
  float distance = 0;  ///< in the plane, metres
  float height = 0;
  size_t point = 0;  ///< index into the cloud
};

/// What is seen of an object between two heights.
struct Slice {
  size_t points = 0;
  size_t wall_begin = 0, wall_end = 0;         ///< its points of walls
  size_t points_below = 0;                     ///< in all slices before it
  float left = 0, right = 0;                   ///< where it ends, as Seen::across
  bool left_free = false, right_free = false;  ///< its own edge, not that of something nearer
};

/// The walls on either side of a step, in columns of one bearing.
class FrontColumns {
 public:
  FrontColumns(const std::array<std::span<const Seen>, 2>& sides, float column_width, float skin)
      : sides_(sides), column_width_(column_width), skin_(skin) {
    left_ = std::numeric_limits<float>::max();
    float right = -left_;
    for (const auto& side : sides_)
      for (const Seen& s : side) {
        left_ = std::min(left_, s.across);
        right = std::max(right, s.across);
      }
    if (right > left_) columns_.resize(static_cast<size_t>((right - left_) / column_width_) + 1);
  }

  /// Sets `front` and `color` of a step; false where the walls on its sides are not seen at the same
  /// bearings.
  bool compare(const std::vector<cv::Vec3b>& lab, StackStep& step) {
    constexpr size_t kMinColumns = 4;
    if (columns_.empty()) return false;
    measure(lab);
    const std::array<float, 2> slopes = {slope(0), slope(1)};
    std::vector<float> steps, colors;
    for (const auto& column : columns_) {
      if (column[0].count < 2 || column[1].count < 2) continue;
      steps.push_back(column[1].distance_at(step.height, slopes[1]) -
                      column[0].distance_at(step.height, slopes[0]));
      colors.push_back(lab_distance(column[0].mean_lab(), column[1].mean_lab()));
    }
    if (steps.size() < kMinColumns) return false;
    step.front = median(steps);
    step.color = quantile(colors, 0.25);
    return true;
  }

 private:
  struct Half {
    int count = 0;
    float nearest = std::numeric_limits<float>::max();
    float height = 0, distance = 0;  ///< sums
    Vector3f lab = Vector3f::Zero();

    float n() const { return static_cast<float>(count); }
    float distance_at(float at, float slope) const { return distance / n() + slope * (at - height / n()); }
    Vector3f mean_lab() const { return lab / n(); }
  };

  Half& half_of(const Seen& s, size_t side) {
    return columns_[static_cast<size_t>((s.across - left_) / column_width_)][side];
  }
  /// Behind the nearest point of a column begins another surface: the inside of a cup, what stands behind.
  bool at_front(const Seen& s, const Half& half) const { return s.distance < half.nearest + skin_; }

  void measure(const std::vector<cv::Vec3b>& lab) {
    for (const size_t side : {size_t{0}, size_t{1}}) {
      for (const Seen& s : sides_[side])
        half_of(s, side).nearest = std::min(half_of(s, side).nearest, s.distance);
      for (const Seen& s : sides_[side]) {
        Half& half = half_of(s, side);
        if (!at_front(s, half)) continue;
        ++half.count;
        half.height += s.height;
        half.distance += s.distance;
        if (!lab.empty()) half.lab += lab_vector(lab[s.point]);
      }
    }
  }

  /// By how much the walls of one side recede with the height, one slope for all columns.
  float slope(size_t side) {
    constexpr float kRidge = 4e-4f;  // m²
    float zz = kRidge, zd = 0;
    for (const Seen& s : sides_[side]) {
      const Half& half = half_of(s, side);
      if (!at_front(s, half)) continue;
      const float up = s.height - half.height / half.n();
      zz += up * up;
      zd += up * (s.distance - half.distance / half.n());
    }
    return zd / zz;
  }

  std::array<std::span<const Seen>, 2> sides_;  ///< below and above
  float column_width_, skin_;
  float left_ = 0;
  std::vector<std::array<Half, 2>> columns_;
};

/// An object as seen from the viewpoint, in slices of equal thickness.
class Profile {
 public:
  Profile(const StackCloud& cloud, const std::vector<size_t>& members) : cloud_(cloud) {
    measure_size(members);
    place(members);
  }

  size_t slices() const { return slices_.size(); }
  /// Between the slice before `boundary` and that one.
  StackStep step_at(size_t boundary) const;

 private:
  /// Left out between a step and the slices that are compared: noise mixes there what is above and below.
  static constexpr size_t kGap = 1;
  static constexpr size_t kWindow = 7;  ///< slices compared on either side

  void measure_size(const std::vector<size_t>& members);
  void place(const std::vector<size_t>& members);
  void set_outline(Slice& slice, std::vector<Seen>& seen) const;
  bool is_free(int pixel, int direction) const;
  float middle(size_t slice) const { return low_ + (static_cast<float>(slice) + 0.5f) * thickness_; }
  std::span<const Slice> below(size_t boundary) const {
    const size_t end = boundary > kGap ? boundary - kGap : 0, begin = end > kWindow ? end - kWindow : 0;
    return std::span(slices_).subspan(begin, end - begin);
  }
  std::span<const Slice> above(size_t boundary) const {
    const size_t begin = std::min(slices_.size(), boundary + kGap);
    return std::span(slices_).subspan(begin, std::min(kWindow, slices_.size() - begin));
  }
  std::span<const Seen> walls_in(std::span<const Slice> slices) const {
    if (slices.empty()) return {};
    return std::span(walls_).subspan(slices.front().wall_begin,
                                     slices.back().wall_end - slices.front().wall_begin);
  }
  LineFit outline(std::span<const Slice> slices, bool left) const;
  void compare_outlines(StackStep& step, size_t boundary) const;

  const StackCloud& cloud_;
  std::vector<Seen> walls_;  ///< by slice
  std::vector<Slice> slices_;
  size_t total_ = 0;  ///< points in all slices
  Vector2f middle_ = Vector2f::Zero();
  float low_ = 0, high_ = 0;
  float thickness_ = 0;  ///< of a slice, metres
  float pixel_m_ = 0;    ///< what a pixel covers there
  float noise_m_ = 0;    ///< of the depth there
};

void Profile::measure_size(const std::vector<size_t>& members) {
  std::vector<float> heights, depths;
  heights.reserve(members.size());
  depths.reserve(members.size());
  for (const size_t i : members) {
    middle_ += cloud_.points[i].head<2>();
    heights.push_back(cloud_.points[i].z());
    depths.push_back(cloud_.image_points.ptr<cv::Vec3f>()[cloud_.pixels[i]][2]);
  }
  middle_ /= static_cast<float>(members.size());
  std::tie(low_, high_) = quantiles(heights, 0.005, 0.995);
  const auto depth = static_cast<double>(median(std::move(depths)));
  pixel_m_ = static_cast<float>(depth / cloud_.focal_px);
  noise_m_ = static_cast<float>(mapping::depth_noise(depth));
  constexpr float kMinThickness = 0.003f, kPixels = 1.6f;  // a row of pixels in nearly every slice
  thickness_ = std::max({kMinThickness, kPixels * pixel_m_, noise_m_});
}

void Profile::place(const std::vector<size_t>& members) {
  const Vector2f to = middle_ - cloud_.viewpoint;
  const Vector2f ahead = to.normalized(), across(-ahead.y(), ahead.x());
  slices_.resize(static_cast<size_t>(std::ceil((high_ - low_) / thickness_)));
  // A few thousand points of the walls measure them well enough.
  constexpr size_t kMaxWalls = 10000;
  const size_t stride = std::max<size_t>(1, members.size() / kMaxWalls);
  constexpr float kWall = 0.6f;
  std::vector<std::vector<Seen>> seen(slices_.size()), walls(slices_.size());
  for (size_t k = 0; k < members.size(); ++k) {
    const size_t i = members[k];
    const Vector3f& p = cloud_.points[i];
    const int slice = static_cast<int>(std::floor((p.z() - low_) / thickness_));
    if (slice < 0 || slice >= static_cast<int>(slices_.size())) continue;
    const Vector2f from = p.head<2>() - cloud_.viewpoint;
    const float forward = ahead.dot(from);
    const Seen point{to.norm() * std::atan2(across.dot(from), forward), from.norm(), p.z(), i};
    seen[static_cast<size_t>(slice)].push_back(point);
    if (k % stride == 0 && std::abs(cloud_.normals[i].z()) < kWall)
      walls[static_cast<size_t>(slice)].push_back(point);
  }
  for (size_t s = 0; s < slices_.size(); ++s) {
    Slice& slice = slices_[s];
    slice.points_below = total_;
    slice.points = seen[s].size();
    total_ += slice.points;
    slice.wall_begin = walls_.size();
    walls_.insert(walls_.end(), walls[s].begin(), walls[s].end());
    slice.wall_end = walls_.size();
    if (slice.points > 0) set_outline(slice, seen[s]);
  }
}

/// Its ends, of which 2 % of the points are left out on either side. Reorders `seen`.
void Profile::set_outline(Slice& slice, std::vector<Seen>& seen) const {
  const auto tail = static_cast<std::ptrdiff_t>(seen.size() / 50);
  const auto to_the_right = [](const Seen& a, const Seen& b) {
    return std::tie(a.across, a.point) < std::tie(b.across, b.point);
  };
  std::nth_element(seen.begin(), seen.begin() + tail, seen.end(), to_the_right);
  const Seen right = seen[static_cast<size_t>(tail)];
  std::nth_element(seen.begin(), seen.end() - 1 - tail, seen.end(), to_the_right);
  const Seen left = seen[seen.size() - 1 - static_cast<size_t>(tail)];
  slice.right = right.across;
  slice.left = left.across;
  slice.left_free = is_free(cloud_.pixels[left.point], -1);
  slice.right_free = is_free(cloud_.pixels[right.point], 1);
}

/// Whether the object ends at an outermost pixel: what the image shows beside it lies behind it. What hides
/// it may stand beyond a strip that the sensor does not measure.
bool Profile::is_free(int pixel, int direction) const {
  constexpr int kMaxStrip = 30;
  constexpr int kMaxLevel = 3;  // pixels as far away as it is: edges are ragged
  constexpr float kBehind = 0.015f;
  const int cols = cloud_.image_points.cols, col = pixel % cols;
  const auto* point = cloud_.image_points.ptr<cv::Vec3f>() + pixel;
  const float reach = kBehind + 2 * noise_m_;
  int level = 0;
  for (int far = 1; far <= kMaxStrip; ++far) {
    if (col + far * direction < 0 || col + far * direction >= cols) return false;
    const float behind = point[far * direction][2] - (*point)[2];
    if (std::isnan(behind)) continue;
    if (behind > reach) return true;
    if (behind < -reach || ++level > kMaxLevel) return false;
  }
  return level == 0;
}

LineFit Profile::outline(std::span<const Slice> slices, bool left) const {
  constexpr size_t kMinPoints = 4;
  LineFit fit(2e-5f);
  for (const Slice& slice : slices)
    if (slice.points >= kMinPoints && (left ? slice.left_free : slice.right_free))
      fit.add(middle(static_cast<size_t>(&slice - slices_.data())), left ? slice.left : -slice.right);
  return fit;
}

void Profile::compare_outlines(StackStep& step, size_t boundary) const {
  constexpr int kMinSlices = 2;
  for (const bool left : {true, false}) {
    const LineFit low = outline(below(boundary), left), high = outline(above(boundary), left);
    if (low.count() < kMinSlices || high.count() < kMinSlices) continue;
    const Extrapolation from = low.at(step.height), to = high.at(step.height);
    // Edges are no sharper than a pixel, and where the sensor fails they are ragged.
    float variance = pixel_m_ * pixel_m_;
    if (const int spare = low.count() + high.count() - 4; spare > 0)
      variance = std::max(variance, (low.residual() + high.residual()) / static_cast<float>(spare));
    (left ? step.left : step.right) = to.value - from.value;
    (left ? step.left_sigmas : step.right_sigmas) =
        std::abs(to.value - from.value) / std::sqrt((from.variance + to.variance) * variance);
    (left ? step.left_seen : step.right_seen) = true;
  }
}

float median_width(std::span<const Slice> slices) {
  constexpr size_t kMinPoints = 4;
  std::vector<float> widths;
  for (const Slice& slice : slices)
    if (slice.points >= kMinPoints) widths.push_back(slice.left - slice.right);
  return widths.empty() ? 0.0f : median(std::move(widths));
}

StackStep Profile::step_at(size_t boundary) const {
  StackStep step;
  step.height = low_ + static_cast<float>(boundary) * thickness_;
  step.below = step.height - low_;
  step.above = high_ - step.height;
  step.points_below = static_cast<int>(slices_[boundary].points_below);
  step.points_above = static_cast<int>(total_) - step.points_below;
  step.width_below = median_width(below(boundary));
  step.width_above = median_width(above(boundary));
  compare_outlines(step, boundary);
  constexpr float kColumn = 2.5f;  // pixels
  constexpr float kSkin = 0.012f;
  constexpr float kShared = 1.2f;  // neighbouring columns share most of their noise
  FrontColumns columns({walls_in(below(boundary)), walls_in(above(boundary))}, kColumn * pixel_m_,
                       kSkin + 2 * noise_m_);
  if (columns.compare(cloud_.lab, step)) step.front_sigmas = std::abs(step.front) / (kShared * noise_m_);
  return step;
}

/// By how much an object changes at a step, to find the largest one among those near.
float change(const StackStep& step) {
  constexpr float kMaxSigmas = 20;
  std::array<float, 3> sigmas = {step.left_sigmas, step.right_sigmas, step.front_sigmas};
  std::sort(sigmas.begin(), sigmas.end());
  return std::min(sigmas[2], kMaxSigmas) + 2 * std::min(sigmas[1], kMaxSigmas) + 0.3f * step.color;
}

}  // namespace

void StackOptions::declare(OptionTable& table) {
  table.number("stack_probability", stack_probability, "",
               "Minimum probability with which an object is cut into two that stand upon each other; 1 = no "
               "cut.",
               0, 1);
  table.number("layer_m", layer_m, "m", "Minimum height of an object in a stack.", 0, 1);
  table.number("lid_m", lid_m, "m",
               "Maximum height of a lid: what is lower and narrower than what is below it is a part of it.",
               0, 1);
  table.number("cap_m", cap_m, "m", "Maximum height and width of a cap or knob on top of an object.", 0, 1);
}

std::vector<StackStep> stack_steps(const StackCloud& cloud, const std::vector<size_t>& members) {
  constexpr float kNear = 0.012f;
  constexpr size_t kMinSlices = 6, kMinSide = 2;
  const Profile profile(cloud, members);
  if (profile.slices() < kMinSlices) return {};
  std::vector<StackStep> all;
  for (size_t boundary = kMinSide; boundary + 1 < profile.slices(); ++boundary)
    all.push_back(profile.step_at(boundary));
  std::vector<StackStep> largest;
  for (const StackStep& step : all)
    if (std::ranges::all_of(all, [&](const StackStep& other) {
          return std::abs(other.height - step.height) > kNear || change(other) < change(step) ||
                 (change(other) == change(step) && other.height >= step.height);
        }))
      largest.push_back(step);
  return largest;
}

double stack_probability(const StackStep& step, const StackOptions& options) {
  constexpr float kMinVisible = 0.33f;
  if (std::min(step.points_above, step.points_below) < kMinPart) return 0;
  if (static_cast<double>(std::min(step.above, step.below)) < options.layer_m) return 0;
  const auto [narrow, wide] = std::minmax(step.width_above, step.width_below);
  const bool both_seen = step.left_seen && step.right_seen;
  if (!both_seen && narrow < kMinVisible * wide) return 0;
  const auto above = static_cast<double>(step.above), width_above = static_cast<double>(step.width_above);
  if (step.width_above < step.width_below && above < options.lid_m) return 0;
  if (std::max(above, width_above) < options.cap_m) return 0;

  // A handle changes one side only. One side alone is worth less than two.
  constexpr float kMaxSigmas = 6, kMaxColor = 45, kOneSide = 0.7f;
  const float outline =
      std::min(kMaxSigmas, both_seen ? std::min(step.left_sigmas, step.right_sigmas)
                                     : kOneSide * std::max(step.left_sigmas, step.right_sigmas));
  // What recedes by more than that is another surface.
  const float front = std::abs(step.front) < 0.5f * wide ? std::min(kMaxSigmas, step.front_sigmas) : 0.0f;
  const float color = std::min(kMaxColor, step.color) / 9;
  // Logistic regression over the steps of rendered tables (seeds 1 to 4) and of osd_scenes and osd_tabletop.
  // Prints change the colour alone, lids and handles the outline alone: two kinds of evidence are needed.
  const float log_odds = -4.6f + 0.48f * outline + 0.89f * std::sqrt(outline * color) +
                         0.87f * std::sqrt(front * color) - 0.3f * std::sqrt(outline * front);
  return probability_from_log_odds(static_cast<double>(log_odds));
}

std::vector<std::vector<size_t>> split_stack(const StackCloud& cloud, std::vector<size_t> members,
                                             const StackOptions& options) {
  constexpr double kMinShare = 0.08;  // less is rather a piece of a neighbour
  std::vector<std::vector<size_t>> parts;
  const auto least = std::max(static_cast<double>(kMinPart), kMinShare * static_cast<double>(members.size()));
  if (!cloud.lab.empty() && options.stack_probability < 1 && static_cast<int>(members.size()) >= 2 * kMinPart)
    for (const StackStep& step : stack_steps(cloud, members)) {
      if (stack_probability(step, options) < options.stack_probability) continue;
      std::vector<size_t> lower, upper;
      for (const size_t i : members) (cloud.points[i].z() < step.height ? lower : upper).push_back(i);
      if (static_cast<double>(std::min(lower.size(), upper.size())) < least) continue;
      parts.push_back(std::move(lower));
      members = std::move(upper);
    }
  parts.push_back(std::move(members));
  return parts;
}

}  // namespace loci::perception
