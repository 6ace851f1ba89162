#include "mapping/recording/pose_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"
#include "mapping/recording/gravity.h"
#include "mapping/recording/view_agreement.h"

namespace loci::mapping {
namespace {

constexpr struct {
  double min_share = 0.55;           ///< of poses that fit, in the pairs that agree least
  double no_doubt = 0.85;            ///< of poses for which no other cause is tried
  double min_gain = 1.25;            ///< times as much agrees with a cause that is named
  double min_share_then = 0.5;       ///< of what is compared then
  double min_sharpening = 1.5;       ///< times as little does depth differ with a camera that is named
  double max_factor = 2;             ///< of focal lengths and units that are tried, either way
  double coarse_step = 1.04;         ///< between them at first; a factor 5 % off shows clearly
  double fine_step = 1.005;          ///< at the end
  int64_t max_shift = 90;            ///< frames that poses are late or early: 3 s of a video
  double max_height_m = 6;           ///< of what a camera in a room sees
  double level = 0.94;               ///< z of the poses is up within 20 degrees
  double level_without_poses = 0.7;  ///< what is up in the first image within 45: the camera may turn
} kCheck;

struct Cause {
  std::string text, hint;
  PoseOf pose;
  std::optional<DepthReading> reading = {};  ///< unset = as it is read
};

Isometry3d with_w_first(const Isometry3d& pose) {
  const Eigen::Quaterniond read(pose.linear());
  Isometry3d result = pose;
  result.linear() = Eigen::Quaterniond(read.x(), read.y(), read.z(), read.w()).toRotationMatrix();
  return result;
}

PoseOf changed(const PoseOf& given, const std::function<Isometry3d(Isometry3d)>& change) {
  return [=](size_t i) {
    const auto pose = given(i);
    return pose ? std::optional(change(*pose)) : std::nullopt;
  };
}

PoseOf scaled(const PoseOf& given, double factor) {
  return changed(given, [factor](Isometry3d pose) {
    pose.translation() *= factor;
    return pose;
  });
}

/// What to write about the depth camera, by the key that the recording's layout has for it.
std::string key_hint(const RecordingInfo& info, const std::string& of_loci, const std::string& of_cameras) {
  for (const char* format : {"7-scenes", "tum", "redwood"})
    if (info.format == format) return fmt::format("write a cameras.yaml with 'depth: {{{}}}'", of_cameras);
  return fmt::format("{}write '{}' into recording.yaml",
                     info.format == "loci" ? "" : "convert it with loci-perceive convert, and ", of_loci);
}

/// Depth that is in units `factor` times as long as it is read in.
Cause in_other_unit(double factor, const RecordingInfo& info, const PoseOf& given) {
  const std::string times = factor >= 1 ? fmt::format("{:.3g} times", factor)
                                        : fmt::format("1/{:.3g} of", 1 / factor),
                    unit = fmt::format("{:.3g}", info.depth_unit_m * factor);
  return {"right and depth is " + times + " what is read",
          key_hint(info, "depth_scale: " + unit, "unit_m: " + unit), scaled(given, 1 / factor)};
}

/// `given` are the poses as they were read.
std::vector<Cause> causes_for(const PoseOf& given, const RecordingInfo& info) {
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
Cause late_by(int64_t shift, double frame_s, const PoseOf& given) {
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
    if (now[g].says_something() && then[g].says_something() && then[g].share() > kCheck.min_share_then)
      gain = std::max(gain, static_cast<double>(then[g].agreeing) /
                                static_cast<double>(std::max<size_t>(1, now[g].agreeing)));
  return gain;
}

/// The gap at which depth differs by so many times less then.
struct Sharpening {
  double times = 0;
  size_t gap = 0;
};
Sharpening sharpening(const CountsByGap& then, const CountsByGap& now) {
  Sharpening best;
  for (size_t g = 0; g < then.size(); ++g) {
    if (!now[g].says_something() || !then[g].says_something() || then[g].share() <= kCheck.min_share_then)
      continue;
    const double times = now[g].mean_difference_m() / std::max(1e-6, then[g].mean_difference_m());
    if (times > best.times) best = {times, g};
  }
  return best;
}

/// Makes the cause of a factor, e.g. of the focal length.
using CauseOfFactor = std::function<Cause(double)>;

/// The factor with which depth differs least between the views.
Cause best_factor(const CauseOfFactor& cause_of, Views& views) {
  double best = 1, least = std::numeric_limits<double>::infinity();
  const auto search = [&](double from, double to, double step) {
    for (double factor = from; factor <= to; factor *= step) {
      const Cause cause = cause_of(factor);
      const ViewCounts all = sum(views.counts(cause.pose, *cause.reading));
      if (!all.says_something() || all.mean_difference_m() >= least) continue;
      least = all.mean_difference_m();
      best = factor;
    }
  };
  search(1 / kCheck.max_factor, kCheck.max_factor, kCheck.coarse_step);
  search(best / kCheck.coarse_step, best * kCheck.coarse_step, kCheck.fine_step);
  return cause_of(best);
}

/// What may be wrong with the depth images and their camera while the poses are right.
std::vector<Cause> causes_in_depth(const PoseOf& given, const RecordingInfo& info, Views& views) {
  const PinholeCamera& camera = info.camera.depth;
  const auto of_focal_length = [&](double factor) {
    DepthReading reading{camera};
    reading.camera.fx *= factor;
    reading.camera.fy *= factor;
    const std::string focal = fmt::format("fx: {:.4g}, fy: {:.4g}", reading.camera.fx, reading.camera.fy);
    return Cause{fmt::format("the focal length is {:.3g} times as long", factor),
                 key_hint(info, "depth: {…, " + focal + ", …}",
                          fmt::format("width: {}, height: {}, {}, cx: {:g}, cy: {:g}", camera.width,
                                      camera.height, focal, camera.cx, camera.cy)),
                 given, reading};
  };
  const auto of_unit = [&](double factor) {
    Cause cause = in_other_unit(factor, info, given);
    cause.text =
        fmt::format("it is {:.3g} times what is read, or positions 1/{:.3g} of theirs", factor, factor);
    cause.reading = DepthReading{camera};
    return cause;
  };
  DepthReading mirrored{camera};
  mirrored.camera.fx = -camera.fx;
  mirrored.camera.cx = camera.width - 1 - camera.cx;
  return {best_factor(of_focal_length, views),
          best_factor(of_unit, views),
          {"it is the distance along rays instead of z",
           key_hint(info, "depth_along_rays: true", "along_rays: true"), given, DepthReading{camera, true}},
          {"the images are mirrored", "mirror them back, left to right", given, mirrored}};
}

/// Read once: some layouts read images for them.
std::vector<std::optional<Isometry3d>> poses_of(const Recording& recording) {
  std::vector<std::optional<Isometry3d>> poses;
  for (size_t i = 0; i < recording.size(); ++i) poses.push_back(recording.pose_of(i));
  return poses;
}

/// Whether all poses are one.
bool never_move(const std::vector<std::optional<Isometry3d>>& poses) {
  std::optional<Isometry3d> first;
  for (const std::optional<Isometry3d>& pose : poses) {
    if (!first) first = pose;
    if (pose && !pose->isApprox(*first, 1e-9)) return false;
  }
  return first.has_value();
}

bool raises_doubt(const CountsByGap& counts) {
  return std::ranges::any_of(counts, [](const ViewCounts& of_gap) {
    return of_gap.says_something() && of_gap.share() <= kCheck.no_doubt;
  });
}

/// Reads as many frames as there are places, spread over the recording.
void for_some_frames(const Recording& recording, const std::function<void(const RgbdFrame&)>& look) {
  const size_t count = std::min(recording.size(), kViews.places);
  for (size_t i = 0; i < count; ++i) look(recording.frame(i * recording.size() / count));
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
  return cause.empty() && (compared < kViews.min_compared || share >= kCheck.min_share);
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
  if (in_depth)
    return fmt::format(
        "the depth does not fit the poses: between frames it differs by {:.0f} mm, and by {:.0f} mm if {} "
        "({})",
        1e3 * difference_m, 1e3 * difference_m / gain, cause, hint);
  return fmt::format("the poses do not fit the depth: {:.1f} times as much of it agrees if they are {} ({})",
                     gain, cause, hint);
}

namespace {

/// Poses that never move, of a camera that does.
PoseAgreement check_still(Views& views, const PoseOf& given, const PoseAgreement& otherwise) {
  // A slow camera is seen to move between frames that are far apart only.
  const ViewCounts all = views.counts_with_first(given);
  if (!all.says_something() || all.share() >= kCheck.min_share) return otherwise;
  return {.compared = all.compared,
          .share = all.share(),
          .cause = "of a camera that moves",
          .hint = "without poses it is tracked",
          .never_move = true};
}

/// Poses of cameras that are too far apart: only what a camera at rest sees meets itself then.
void check_millimetres(Views& views, const PoseOf& given, const ViewCounts& now, PoseAgreement& result) {
  const ViewCounts then = sum(views.counts(scaled(given, 1e-3)));
  if (!then.says_something() || then.share() <= kCheck.min_share_then) return;
  result.cause = "in millimetres";
  result.hint = "write positions in metres";
  result.gain = static_cast<double>(then.agreeing) / static_cast<double>(std::max<size_t>(1, now.agreeing));
}

/// The cause with which most depth agrees, of those that are about the poses; and how little it differs then.
double find_cause_in_poses(Views& views, const std::vector<Cause>& causes, const CountsByGap& now,
                           PoseAgreement& result) {
  size_t agreeing = sum(now).agreeing;
  double difference_m = std::numeric_limits<double>::infinity();
  for (const Cause& cause : causes) {
    const CountsByGap then = views.counts(cause.pose);
    const ViewCounts all = sum(then);
    if (gain(then, now) <= kCheck.min_gain || all.agreeing <= agreeing ||
        all.share() <= kCheck.min_share_then || !all.says_something())
      continue;
    agreeing = all.agreeing;
    difference_m = all.mean_difference_m();
    result.cause = cause.text;
    result.hint = cause.hint;
    result.gain = gain(then, now);
  }
  return difference_m;
}

/// A cause in the depth with which it differs less than `min_difference_m`, and much less than now.
void find_cause_in_depth(Views& views, const std::vector<Cause>& causes, const CountsByGap& now,
                         double min_difference_m, PoseAgreement& result) {
  for (const Cause& cause : causes) {
    const CountsByGap then = views.counts(cause.pose, *cause.reading);
    const double difference_m = sum(then).mean_difference_m();
    const Sharpening found = sharpening(then, now);
    if (found.times < kCheck.min_sharpening || difference_m >= min_difference_m) continue;
    min_difference_m = difference_m;
    result.cause = cause.text;
    result.hint = cause.hint;
    result.gain = found.times;
    result.difference_m = now[found.gap].mean_difference_m();
    result.in_depth = true;
  }
}

}  // namespace

PoseAgreement check_poses(const Recording& recording) {
  PoseAgreement result;
  const RecordingInfo& info = recording.info();
  if (info.frames_with_pose < 2) return result;
  Views views(recording);
  const std::vector<std::optional<Isometry3d>> poses = poses_of(recording);
  const PoseOf given = [&](size_t i) { return i < poses.size() ? poses[i] : std::nullopt; };
  const CountsByGap now = views.counts(given);
  result.compared = worst(now).compared;
  result.share = worst(now).share();
  if (never_move(poses)) return check_still(views, given, result);
  if (views.far_apart(given)) {
    check_millimetres(views, given, sum(now), result);
    return result;
  }
  double min_difference_m = sum(now).mean_difference_m();
  if (raises_doubt(now)) {
    // What is wrong with poses shows in them as they were read, not as they were turned.
    std::vector<Cause> causes = causes_for(
        changed(given, [&](const Isometry3d& pose) { return info.map_from_input.inverse() * pose; }), info);
    const double frame_s = info.time_assumed
                               ? 0
                               : static_cast<double>(info.last_time - info.first_time) /
                                     static_cast<double>(kSecond) / static_cast<double>(recording.size() - 1);
    for (int64_t shift = -kCheck.max_shift; shift <= kCheck.max_shift; ++shift)
      if (shift != 0) causes.push_back(late_by(shift, frame_s, given));
    min_difference_m = std::min(min_difference_m, find_cause_in_poses(views, causes, now, result));
  }
  find_cause_in_depth(views, causes_in_depth(given, info, views), now, min_difference_m, result);
  return result;
}

std::optional<std::string> doubt_about_up(const Recording& recording, const RecordingOptions& options) {
  const RecordingInfo& info = recording.info();
  const bool is_given = options.up != "auto" && options.up != "keep", has_poses = info.frames_with_pose > 0;
  if (options.up == "keep" || !(is_given || (has_poses && info.levelled))) return std::nullopt;
  // Poses were turned so that what was given is z; without poses cameras turn between frames.
  const Vector3d given = is_given ? parse_direction(options.up) : Vector3d::UnitZ();
  const Vector3d z = has_poses ? Vector3d::UnitZ() : given;
  const std::optional<Vector3d> seen = find_up(recording);
  if (!seen || seen->dot(z) > (has_poses ? kCheck.level : kCheck.level_without_poses)) return std::nullopt;
  const Vector3d up = rotation_between(given, z).transpose() * *seen;
  return fmt::format("{} is not up as the images show: up looks like {} (if so, give --up={})",
                     is_given ? "--up=" + options.up : "z of the poses", direction_text(up),
                     direction_text(up));
}

std::optional<std::string> missing_depth(const Recording& recording) {
  size_t looked_at = 0, without = 0;
  for_some_frames(recording, [&](const RgbdFrame& frame) {
    ++looked_at;
    if (!has_depth(frame)) ++without;
  });
  if (2 * without <= looked_at) return std::nullopt;
  return fmt::format(
      "{} of {} frames that were looked at have no depth: check the depth images and their invalid values",
      without, looked_at);
}

std::optional<std::string> implausible_height(const Recording& recording) {
  std::vector<double> heights;
  for_some_frames(recording, [&](const RgbdFrame& frame) {
    if (!frame.map_from_camera) return;
    const int step = std::max(1, std::max(frame.depth.cols, frame.depth.rows) / kViews.samples);
    for (int v = 0; v < frame.depth.rows; v += step)
      for (int u = 0; u < frame.depth.cols; u += step)
        if (const auto z = static_cast<double>(frame.depth.at<float>(v, u)); z > 0)
          heights.push_back((*frame.map_from_camera * frame.camera.depth.unproject(u, v, z)).z());
  });
  if (heights.empty()) return std::nullopt;
  const auto [low, high] = quantiles(heights, 0.01, 0.99);
  if (high - low < kCheck.max_height_m) return std::nullopt;
  return fmt::format(
      "what the camera sees is {:.1f} m high: is the unit of depth right ({})?", high - low,
      recording.info().format == "loci" ? "depth_scale in recording.yaml" : "unit_m in cameras.yaml");
}

std::vector<std::string> doubts_about_poses(const Recording& recording, const PoseAgreement& agreement,
                                            const RecordingOptions& options) {
  if (const std::string text = agreement.text(); !text.empty()) return {text};
  if (const auto doubt = doubt_about_up(recording, options)) return {*doubt};
  return {};
}

std::vector<std::string> doubts_about_poses(const Recording& recording, const RecordingOptions& options) {
  return doubts_about_poses(recording, check_poses(recording), options);
}

std::vector<std::string> problems_of(const Recording& recording, const RecordingOptions& options) {
  std::vector<std::string> problems = recording.info().problems;
  if (const auto missing = missing_depth(recording)) problems.push_back(*missing);
  for (std::string& doubt : doubts_about_poses(recording, options)) problems.push_back(std::move(doubt));
  return problems;
}

}  // namespace loci::mapping
