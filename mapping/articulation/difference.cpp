#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mapping/articulation/articulation.h"
#include "mapping/articulation/joint_fit.h"
#include "mapping/articulation/moved_face.h"
#include "mapping/articulation/parameters.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {
namespace {

/// Space that the rays of a scan set passed: per origin an image of minimum ranges by direction, in steps of
/// half a degree.
class ObservedFreeSpace {
 public:
  /// Keeps origins within reach of `near`. A point is free when the rays around it continue by `tolerance`
  /// metres.
  ObservedFreeSpace(const ScanSet& set, const Vector3d& near, double tolerance)
      : ObservedFreeSpace(set, tolerance) {
    std::erase_if(views_,
                  [&](const View& view) { return (view.origin - near).norm() > kFaceMotion.view_reach_m; });
  }
  /// Keeps all origins.
  ObservedFreeSpace(const ScanSet& set, double tolerance);

  bool is_free(const Vector3d& point) const;
  /// The share of points that are free.
  double share_free(const std::vector<Vector3d>& points) const;

 private:
  struct View {
    Vector3d origin;
    std::vector<float> min_range;  ///< metres by direction; infinity = no ray
  };

  double tolerance_;
  std::vector<View> views_;
};

constexpr int kAzimuths = 720, kElevations = 360;
constexpr float kNone = std::numeric_limits<float>::infinity();

struct Cell {
  int azimuth, elevation;
};

Cell cell_of_direction(const Vector3d& d) {
  const double azimuth = std::atan2(d.y(), d.x()) / (2 * kPi) + 0.5;
  const double elevation = std::asin(std::clamp(d.z() / d.norm(), -1.0, 1.0)) / kPi + 0.5;
  return {std::min(static_cast<int>(azimuth * kAzimuths), kAzimuths - 1),
          std::min(static_cast<int>(elevation * kElevations), kElevations - 1)};
}

size_t index_of(int azimuth, int elevation) {
  return static_cast<size_t>(elevation * kAzimuths + (azimuth + kAzimuths) % kAzimuths);
}

ObservedFreeSpace::ObservedFreeSpace(const ScanSet& set, double tolerance) : tolerance_(tolerance) {
  if (!set.free_space) return;
  for (const Scan& scan : set.scans) {
    if (scan.origins.empty()) continue;  // its rays are unknown
    const size_t first = views_.size();
    for (const Eigen::Vector3f& origin : scan.origins)
      views_.push_back({scan.map_from_scan * origin.cast<double>(),
                        std::vector<float>(static_cast<size_t>(kAzimuths) * kElevations, kNone)});
    for (const ScanPoint& point : scan.points) {
      View& view = views_[first + point.origin_index];
      const Vector3d ray = scan.map_from_scan * point.position.cast<double>() - view.origin;
      const auto [azimuth, elevation] = cell_of_direction(ray);
      float& range = view.min_range[index_of(azimuth, elevation)];
      range = std::min(range, static_cast<float>(ray.norm()));
    }
  }
}

bool ObservedFreeSpace::is_free(const Vector3d& point) const {
  for (const View& view : views_) {
    const Vector3d ray = point - view.origin;
    const double distance = ray.norm();
    const auto [azimuth, elevation] = cell_of_direction(ray);
    if (view.min_range[index_of(azimuth, elevation)] == kNone) continue;
    bool free = true;
    for (int e = std::max(elevation - 1, 0); e <= std::min(elevation + 1, kElevations - 1) && free; ++e)
      for (int a = azimuth - 1; a <= azimuth + 1 && free; ++a)
        free = view.min_range[index_of(a, e)] > distance + tolerance_;
    if (free) return true;
  }
  return false;
}

double ObservedFreeSpace::share_free(const std::vector<Vector3d>& points) const {
  size_t free = 0;
  for (const Vector3d& p : points) free += is_free(p);
  return points.empty() ? 0 : static_cast<double>(free) / static_cast<double>(points.size());
}

/// Points of a scan set within reach of a front, map frame.
std::vector<Vector3d> points_near(const ScanSet& set, const Front& front) {
  const double reach = std::max({front.width, front.height, front.depth}) + kFaceMotion.beside_m;
  std::vector<Vector3d> points;
  for (const Scan& scan : set.scans)
    for (const ScanPoint& point : scan.points) {
      if (!point.returned) continue;
      const Vector3d p = scan.map_from_scan * point.position.cast<double>();
      const Vector3d off = p - front.centre;
      const double out = off.dot(front.normal);
      if (out > -kFaceMotion.before_m && out < reach &&
          std::abs(off.dot(front.right())) < 0.5 * front.width + reach &&
          std::abs(off.dot(front.up)) < 0.5 * front.height + reach)
        points.push_back(p);
    }
  return points;
}

/// The joint by the path of the hand.
TrackResult fit_hand_path(const std::vector<Isometry3d>& hand_path) {
  Track track;
  for (const Isometry3d& pose : hand_path) {
    track.positions.push_back(pose.translation());
    track.orientations.emplace_back(pose.linear());
  }
  return fit_track(track, {});
}

/// Probabilities of the types by the front's shape, the path of the hand, and the share of the front that was
/// seen where each type predicts it (`support`).
std::array<double, 3> type_probabilities(const Front& front, const TrackResult* hand,
                                         const std::array<double, 3>& support) {
  std::array<double, 3> logs = joint_prior(front).probabilities;
  for (size_t i = 0; i < 3; ++i) {
    logs[i] = std::log(std::max(logs[i], kFaceMotion.min_probability)) +
              kFaceMotion.independent_cells * std::log(std::max(support[i], kFaceMotion.min_support));
    if (hand)
      logs[i] += std::log((1 - hand->unknown_probability) *
                              std::max(hand->estimate.probabilities[i], kFaceMotion.min_probability) +
                          hand->unknown_probability / 3);
  }
  const double largest = *std::max_element(logs.begin(), logs.end());
  double sum = 0;
  for (double& log : logs) sum += log = std::exp(log - largest);
  for (double& p : logs) p /= sum;
  return logs;
}

/// The joint fit to faces and hand.
Motion measured_motion(const Motion& start, const FittedPlane& closed, const FittedPlane* open,
                       const Front& front, const std::vector<Isometry3d>& hand_path,
                       const DifferenceOptions& options) {
  MotionEvidence evidence;
  evidence.closed = &closed;
  evidence.open = open;
  evidence.face_centre = front.centre - closed.normal * closed.distance(front.centre);
  evidence.hand_path = hand_path;
  evidence.hand_position_sigma_m = options.hand_position_sigma_m;
  evidence.hand_orientation_sigma_deg = options.hand_orientation_sigma_deg;
  evidence.expected_axis = closed.normal;
  if (start.type == ArticulationType::revolute)
    evidence.expected_axis = std::abs(start.axis.dot(front.up)) > std::abs(start.axis.dot(front.right()))
                                 ? front.up
                                 : front.right();
  if (evidence.expected_axis.dot(start.axis) < 0) evidence.expected_axis = -evidence.expected_axis;
  return fit_motion(start, evidence);
}

/// The closed rectangle by the outline of the moved face. An edge moves inwards only where the scan saw past
/// it.
Front corrected_front(const Front& front, const FittedPlane& closed, const MovedFace& found,
                      const std::vector<Vector3d>& moved, const ObservedFreeSpace& seen, double tolerance) {
  const Isometry3d moved_from_closed = found.motion.moved_from_closed();
  const Isometry3d closed_from_moved = moved_from_closed.inverse();
  Front corrected = front;
  corrected.normal = closed.normal;
  corrected.up = (front.up - closed.normal * closed.normal.dot(front.up)).normalized();
  corrected.centre = front.centre - closed.normal * closed.distance(front.centre);
  std::array<std::vector<double>, 2> places;
  for (const Vector3d& p : moved) {
    if (std::abs(found.open.distance(p)) > kFaceMotion.inlier_m) continue;
    const Vector3d off = closed_from_moved * p - corrected.centre;
    const Vector2d place(off.dot(corrected.right()), off.dot(corrected.up));
    if (std::abs(place.x()) > 0.5 * front.width + kOutline.beyond_m ||
        std::abs(place.y()) > 0.5 * front.height + kOutline.beyond_m)
      continue;
    // Near the closed plane, neighbouring fronts lie in it, too.
    if (std::abs(closed.distance(p)) < tolerance) continue;
    places[0].push_back(place.x());
    places[1].push_back(place.y());
  }
  if (places[0].size() < kFaceMotion.min_points) return corrected;
  const std::array<double, 2> half{0.5 * front.width, 0.5 * front.height};
  std::array<std::array<double, 2>, 2> edges;
  for (size_t k = 0; k < 2; ++k) {
    edges[k] = interval_of(places[k]);
    const Vector3d direction = k == 0 ? corrected.right() : corrected.up;
    const Vector3d across = k == 0 ? corrected.up : corrected.right();
    for (size_t side = 0; side < 2; ++side) {
      const double sign = side == 0 ? -1 : 1;
      if (found.motion.type == ArticulationType::revolute &&
          std::abs(found.motion.axis.dot(across)) > std::sqrt(0.5)) {
        // The edge at the hinge hardly moved: it is at the hinge.
        const double hinge = (found.motion.origin - corrected.centre).dot(direction);
        const double beyond = sign * (hinge - edges[k][side]);
        if (beyond > -kOutline.before_hinge_m && beyond < kOutline.behind_hinge_m) {
          edges[k][side] = hinge;
          continue;
        }
      }
      if (sign * edges[k][side] > half[k] - kOutline.min_inward_m) continue;
      std::vector<Vector3d> strip;
      for (double at = std::abs(edges[k][side]) + kOutline.cell_m; at < half[k]; at += kOutline.cell_m)
        for (double u = -0.4; u <= 0.4; u += 0.1)
          strip.push_back(moved_from_closed *
                          (corrected.centre + sign * at * direction + 2 * u * half[1 - k] * across));
      if (seen.share_free(strip) < kOutline.min_seen_past) edges[k][side] = sign * half[k];
    }
  }
  corrected.width = edges[0][1] - edges[0][0];
  corrected.height = edges[1][1] - edges[1][0];
  corrected.centre += 0.5 * (edges[0][0] + edges[0][1]) * corrected.right() +
                      0.5 * (edges[1][0] + edges[1][1]) * corrected.up;
  return corrected;
}

/// Whether a front can rotate about a hinge: the hinge is at an edge or behind it. As the known rectangle may
/// be too small by half, the hinge may be as far outside as the front is wide.
bool is_plausible_hinge(const Motion& hinge, const Front& front) {
  if (hinge.type != ArticulationType::revolute) return true;
  const double extent = std::hypot(front.width * hinge.axis.cross(front.right()).norm(),
                                   front.height * hinge.axis.cross(front.up).norm());
  return hinge.axis.cross(front.centre - hinge.origin).norm() < kOutline.max_hinge * extent;
}

/// Limits are the usual ones, extended to the position that was reached.
JointEstimate joint_of(const Motion& motion, const Front& front, const std::array<double, 3>& probabilities,
                       bool with_hand) {
  JointEstimate joint;
  joint.type = motion.type;
  joint.probabilities = probabilities;
  joint.axis = motion.axis;
  joint.origin = motion.origin;
  joint.axis_sd_deg = motion.axis_sd_deg;
  joint.origin_sd_m = motion.origin_sd_m;
  const double usual = motion.type == ArticulationType::prismatic ? 0.9 * front.depth : kPi / 2;
  joint.upper = std::max(usual, motion.position);
  joint.evidence = with_hand ? "interaction" : "difference";
  return joint;
}

}  // namespace

