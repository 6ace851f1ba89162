#include "mapping/recording/pose_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "mapping/base/math/pose.h"
#include "mapping/recording/gravity.h"

namespace loci::mapping {
namespace {

constexpr struct {
  size_t places = 12;                       ///< in the recording, where pairs are taken
  std::array<size_t, 3> gaps = {1, 5, 30};  ///< frames between the two of a pair: far ones show late poses
  int samples = 60;                         ///< pixels along the longer side of an image
  double tolerance_m = 0.03;                ///< in depth
  double tolerance_share = 0.02;            ///< of the depth, besides
  size_t min_compared = 2000;               ///< pixels that say anything
  double min_share = 0.55;                  ///< of poses that fit
  double no_doubt = 0.85;                   ///< of poses for which no other cause is tried
  double far = 30;                          ///< depths that cameras are apart: between metres and millimetres
  double min_gain = 1.25;                   ///< times as much agrees with a cause that is named
  double min_share_then = 0.5;              ///< of what is compared then
  int64_t max_shift = 90;                   ///< frames that poses are late or early: 3 s of a video
  double level = 0.94;                      ///< z of the poses is up within 20 degrees
  double level_without_poses = 0.7;         ///< what is up in the first image within 45: the camera may turn
} kCheck;

using Pose = std::function<std::optional<Isometry3d>(size_t)>;

struct Counts {
  size_t sampled = 0, compared = 0, agreeing = 0;
  double share() const {
    return compared == 0 ? 0 : static_cast<double>(agreeing) / static_cast<double>(compared);
  }
};

/// By the frames between the two of a pair, as kCheck.gaps.
using CountsByGap = std::array<Counts, kCheck.gaps.size()>;

Counts sum(const CountsByGap& counts) {
  Counts sum;
  for (const Counts& of_gap : counts) {
    sum.sampled += of_gap.sampled;
    sum.compared += of_gap.compared;
    sum.agreeing += of_gap.agreeing;
  }
  return sum;
}

/// The frames that are compared, read once.
class Views {
 public:
  explicit Views(const Recording& recording)
      : recording_(recording), camera_(recording.info().camera.depth) {}

  CountsByGap counts(const Pose& pose) {
    CountsByGap counts;
    const size_t size = recording_.size(), step = std::max<size_t>(1, size / kCheck.places);
    for (size_t first = 0; first < size; first += step)
      for (size_t g = 0; g < kCheck.gaps.size(); ++g) {
        const size_t second = first + kCheck.gaps[g];
        if (second >= size) continue;
        const auto from = pose(first), to = pose(second);
        if (from && to) compare(depth(first), depth(second), to->inverse() * *from, counts[g]);
      }
    return counts;
  }

  /// Whether the cameras are farther apart than a room is large, by what they see of it.
  bool far_apart(const Pose& pose) {
    Eigen::AlignedBox3d positions;
    std::vector<double> depths;
    const size_t size = recording_.size(), step = std::max<size_t>(1, size / kCheck.places);
    for (size_t i = 0; i < size; i += step) {
      if (const auto at = pose(i)) positions.extend(at->translation());
      const cv::Mat& image = depth(i);
      const auto middle = static_cast<double>(image.at<float>(image.rows / 2, image.cols / 2));
      if (middle > 0) depths.push_back(middle);
    }
    return !positions.isEmpty() && !depths.empty() &&
           positions.diagonal().norm() > kCheck.far * median(depths);
  }

  /// Of the first frame with others all over the recording.
  Counts counts_with_first(const Pose& pose) {
    Counts counts;
    const size_t size = recording_.size(), step = std::max<size_t>(1, size / kCheck.places);
    const auto from = pose(0);
    for (size_t second = step; from && second < size; second += step)
      if (const auto to = pose(second)) compare(depth(0), depth(second), to->inverse() * *from, counts);
    return counts;
  }

 private:
  const cv::Mat& depth(size_t i) {
    const auto [at, is_new] = depths_.try_emplace(i);
    if (is_new) at->second = recording_.frame(i).depth;
    return at->second;
  }

  void compare(const cv::Mat& from, const cv::Mat& to, const Isometry3d& to_from_from, Counts& counts) const {
    const int step = std::max(1, std::max(from.cols, from.rows) / kCheck.samples);
    for (int v = step / 2; v < from.rows; v += step)
      for (int u = step / 2; u < from.cols; u += step) {
        const auto depth = static_cast<double>(from.at<float>(v, u));
        if (!(depth > 0)) continue;
        ++counts.sampled;
        const Vector3d point = to_from_from * camera_.unproject(u, v, depth);
        if (point.z() <= 0) continue;
        const double x = camera_.fx * point.x() / point.z() + camera_.cx,
                     y = camera_.fy * point.y() / point.z() + camera_.cy;
        if (!(x >= 0 && y >= 0 && x <= to.cols - 1 && y <= to.rows - 1)) continue;
        const auto measured = static_cast<double>(
            to.at<float>(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x))));
        if (!(measured > 0)) continue;
        ++counts.compared;
        if (std::abs(measured - point.z()) < kCheck.tolerance_m + kCheck.tolerance_share * measured)
          ++counts.agreeing;
      }
  }

