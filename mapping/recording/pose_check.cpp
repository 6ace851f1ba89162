#include "mapping/recording/pose_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "mapping/recording/gravity.h"

namespace loci::mapping {
namespace {

constexpr struct {
  size_t places = 12;                   ///< in the recording, where pairs are taken
  std::array<size_t, 3> gaps = {1, 5};  ///< frames between the two of a pair
  int samples = 60;                     ///< pixels along the longer side of an image
  double tolerance_m = 0.03;            ///< in depth
  double tolerance_share = 0.02;        ///< of the depth, besides
  size_t min_compared = 2000;           ///< pixels that say anything
  double min_share = 0.55;              ///< of poses that fit
  double no_doubt = 0.85;               ///< of poses for which no other cause is tried …
  double min_overlap = 0.5;     ///< … where views meet: in the wrong unit only those of a camera at rest
  double min_gain = 1.25;       ///< times as much agrees with a cause that is named
  double min_share_then = 0.5;  ///< of what is compared then
  double level = 0.94;          ///< z of the poses is up within 20 degrees
} kCheck;

struct Pair {
  size_t first, second;  ///< frames of the recording
};

using Pose = std::function<std::optional<Isometry3d>(size_t)>;

struct Counts {
  size_t sampled = 0, compared = 0, agreeing = 0;
  double share() const {
    return compared == 0 ? 0 : static_cast<double>(agreeing) / static_cast<double>(compared);
  }
};

/// The frames that are compared, read once.
class Views {
 public:
  explicit Views(const Recording& recording) : recording_(recording), camera_(recording.info().camera.depth) {
    const size_t size = recording.size(), step = std::max<size_t>(1, size / kCheck.places);
    for (size_t first = 0; first < size; first += step)
      for (const size_t gap : kCheck.gaps)
        if (first + gap < size) pairs_.push_back({first, first + gap});
  }

  std::optional<Isometry3d> pose(size_t i) {
    return i < recording_.size() ? view(i).map_from_camera : std::nullopt;
  }

  Counts counts(const Pose& pose) {
    Counts counts;
    for (const Pair& pair : pairs_) {
      const auto first = pose(pair.first), second = pose(pair.second);
      if (!first || !second) continue;
      compare(view(pair.first).depth, view(pair.second).depth, second->inverse() * *first, counts);
    }
    return counts;
  }

 private:
  const RgbdFrame& view(size_t i) {
    const auto [at, is_new] = views_.try_emplace(i);
    if (is_new) {
      at->second = recording_.frame(i);
      at->second.color.release();
    }
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
  std::vector<Pair> pairs_;
  std::map<size_t, RgbdFrame> views_;
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

std::vector<Cause> causes_for(const Pose& given) {
  const auto changed = [given](const std::function<Isometry3d(Isometry3d)>& change) {
    return [=](size_t i) {
      const auto pose = given(i);
      return pose ? std::optional(change(*pose)) : std::nullopt;
    };
  };
  std::vector<Cause> causes;
  causes.push_back({"from the world to the camera", "invert them: a pose takes the camera to the world",
                    changed([](const Isometry3d& pose) { return pose.inverse(); })});
  causes.push_back({"with qw before qx qy qz", "write quaternions as qx qy qz qw", changed(with_w_first)});
  causes.push_back({"of a camera with y up and z backwards", "turn y and z of the camera over",
                    changed([](Isometry3d pose) {
                      pose.linear() = pose.linear() * Vector3d(1, -1, -1).asDiagonal();
                      return pose;
                    })});
  for (const auto& [factor, text, hint] :
       {std::tuple(1e-3, "in millimetres", "write positions in metres"),
        std::tuple(0.2, "right and depth five times as far: in millimetres, not in 1/5000 m",
                   "write a cameras.yaml with 'depth: {unit_m: 0.001}'"),
        std::tuple(5.0, "right and depth a fifth of this: in 1/5000 m, not in millimetres",
                   "write a cameras.yaml with 'depth: {unit_m: 0.0002}'")})
    causes.push_back({text, hint, changed([factor = factor](Isometry3d pose) {
                        pose.translation() *= factor;
                        return pose;
                      })});
  for (const int shift : {1, 2, 3, 4, 6, -1, -2, -3, -4, -6})
    causes.push_back(
        {fmt::format("{} by about {}", shift > 0 ? "late" : "early",
                     std::abs(shift) == 1 ? "one frame" : fmt::format("{} frames", std::abs(shift))),
         "check the clocks of camera and poses",
         [given, shift](size_t i) { return given(static_cast<size_t>(static_cast<int64_t>(i) + shift)); }});
  return causes;
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
  if (cause.empty())
    return fmt::format("the poses do not fit the depth: {:.0f} % of it agrees between frames", 100 * share);
  return fmt::format("the poses do not fit the depth: {:.1f} times as much of it agrees if they are {} ({})",
                     gain, cause, hint);
}

PoseAgreement check_poses(const Recording& recording) {
  PoseAgreement result;
  if (recording.info().frames_with_pose < 2) return result;
  Views views(recording);
  const Pose given = [&](size_t i) { return views.pose(i); };
  const Counts counts = views.counts(given);
  result.compared = counts.compared;
  result.share = counts.share();
  const bool meet =
      static_cast<double>(counts.compared) > kCheck.min_overlap * static_cast<double>(counts.sampled);
  if (meet && result.share > kCheck.no_doubt) return result;
  size_t agreeing = counts.agreeing;
  for (const Cause& cause : causes_for(given)) {
    const Counts then = views.counts(cause.pose);
    const double gain =
        static_cast<double>(then.agreeing) / static_cast<double>(std::max<size_t>(1, counts.agreeing));
    const bool is_better = gain > kCheck.min_gain && then.agreeing > agreeing &&
                           then.share() > kCheck.min_share_then && then.compared >= kCheck.min_compared;
    if (!is_better) continue;
    agreeing = then.agreeing;
    result.cause = cause.text;
    result.hint = cause.hint;
    result.gain = gain;
  }
  return result;
}

std::vector<std::string> doubts_about_poses(const Recording& recording, const PoseAgreement& agreement,
                                            const RecordingOptions& options) {
  if (recording.info().frames_with_pose == 0) return {};
  if (const std::string text = agreement.text(); !text.empty()) return {text};
  if (options.up != "auto" || !recording.info().levelled) return {};
  const std::optional<Vector3d> up = find_up(recording);
  if (!up || up->z() > kCheck.level) return {};
  return {fmt::format("z of the poses is not up as the images show: up looks like {} (if so, give --up={})",
                      direction_text(*up), direction_text(*up))};
}

std::vector<std::string> doubts_about_poses(const Recording& recording, const RecordingOptions& options) {
  return doubts_about_poses(recording, check_poses(recording), options);
}

}  // namespace loci::mapping