void DifferenceOptions::declare(OptionTable& table) {
  table.number("tolerance_m", tolerance_m, "m", "Nearer to what was there before does not count as a change.",
               0.005, 0.2);
  table.number("hand_position_sigma_m", hand_position_sigma_m, "m", "Noise of a hand's position.", 1e-5, 0.1);
  table.number("hand_orientation_sigma_deg", hand_orientation_sigma_deg, "deg",
               "Noise of a hand's orientation.", 0.001, 30);
}

MapFit fit_to_map(const ScanSet& scans, const std::vector<Front>& fronts, const DifferenceOptions& options) {
  const ObservedFreeSpace free(scans, options.tolerance_m);
  MapFit fit;
  for (const Front& front : fronts) {
    const int columns = std::max(2, static_cast<int>(front.width / kFaceMotion.fit_cell_m));
    const int rows = std::max(2, static_cast<int>(front.height / kFaceMotion.fit_cell_m));
    std::vector<uint8_t> covered(static_cast<size_t>(columns * rows), 0);
    for (const Vector3d& p : points_near(scans, front)) {
      const Vector3d off = p - front.centre;
      const double u = off.dot(front.right()) / front.width + 0.5, v = off.dot(front.up) / front.height + 0.5;
      if (std::abs(off.dot(front.normal)) < options.tolerance_m && u > 0 && u < 1 && v > 0 && v < 1)
        covered[static_cast<size_t>(static_cast<int>(v * rows) * columns + static_cast<int>(u * columns))] =
            1;
    }
    std::vector<Vector3d> face;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        face.push_back(front.centre + ((column + 0.5) / columns - 0.5) * front.width * front.right() +
                       ((row + 0.5) / rows - 0.5) * front.height * front.up);
    const double there =
        static_cast<double>(std::ranges::count(covered, 1)) / static_cast<double>(covered.size());
    if (there > kFaceMotion.min_fit)
      ++fit.there;
    else if (free.share_free(face) > kFaceMotion.min_fit)
      ++fit.looked_through;
    else
      ++fit.unseen;
  }
  return fit;
}