  const Recording& recording_;
  PinholeCamera camera_;
  std::map<size_t, cv::Mat> depths_;
};

struct Cause {
  std::string text, hint;
  Pose pose;
};

Isometry3d with_w_first(const Isometry3d& pose) {
  const Eigen::Quaterniond read(pose.linear());
  Isometry3d result = pose;
  result.linear() = Eigen::Quaterniond(read.x(), read.y(), read.z(), read.w()).toRotationMatrix();
  return result;
}

Pose changed(const Pose& given, const std::function<Isometry3d(Isometry3d)>& change) {
  return [=](size_t i) {
    const auto pose = given(i);
    return pose ? std::optional(change(*pose)) : std::nullopt;
  };
}

Pose scaled(const Pose& given, double factor) {
  return changed(given, [factor](Isometry3d pose) {
    pose.translation() *= factor;
    return pose;
  });
}

/// Depth that is in units `factor` times as long as it is read in.
Cause in_other_unit(double factor, const RecordingInfo& info, const Pose& given) {
  const std::string times =
                        factor > 1 ? fmt::format("{:g} times", factor) : fmt::format("1/{:g} of", 1 / factor),
                    unit = fmt::format("{:g}", info.depth_unit_m * factor);
  return {"right and depth is " + times + " what is read",
          info.format == "loci" ? fmt::format("write 'depth_scale: {}' into recording.yaml", unit)
                                : fmt::format("write a cameras.yaml with 'depth: {{unit_m: {}}}'", unit),
          scaled(given, 1 / factor)};
}

/// `given` are the poses as they were read.
std::vector<Cause> causes_for(const Pose& given, const RecordingInfo& info) {
  const auto of_camera_axes = [&](const Eigen::Matrix3d& given_from_camera) {
    return changed(given, [=](Isometry3d pose) {
      pose.linear() = pose.linear() * given_from_camera;
      return pose;
    });
  };
  const Eigen::Matrix3d body_from_camera{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}};
  std::vector<Cause> causes = {
      {"from the world to the camera", "invert them: a pose takes the camera to the world",
       changed(given, [](const Isometry3d& pose) { return pose.inverse(); })},
      {"with qw before qx qy qz", "write quaternions as qx qy qz qw", changed(given, with_w_first)},
      {"of a camera with y up and z backwards", "turn y and z of the camera over",
       of_camera_axes(Vector3d(1, -1, -1).asDiagonal())},
      {"of a body with x forward and z up", "give poses of the camera: z forward, x to the right",
       of_camera_axes(body_from_camera)}};
  for (const double factor : {2.0, 4.0, 5.0, 10.0})
    for (const double either : {factor, 1 / factor}) causes.push_back(in_other_unit(either, info, given));
  return causes;
}

/// Poses of a clock that runs `shift` frames, of so many seconds, late.
Cause late_by(int64_t shift, double frame_s, const Pose& given) {
  std::string by = std::abs(shift) == 1 ? "one frame" : fmt::format("{} frames", std::abs(shift));
  if (frame_s > 0) by += fmt::format(", {:.2g} s", static_cast<double>(std::abs(shift)) * frame_s);
  return {fmt::format("{} by about {}", shift > 0 ? "late" : "early", by),
          "check the clocks of camera and poses",
          [given, shift](size_t i) { return given(static_cast<size_t>(static_cast<int64_t>(i) + shift)); }};
}

/// Times as much agrees in the pairs that tell most, of those that meet as the poses are given: where they do
/// not, what would agree otherwise contradicts nothing.
double gain(const CountsByGap& then, const CountsByGap& now) {
  double gain = 0;
  for (size_t g = 0; g < then.size(); ++g)
    if (now[g].compared >= kCheck.min_compared && then[g].compared >= kCheck.min_compared &&
        then[g].share() > kCheck.min_share_then)
      gain = std::max(gain, static_cast<double>(then[g].agreeing) /
                                static_cast<double>(std::max<size_t>(1, now[g].agreeing)));
  return gain;
}

/// Whether all poses are one.
bool never_move(const Recording& recording) {
  std::optional<Isometry3d> first;
  for (size_t i = 0; i < recording.size(); ++i) {
    const std::optional<Isometry3d> pose = recording.pose_of(i);
    if (!first) first = pose;
    if (pose && !pose->isApprox(*first, 1e-9)) return false;
  }
  return first.has_value();
}

bool raises_doubt(const CountsByGap& counts) {
  return std::any_of(counts.begin(), counts.end(), [](const Counts& of_gap) {
    return of_gap.compared >= kCheck.min_compared && of_gap.share() <= kCheck.no_doubt;
  });
}

/// As parse_direction() takes it: an axis where it is near one.
std::string direction_text(const Vector3d& direction) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(direction[i]) > kCheck.level)
      return fmt::format("{}{}", direction[i] < 0 ? "-" : "", "xyz"[i]);
  return fmt::format("{:.2f},{:.2f},{:.2f}", direction.x(), direction.y(), direction.z());
}

}  // namespace

