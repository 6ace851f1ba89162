#include <algorithm>
#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/articulation/free_space.h"
#include "mapping/articulation/joint_fit.h"
#include "mapping/articulation/moved_face.h"
#include "mapping/base/json.h"
#include "mapping/base/math.h"

namespace loci::mapping {
namespace {

using Type = JointEstimate::Type;
constexpr double kMinCoverage = 0.35;  ///< of the front's rectangle by the moved face
constexpr size_t kMinPoints = 40;
constexpr size_t kMinPoses = 5;  ///< of a hand's path that can tell line from arc
/// Neighbouring cells of a face are right or wrong together: its coverage counts as so many looks.
constexpr double kLooks = 4;
constexpr double kMinSupport = 0.02;

/// Points of a scan set within reach of a front, map frame.
std::vector<Vector3d> points_near(const ScanSet& set, const Front& front) {
  const double reach = std::max({front.width, front.height, front.depth}) + 0.15;
  std::vector<Vector3d> points;
  for (const Scan& scan : set.scans)
    for (const ScanPoint& point : scan.points) {
      if (!point.returned) continue;
      const Vector3d p = scan.map_from_scan * point.position.cast<double>();
      const Vector3d off = p - front.centre;
      const double out = off.dot(front.normal);
      if (out > -0.1 && out < reach && std::abs(off.dot(front.right())) < 0.5 * front.width + reach &&
          std::abs(off.dot(front.up)) < 0.5 * front.height + reach)
        points.push_back(p);
    }
  return points;
}

/// What the hand felt.
TrackResult felt_along(const std::vector<Isometry3d>& hand_path) {
  Track track;
  for (const Isometry3d& pose : hand_path) {
    track.positions.push_back(pose.translation());
    track.orientations.emplace_back(pose.linear());
  }
  return fit_track(track, {});
}

/// How probable the types are: by the front's shape, by the path of the hand, and by how much of the front
/// is seen where each type puts it (a rigid one: where it was).
std::array<double, 3> weigh_types(const Front& front, const TrackResult* felt,
                                  const std::array<double, 3>& support) {
  std::array<double, 3> logs = joint_prior(front).probabilities;
  for (size_t i = 0; i < 3; ++i) {
    logs[i] = std::log(std::max(logs[i], 1e-4)) + kLooks * std::log(std::max(support[i], kMinSupport));
    if (felt)
      logs[i] += std::log((1 - felt->unknown_probability) * std::max(felt->estimate.probabilities[i], 1e-4) +
                          felt->unknown_probability / 3);
  }
  const double largest = *std::max_element(logs.begin(), logs.end());
  double sum = 0;
  for (double& log : logs) sum += log = std::exp(log - largest);
  for (double& p : logs) p /= sum;
  return logs;
}

/// The motion that faces and hand agree on.
Motion measured_motion(const Motion& start, const Face& closed, const Face* open, const Front& front,
                       const std::vector<Isometry3d>& hand_path, const DifferenceOptions& options) {
  MotionEvidence evidence;
  evidence.closed = &closed;
  evidence.open = open;
  evidence.face_centre = front.centre - closed.normal * closed.distance(front.centre);
  evidence.hand_path = hand_path;
  evidence.hand_position_sigma_m = options.hand_position_sigma_m;
  evidence.hand_orientation_sigma_deg = options.hand_orientation_sigma_deg;
  evidence.habitual_axis = closed.normal;
  if (start.type == Type::revolute)
    evidence.habitual_axis = std::abs(start.axis.dot(front.up)) > std::abs(start.axis.dot(front.right()))
                                 ? front.up
                                 : front.right();
  if (evidence.habitual_axis.dot(start.axis) < 0) evidence.habitual_axis = -evidence.habitual_axis;
  return fit_motion(start, evidence);
}

/// The closed rectangle by the outline of the moved face. An edge is drawn in only where the scan saw past
/// it.
Front corrected_front(const Front& front, const Face& closed, const MovedFace& found,
                      const std::vector<Vector3d>& moved, const FreeSpace& seen, double tolerance) {
  const Isometry3d moved_from_closed = found.motion.moved_from_closed();
  const Isometry3d closed_from_moved = moved_from_closed.inverse();
  Front corrected = front;
  corrected.normal = closed.normal;
  corrected.up = (front.up - closed.normal * closed.normal.dot(front.up)).normalized();
  corrected.centre = front.centre - closed.normal * closed.distance(front.centre);
  std::array<std::vector<double>, 2> places;
  for (const Vector3d& p : moved) {
    if (std::abs(found.open.distance(p)) > 0.02) continue;
    const Vector3d off = closed_from_moved * p - corrected.centre;
    const Vector2d place(off.dot(corrected.right()), off.dot(corrected.up));
    if (std::abs(place.x()) > 0.5 * front.width + 0.3 || std::abs(place.y()) > 0.5 * front.height + 0.3)
      continue;
    // Where the face is still near where it was closed, neighbours are in its plane too.
    if (std::abs(closed.distance(p)) < tolerance) continue;
    places[0].push_back(place.x());
    places[1].push_back(place.y());
  }
  if (places[0].size() < kMinPoints) return corrected;
  const std::array<double, 2> half{0.5 * front.width, 0.5 * front.height};
  std::array<std::array<double, 2>, 2> edges;
  for (size_t k = 0; k < 2; ++k) {
    edges[k] = outline_of(places[k]);
    const Vector3d direction = k == 0 ? corrected.right() : corrected.up;
    const Vector3d across = k == 0 ? corrected.up : corrected.right();
    for (size_t side = 0; side < 2; ++side) {
      const double sign = side == 0 ? -1 : 1;
      if (found.motion.type == Type::revolute && std::abs(found.motion.axis.dot(across)) > 0.7) {
        // The edge at the hinge hardly moved; it is where the hinge is.
        const double hinge = (found.motion.origin - corrected.centre).dot(direction);
        if (sign * (hinge - edges[k][side]) > -0.02 && sign * (hinge - edges[k][side]) < 0.12) {
          edges[k][side] = hinge;
          continue;
        }
      }
      if (sign * edges[k][side] > half[k] - 0.015) continue;
      std::vector<Vector3d> strip;
      for (double at = std::abs(edges[k][side]) + 0.01; at < half[k]; at += 0.01)
        for (double u = -0.4; u <= 0.4; u += 0.1)
          strip.push_back(moved_from_closed *
                          (corrected.centre + sign * at * direction + 2 * u * half[1 - k] * across));
      if (seen.share_free(strip) < 0.5) edges[k][side] = sign * half[k];
    }
  }
  corrected.width = edges[0][1] - edges[0][0];
  corrected.height = edges[1][1] - edges[1][0];
  corrected.centre += 0.5 * (edges[0][0] + edges[0][1]) * corrected.right() +
                      0.5 * (edges[1][0] + edges[1][1]) * corrected.up;
  return corrected;
}

/// Whether a front may hang on a hinge there: at an edge, or behind it. What is known of its rectangle may be
/// too small by half, so that the hinge may be as far outside as the front is wide.
bool can_hang_on(const Motion& hinge, const Front& front) {
  if (hinge.type != Type::revolute) return true;
  const double extent = std::hypot(front.width * hinge.axis.cross(front.right()).norm(),
                                   front.height * hinge.axis.cross(front.up).norm());
  return hinge.axis.cross(front.centre - hinge.origin).norm() < 1.5 * extent;
}

/// Limits are as wide as usual, and contain what was reached.
JointEstimate joint_of(const Motion& motion, const Front& front, const std::array<double, 3>& probabilities,
                       bool felt) {
  JointEstimate joint;
  joint.type = motion.type;
  joint.probabilities = probabilities;
  joint.axis = motion.axis;
  joint.origin = motion.origin;
  joint.axis_sd_deg = motion.axis_sd_deg;
  joint.origin_sd_m = motion.origin_sd_m;
  const double usual = motion.type == Type::prismatic ? 0.9 * front.depth : kPi / 2;
  joint.upper = std::max(usual, motion.position);
  joint.evidence = felt ? "interaction" : "difference";
  return joint;
}

}  // namespace

void DifferenceOptions::declare(OptionTable& table) {
  table.number("tolerance_m", tolerance_m, "m", "Nearer to what was there before is no change.", 0.005, 0.2);
  table.number("hand_position_sigma_m", hand_position_sigma_m, "m", "Noise of a hand's position.", 1e-5, 0.1);
  table.number("hand_orientation_sigma_deg", hand_orientation_sigma_deg, "deg",
               "Noise of a hand's orientation.", 0.001, 30);
}

DifferenceResult articulate(const ScanSet& before, const ScanSet& after, const Front& front,
                            const std::vector<Isometry3d>& hand_path, const DifferenceOptions& options) {
  if (!(front.width > 0) || !(front.height > 0))
    throw Error("front '" + front.name + "' has no extent", {}, "give it a width and a height");
  const std::vector<Vector3d> points_before = points_near(before, front),
                              points_after = points_near(after, front);
  const FreeSpace free_before(before, front.centre, options.tolerance_m);
  std::vector<Vector3d> moved;
  const Face closed = closed_face(points_before, front);
  for (const Vector3d& p : points_after)
    if (free_before.is_free(p)) moved.push_back(p);

  DifferenceResult result;
  result.points = moved.size();
  std::optional<TrackResult> felt;
  if (hand_path.size() >= kMinPoses) felt = felt_along(hand_path);
  std::array<std::optional<MovedFace>, 3> faces;
  if (moved.size() >= kMinPoints) faces = moved_faces(closed, moved, front, options.tolerance_m);
  // What is still seen in its place did not move, whatever a neighbour did.
  const double still = still_share(points_after, closed, front);
  std::array<double, 3> support{still, 0, 0};
  for (size_t i = 0; i < 3; ++i)
    if (faces[i] && faces[i]->coverage > kMinCoverage) support[i] = (1 - still) * faces[i]->coverage;
  const std::array<double, 3> probabilities = weigh_types(front, felt ? &*felt : nullptr, support);
  const size_t best = static_cast<size_t>(std::max_element(probabilities.begin(), probabilities.end()) -
                                          probabilities.begin());
  const bool seen = best > 0 && support[best] > 0;
  if (!seen) {
    result.reason =
        moved.size() < kMinPoints
            ? "nothing stands where space was free before: " + std::to_string(moved.size()) + " points"
            : "what stands where space was free before is no front that slid or turned";
    if (best == 0 || !felt || felt->estimate.type != static_cast<Type>(best)) return result;
    result.reason += "; the joint is as the hand felt it";
  }
  Motion start{static_cast<Type>(best)};
  if (seen)
    start = faces[best]->motion;
  else
    start = {start.type, felt->estimate.axis, felt->estimate.origin, felt->estimate.upper};
  const std::vector<Isometry3d> path = felt ? hand_path : std::vector<Isometry3d>();
  const Motion motion =
      measured_motion(start, closed, seen ? &faces[best]->open : nullptr, front, path, options);
  if (seen) {
    faces[best]->motion = motion;
    const FreeSpace free_after(after, front.centre, options.tolerance_m);
    result.corrected = corrected_front(front, closed, *faces[best], moved, free_after, options.tolerance_m);
  }
  if (!can_hang_on(motion, front) && !(result.corrected && can_hang_on(motion, *result.corrected))) {
    result.corrected.reset();
    result.moves_otherwise = true;
    result.reason = "it neither slid nor turned about a hinge that a front of this size can have";
    return result;
  }
  result.joint = joint_of(motion, front, probabilities, felt.has_value());
  result.moved = motion.position;
  if (!seen) return result;
  if (result.joint->type == Type::prismatic) result.joint->origin = result.corrected->centre;
  result.corrected->joint = result.joint;
  result.corrected->class_name = front_class(*result.corrected, *result.joint);
  return result;
}

Json DifferenceResult::report() const {
  const auto json_of = [](const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); };
  Json json{{"type", joint ? Json(joint_estimate_type_name(joint->type)) : Json("unknown")}};
  if (joint) {
    for (size_t i = 0; i < 3; ++i)
      json["probabilities"][joint_estimate_type_name(static_cast<Type>(i))] = joint->probabilities[i];
    json["axis"] = json_of(joint->axis);
    json["origin"] = json_of(joint->origin);
    json["limits"] = Json::array({joint->lower, joint->upper});
    json["axis_sd_deg"] = joint->axis_sd_deg;
    json["origin_sd_m"] = joint->origin_sd_m;
    json["evidence"] = joint->evidence;
    json["moved"] = moved;
  }
  if (corrected)
    json["front"] = {{"centre", json_of(corrected->centre)},
                     {"normal", json_of(corrected->normal)},
                     {"up", json_of(corrected->up)},
                     {"width", corrected->width},
                     {"height", corrected->height}};
  json["points"] = points;
  json["reason"] = reason;
  return json;
}

}  // namespace loci::mapping
