#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/refinement.h"

namespace loci::mapping {
namespace {

constexpr double kQuarter = kPi / 2;

/// The yaw of the smallest rectangle around the surface.
double box_yaw(const PlaneEvidence& evidence) {
  std::vector<cv::Point2f> points;
  for (const auto& point : evidence.support)
    points.emplace_back(static_cast<float>(point.position.x()), static_cast<float>(point.position.y()));
  if (points.size() < 3) return 0;
  return cv::minAreaRect(points).angle * kDegree;
}

/// The yaw of a rectangle and how well it fits there.
struct ScoredYaw {
  double yaw = 0;
  double score = 0;
  Extent rectangle;
};

ScoredYaw score_at(const PlaneEvidence& evidence, const std::vector<Vector2d>& seed, double yaw) {
  ScoredYaw at{yaw, 0, {}};
  at.rectangle = PlaneRaster(evidence, seed, yaw, kDirections.coarse_cell_m, kSupports.margin_m)
                     .best_rectangle(&at.score);
  return at;
}

/// The yaw at which one rectangle scores highest: the room's unless another is clearly better.
ScoredYaw best_scored(const PlaneEvidence& evidence, const std::vector<Vector2d>& seed, double room_yaw) {
  ScoredYaw best = score_at(evidence, seed, room_yaw);
  if (best.score < kDirections.min_area_m2) return best;
  const double room_score = best.score;
  const auto try_yaw = [&](double yaw) {
    const ScoredYaw tried = score_at(evidence, seed, yaw);
    const double needed = best.yaw == room_yaw ? kDirections.gain * room_score : best.score;
    if (tried.score > needed) best = tried;
  };
  for (double turn = -kQuarter / 2; turn < kQuarter / 2; turn += kDirections.step) try_yaw(room_yaw + turn);
  try_yaw(room_yaw + std::remainder(box_yaw(evidence) - room_yaw, kQuarter));
  return best;
}

/// One position of an edge: along it and across, metres.
struct EdgeSample {
  double along, across;
};

/// A straight edge: across = offset + slope · along, with the weight of its slope.
struct EdgeLine {
  double slope = 0;
  double weight = 0;  ///< the inverse variance of the slope; 0 = no straight edge
};

/// Least squares, in which samples far from the line (objects, corners of neighbours) lose their weight.
EdgeLine line_through(const std::vector<EdgeSample>& samples) {
  EdgeLine line;
  if (samples.size() < kEdges.min_strips) return line;
  std::vector<double> heights;
  for (const EdgeSample& sample : samples) heights.push_back(sample.across);
  double offset = median(heights);
  double scale = kEdges.window_m;
  for (int round = 0; round < kDirections.rounds; ++round) {
    double sum = 0, along = 0, across = 0;
    std::vector<double> weights, misfits;
    for (const EdgeSample& sample : samples) {
      const double misfit = (sample.across - offset - line.slope * sample.along) / scale;
      weights.push_back(std::abs(misfit) < 1 ? std::pow(1 - misfit * misfit, 2) : 0);
      sum += weights.back();
      along += weights.back() * sample.along;
      across += weights.back() * sample.across;
    }
    if (sum < kDirections.min_straight * static_cast<double>(samples.size())) return {};
    along /= sum, across /= sum;
    double squares = 0, product = 0;
    for (size_t i = 0; i < samples.size(); ++i) {
      squares += weights[i] * std::pow(samples[i].along - along, 2);
      product += weights[i] * (samples[i].along - along) * (samples[i].across - across);
    }
    if (squares <= 0) return {};
    line.slope = product / squares;
    offset = across - line.slope * along;
    for (const EdgeSample& sample : samples)
      misfits.push_back(std::abs(sample.across - offset - line.slope * sample.along));
    const double noise = std::max(kDirections.min_noise_m, 1.5 * median(misfits));
    scale = std::max(scale / 2, 4 * noise);
    line.weight = squares / (noise * noise);
  }
  return line;
}

/// The edge strip by strip: the slab's vertical edge where most strips show it, else the outermost surface.
std::vector<EdgeSample> edge_samples(const PlaneEvidence& evidence, const Extent& extent, int axis,
                                     bool upper, const Eigen::Rotation2Dd& axes_from_map) {
  const double sign = upper ? 1 : -1;
  const double edge = upper ? extent.max[axis] : extent.min[axis];
  const double inset = std::min(kEdges.corner_inset_m, extent.size()[1 - axis] / 4);
  std::map<int, std::vector<double>> rim, surface;
  const auto add = [&](const Vector2d& map_point, std::map<int, std::vector<double>>& strips) {
    const Vector2d at = axes_from_map * map_point;
    const double along = at[1 - axis];
    const double across = sign * (at[axis] - edge);
    if (along < extent.min[1 - axis] + inset || along > extent.max[1 - axis] - inset) return;
    if (std::abs(across) < kDirections.window_m)
      strips[static_cast<int>(std::floor(along / kEdges.strip_m))].push_back(across);
  };
  for (const Vector2d& point : evidence.rim) add(point, rim);
  for (const auto& point : evidence.support) add(point.position, surface);
  const auto strips = static_cast<size_t>(extent.size()[1 - axis] / kEdges.strip_m);
  std::vector<EdgeSample> samples;
  const auto sample = [&](const std::map<int, std::vector<double>>& values, double fraction) {
    for (const auto& [strip, across] : values)
      if (across.size() >= 3) samples.push_back({(strip + 0.5) * kEdges.strip_m, quantile(across, fraction)});
  };
  sample(rim, 0.5);
  if (2 * samples.size() >= strips) return samples;
  samples.clear();
  sample(surface, 1);
  return samples;
}

/// By how much the edges of a rectangle turn it, radians.
struct Turn {
  double angle = 0;
  double spread = 0;  ///< by which the edges disagree: objects and people hide parts of some
};

/// The turn that makes the sides of a rectangle parallel to the edges that were seen: the median, by the
/// evidence for each. Unset without edges.
std::optional<Turn> turn_to_edges(const PlaneEvidence& evidence, const Extent& rectangle, double yaw) {
  const Eigen::Rotation2Dd axes_from_map(-yaw);
  std::vector<std::pair<double, double>> turns;  // angle, weight
  double all = 0;
  for (const int axis : {0, 1})
    for (const bool upper : {false, true}) {
      const EdgeLine line = line_through(edge_samples(evidence, rectangle, axis, upper, axes_from_map));
      if (line.weight <= 0) continue;
      // Seen along y, "across" is ±x; along x it is ±y.
      const double sign = (upper ? 1 : -1) * (axis == 1 ? 1 : -1);
      turns.emplace_back(sign * std::atan(line.slope), line.weight);
      all += line.weight;
    }
  if (turns.empty()) return std::nullopt;
  std::ranges::sort(turns);
  Turn turn;
  double below = 0;
  for (const auto& [angle, weight] : turns) {
    turn.angle = angle;
    if ((below += weight) >= all / 2) break;
  }
  for (const auto& [angle, weight] : turns) turn.spread += weight / all * std::abs(angle - turn.angle);
  return turn;
}

}  // namespace

double support_yaw(const PlaneEvidence& evidence, const std::vector<Vector2d>& seed, double room_yaw) {
  ScoredYaw at = best_scored(evidence, seed, room_yaw);
  if (at.score < kDirections.min_area_m2) return room_yaw;
  double spread = 0;
  for (int round = 0; round < kDirections.rounds; ++round) {
    const auto turn = turn_to_edges(evidence, at.rectangle, at.yaw);
    if (!turn) break;
    spread = turn->spread;
    at = score_at(evidence, seed, at.yaw + std::clamp(turn->angle, -kDirections.step, kDirections.step));
    if (std::abs(turn->angle) < kDirections.same) break;
  }
  const double off = std::remainder(at.yaw - room_yaw, kQuarter);
  const double length = at.rectangle.size().maxCoeff();
  return std::abs(off) < std::max(kDirections.edge_noise_m / length, spread) ? room_yaw : room_yaw + off;
}

}  // namespace loci::mapping