bool PoseAgreement::fits() const {
  return cause.empty() && (compared < kCheck.min_compared || share >= kCheck.min_share);
}

std::string PoseAgreement::text() const {
  if (fits()) return {};
  if (never_move)
    return fmt::format(
        "the poses never move, but only {:.0f} % of the depth agrees between frames: the camera "
        "does ({})",
        100 * share, hint);
  if (cause.empty())
    return fmt::format(
        "the poses do not fit the depth: {:.0f} % of it agrees between frames (check poses and intrinsics; "
        "without poses the camera is tracked)",
        100 * share);
  return fmt::format("the poses do not fit the depth: {:.1f} times as much of it agrees if they are {} ({})",
                     gain, cause, hint);
}

PoseAgreement check_poses(const Recording& recording) {
  PoseAgreement result;
  const RecordingInfo& info = recording.info();
  if (info.frames_with_pose < 2) return result;
  Views views(recording);
  const Pose given = [&](size_t i) { return i < recording.size() ? recording.pose_of(i) : std::nullopt; };
  const CountsByGap now = views.counts(given);
  result.compared = sum(now).compared;
  result.share = sum(now).share();
  if (never_move(recording)) {
    // A slow camera is seen to move between frames that are far apart only.
    const Counts all = views.counts_with_first(given);
    if (all.compared < kCheck.min_compared || all.share() >= kCheck.min_share) return result;
    return {.compared = all.compared,
            .share = all.share(),
            .cause = "of a camera that moves",
            .hint = "without poses it is tracked",
            .never_move = true};
  }
  if (views.far_apart(given)) {
    // Only what a camera at rest sees meets itself then.
    const Counts then = sum(views.counts(scaled(given, 1e-3)));
    if (then.compared < kCheck.min_compared || then.share() <= kCheck.min_share_then) return result;
    result.cause = "in millimetres";
    result.hint = "write positions in metres";
    result.gain =
        static_cast<double>(then.agreeing) / static_cast<double>(std::max<size_t>(1, sum(now).agreeing));
    return result;
  }
  if (!raises_doubt(now)) return result;
  // What is wrong with poses shows in them as they were read, not as they were turned.
  std::vector<Cause> causes = causes_for(
      changed(given, [&](const Isometry3d& pose) { return info.map_from_input.inverse() * pose; }), info);
  const double frame_s = info.time_assumed
                             ? 0
                             : static_cast<double>(info.last_time - info.first_time) /
                                   static_cast<double>(kSecond) / static_cast<double>(recording.size() - 1);
  for (int64_t shift = -kCheck.max_shift; shift <= kCheck.max_shift; ++shift)
    if (shift != 0) causes.push_back(late_by(shift, frame_s, given));
  size_t agreeing = sum(now).agreeing;
  for (const Cause& cause : causes) {
    const CountsByGap then = views.counts(cause.pose);
    const Counts all = sum(then);
    if (gain(then, now) <= kCheck.min_gain || all.agreeing <= agreeing ||
        all.share() <= kCheck.min_share_then || all.compared < kCheck.min_compared)
      continue;
    agreeing = all.agreeing;
    result.cause = cause.text;
    result.hint = cause.hint;
    result.gain = gain(then, now);
  }
  return result;
}

std::vector<std::string> doubts_about_poses(const Recording& recording, const PoseAgreement& agreement,
                                            const RecordingOptions& options) {
  const RecordingInfo& info = recording.info();
  const bool is_given = options.up != "auto" && options.up != "keep", has_poses = info.frames_with_pose > 0;
  if (const std::string text = agreement.text(); !text.empty()) return {text};
  if (options.up == "keep" || !(is_given || (has_poses && info.levelled))) return {};
  // Poses were turned so that what was given is z; without poses cameras turn between frames.
  const Vector3d given = is_given ? parse_direction(options.up) : Vector3d::UnitZ();
  const Vector3d z = has_poses ? Vector3d::UnitZ() : given;
  const std::optional<Vector3d> seen = find_up(recording);
  if (!seen || seen->dot(z) > (has_poses ? kCheck.level : kCheck.level_without_poses)) return {};
  const Vector3d up = rotation_between(given, z).transpose() * *seen;
  return {fmt::format("{} is not up as the images show: up looks like {} (if so, give --up={})",
                      is_given ? "--up=" + options.up : "z of the poses", direction_text(up),
                      direction_text(up))};
}

std::vector<std::string> doubts_about_poses(const Recording& recording, const RecordingOptions& options) {
  return doubts_about_poses(recording, check_poses(recording), options);
}

std::vector<std::string> problems_of(const Recording& recording, const RecordingOptions& options) {
  std::vector<std::string> problems = recording.info().problems;
  for (std::string& doubt : doubts_about_poses(recording, options)) problems.push_back(std::move(doubt));
  return problems;
}

}  // namespace loci::mapping