DifferenceResult articulate(const ScanSet& before, const ScanSet& after, const Front& front,
                            const std::vector<Isometry3d>& hand_path, const DifferenceOptions& options) {
  DifferenceOptions checked = options;
  table_of(checked).validate({"", 0, "articulate"});
  if (!(front.width > 0) || !(front.height > 0))
    throw Error("front '" + front.name + "' has no extent", {}, "give it a width and a height");
  const std::vector<Vector3d> points_before = points_near(before, front),
                              points_after = points_near(after, front);
  const ObservedFreeSpace free_before(before, front.centre, options.tolerance_m);
  std::vector<Vector3d> moved;
  const FittedPlane closed = closed_face(points_before, front);
  for (const Vector3d& p : points_after)
    if (free_before.is_free(p)) moved.push_back(p);

  DifferenceResult result;
  result.points = moved.size();
  std::optional<TrackResult> hand;
  if (hand_path.size() >= kFaceMotion.min_poses) hand = fit_hand_path(hand_path);
  std::array<std::optional<MovedFace>, 3> faces;
  if (moved.size() >= kFaceMotion.min_points) faces = moved_faces(closed, moved, front, options.tolerance_m);
  // A part that is still seen in its place did not move.
  const double static_part = static_share(points_after, closed, front);
  std::array<double, 3> support{static_part, 0, 0};
  for (size_t i = 0; i < 3; ++i)
    if (faces[i] && faces[i]->coverage > kFaceMotion.min_coverage)
      support[i] = (1 - static_part) * faces[i]->coverage;
  const auto most_probable = [](const std::array<double, 3>& types) {
    return static_cast<size_t>(std::ranges::max_element(types) - types.begin());
  };
  std::array<double, 3> probabilities = type_probabilities(front, hand ? &*hand : nullptr, support);
  size_t best = most_probable(probabilities);
  const bool seen = best > 0 && support[best] > 0;
  if (!seen && hand && hand->usable && hand->estimate.type != ArticulationType::rigid) {
    // What the hand led along a path moved, though the scans show another part in its place.
    probabilities = type_probabilities(front, &*hand, {0, 1, 1});
    best = most_probable(probabilities);
  }
  if (!seen) {
    result.reason = moved.size() < kFaceMotion.min_points
                        ? "only " + std::to_string(moved.size()) + " points in space that was free before"
                        : "the points in space that was free before are no front that slid or rotated";
    if (best == 0 || !hand || hand->estimate.type != static_cast<ArticulationType>(best)) return result;
    result.reason += "; the joint is from the path of the hand";
  }
  const Motion start = seen ? faces[best]->motion
                            : Motion{static_cast<ArticulationType>(best), hand->estimate.axis,
                                     hand->estimate.origin, hand->estimate.upper};
  const std::vector<Isometry3d> path = hand ? hand_path : std::vector<Isometry3d>();
  const Motion motion =
      measured_motion(start, closed, seen ? &faces[best]->open : nullptr, front, path, options);
  if (seen) {
    faces[best]->motion = motion;
    const ObservedFreeSpace free_after(after, front.centre, options.tolerance_m);
    result.corrected = corrected_front(front, closed, *faces[best], moved, free_after, options.tolerance_m);
  }
  if (!is_plausible_hinge(motion, front) &&
      !(result.corrected && is_plausible_hinge(motion, *result.corrected))) {
    result.corrected.reset();
    result.unexplained_motion = true;
    result.reason = "it neither slid nor rotated about a hinge that a front of this size can have";
    return result;
  }
  result.joint = joint_of(motion, front, probabilities, hand.has_value());
  result.moved = motion.position;
  if (!seen) return result;
  if (result.joint->type == ArticulationType::prismatic) result.joint->origin = result.corrected->centre;
  result.corrected->joint = result.joint;
  result.corrected->class_name = front_class(*result.corrected, *result.joint);
  return result;
}

Json DifferenceResult::report() const {
  Json json{{"type", joint ? Json(to_text(joint->type)) : Json("unknown")}};
  if (joint) {
    for (size_t i = 0; i < 3; ++i)
      json["probabilities"][to_text(static_cast<ArticulationType>(i))] = joint->probabilities[i];
    json["axis"] = json_from_vector(joint->axis);
    json["origin"] = json_from_vector(joint->origin);
    json["limits"] = Json::array({joint->lower, joint->upper});
    json["axis_sd_deg"] = joint->axis_sd_deg;
    json["origin_sd_m"] = joint->origin_sd_m;
    json["evidence"] = joint->evidence;
    json["moved"] = moved;
  }
  if (corrected)
    json["front"] = {{"centre", json_from_vector(corrected->centre)},
                     {"normal", json_from_vector(corrected->normal)},
                     {"up", json_from_vector(corrected->up)},
                     {"width", corrected->width},
                     {"height", corrected->height}};
  json["points"] = points;
  json["reason"] = reason;
  return json;
}

}  // namespace loci::mapping
