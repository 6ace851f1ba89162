#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/articulation/face.h"
#include "mapping/articulation/free_space.h"

namespace loci {
namespace {

using Type = JointEstimate::Type;
constexpr double kPi = 3.14159265358979323846;
constexpr double kHingeBehindFace = 0.01;  ///< as in the prior: the middle of a panel
constexpr double kParallelDeg = 4;         ///< faces that differ by less did not turn
constexpr double kLeastCoverage = 0.35;    ///< of the front's rectangle by the moved face
constexpr size_t kLeastPoints = 40;

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

/// The closed face: the plane through what was seen of it before.
Face closed_face(const std::vector<Vector3d>& before, const Front& front) {
  std::vector<Vector3d> on_face;
  for (const Vector3d& p : before) {
    const Vector3d off = p - front.centre;
    if (std::abs(off.dot(front.normal)) < 0.04 && std::abs(off.dot(front.right())) < 0.45 * front.width &&
        std::abs(off.dot(front.up)) < 0.45 * front.height)
      on_face.push_back(p);
  }
  const Face assumed{front.normal, front.normal.dot(front.centre), 0.01, 0};
  return on_face.size() < kLeastPoints ? assumed : refined_face(assumed, on_face, 0.03);
}

/// How a part moved: the rigid motion at the position reached, and the joint.
struct Motion {
  Type type = Type::rigid;
  Vector3d axis = Vector3d::UnitX(), origin = Vector3d::Zero();
  double position = 0;
  double axis_sd_deg = 0, origin_sd_m = 0;

  Isometry3d moved_from_closed() const {
    Isometry3d motion = Isometry3d::Identity();
    if (type == Type::prismatic) motion.translation() = position * axis;
    if (type == Type::revolute) {
      motion.linear() = Eigen::AngleAxisd(position, axis).toRotationMatrix();
      motion.translation() = origin - motion.linear() * origin;
    }
    return motion;
  }
};

Motion slid(const Face& closed, const Face& open, const Front& front) {
  Motion motion;
  motion.type = Type::prismatic;
  motion.axis = closed.normal;
  motion.origin = front.centre;
  motion.position = open.offset - closed.normal.dot(closed.normal * closed.offset);
  // Two planes do not show a shift within them: the slide may run off the normal by some degrees.
  motion.axis_sd_deg = 2;
  motion.origin_sd_m = 0.01;
  return motion;
}

/// The turn between two planes; `moved` tells to which side of the hinge the part went.
Motion turned(const Face& closed, const Face& open, const Front& front, const Vector3d& moved) {
  Motion motion;
  motion.type = Type::revolute;
  motion.axis = closed.normal.cross(open.normal).normalized();
  Eigen::Matrix3d planes;
  planes << closed.normal.transpose(), open.normal.transpose(), motion.axis.transpose();
  const Vector3d line =
      planes.fullPivLu().solve(Vector3d(closed.offset, open.offset, motion.axis.dot(front.centre)));
  const Vector3d handle = front.fixture ? front.fixture->centre : front.centre;
  const auto level = [&](const Vector3d& p) { return Vector3d(p - motion.axis * motion.axis.dot(p)); };
  const Vector3d from = level(handle - line), to = level(moved - line);
  Vector3d open_normal = open.normal;
  motion.position = std::atan2(from.cross(to).dot(motion.axis), from.dot(to));
  if (motion.position < 0) {
    motion.axis = -motion.axis;
    motion.position = -motion.position;
  }
  if (open_normal.dot(Eigen::AngleAxisd(motion.position, motion.axis) * closed.normal) < 0)
    open_normal = -open_normal;
  const double angle =
      std::atan2(closed.normal.cross(open_normal).dot(motion.axis), closed.normal.dot(open_normal));
  if (angle > 0) motion.position = angle;
  // The faces touch a cylinder about the hinge, which lies behind both: on the line that halves their angle.
  const Vector3d between = (closed.normal + open_normal).normalized();
  motion.origin = line - between * kHingeBehindFace / std::max(between.dot(closed.normal), 0.2);
  motion.axis_sd_deg =
      std::hypot(closed.normal_sd, open.normal_sd) * 180 / kPi / std::max(std::sin(motion.position), 0.05);
  motion.origin_sd_m = 0.01;
  return motion;
}

/// How much of the closed rectangle the moved face covers once it is put back, by cells of 3 cm.
double coverage(const Motion& motion, const Face& open, const std::vector<Vector3d>& moved,
                const Front& front) {
  const Isometry3d closed_from_moved = motion.moved_from_closed().inverse();
  const int columns = std::max(1, static_cast<int>(front.width / 0.03)),
            rows = std::max(1, static_cast<int>(front.height / 0.03));
  std::vector<char> seen(static_cast<size_t>(columns * rows), 0);
  for (const Vector3d& p : moved) {
    if (std::abs(open.distance(p)) > 0.025) continue;
    const Vector3d off = closed_from_moved * p - front.centre;
    const int column = static_cast<int>(std::floor((off.dot(front.right()) / front.width + 0.5) * columns));
    const int row = static_cast<int>(std::floor((off.dot(front.up) / front.height + 0.5) * rows));
    if (column >= 0 && column < columns && row >= 0 && row < rows)
      seen[static_cast<size_t>(row * columns + column)] = 1;
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), 1)) / static_cast<double>(seen.size());
}

struct Hypothesis {
  Motion motion;
  Face open;
  double coverage = 0;
};

/// Slid out, or turned about an upright or a level hinge: the best face of each kind.
std::optional<Hypothesis> explain(const Face& closed, const std::vector<Vector3d>& moved, const Front& front,
                                  double tolerance) {
  std::optional<Hypothesis> best;
  const auto consider = [&](const Motion& motion, const Face& open) {
    if (motion.type == Type::prismatic && motion.position < tolerance) return;
    if (motion.type == Type::revolute && (motion.position < kParallelDeg * kPi / 180)) return;
    const double covered = coverage(motion, open, moved, front);
    if (covered > kLeastCoverage && (!best || covered > best->coverage + 0.1)) best = {motion, open, covered};
  };
  // A face that stayed parallel comes first: what is inside a drawer may look like a flap.
  if (const auto open = find_face(moved, [&](const Vector3d& n) {
        return std::abs(n.dot(closed.normal)) > std::cos(kParallelDeg * kPi / 180);
      })) {
    Face face = *open;
    if (face.normal.dot(closed.normal) < 0) face = face.flipped();
    consider(slid(closed, face, front), face);
  }
  if (best) return best;
  for (const Vector3d& hinge : {front.up, front.right()})
    if (const auto open = find_face(moved, [&](const Vector3d& n) {
          return std::abs(n.dot(hinge)) < std::sin(8 * kPi / 180) &&
                 std::abs(n.dot(closed.normal)) < std::cos(kParallelDeg * kPi / 180);
        })) {
      Vector3d centre = Vector3d::Zero();
      size_t count = 0;
      for (const Vector3d& p : moved)
        if (std::abs(open->distance(p)) < 0.025) {
          centre += p;
          ++count;
        }
      consider(turned(closed, *open, front, centre / static_cast<double>(count)), *open);
    }
  return best;
}

/// What the hand felt: the path of the gripper says where the joint is more finely than two planes do.
void follow_hand(const std::vector<Isometry3d>& hand_path, Motion& motion) {
  Track track;
  for (const Isometry3d& pose : hand_path) track.positions.push_back(pose.translation());
  const TrackResult felt = fit_track(track, {});
  if (!felt.usable || felt.estimate.type == Type::rigid) return;
  const auto fit = static_cast<size_t>(motion.type);
  const TrackFit& path = felt.fits[fit];
  const bool agrees = felt.estimate.type == motion.type;
  if (!agrees || felt.estimate.probabilities[fit] < 0.5) return;
  const double sense = path.axis.dot(motion.axis) < 0 ? -1 : 1;
  if (felt.estimate.axis_sd_deg < motion.axis_sd_deg) {
    motion.axis = sense * path.axis;
    motion.axis_sd_deg = felt.estimate.axis_sd_deg;
  }
  if (motion.type == Type::revolute && felt.estimate.origin_sd_m < motion.origin_sd_m) {
    motion.origin = path.centre;
    motion.origin_sd_m = felt.estimate.origin_sd_m;
  }
}

/// What the hand felt where nothing was seen to move.
std::optional<Motion> felt_motion(const std::vector<Isometry3d>& hand_path) {
  if (hand_path.size() < 5) return std::nullopt;
  Track track;
  for (const Isometry3d& pose : hand_path) track.positions.push_back(pose.translation());
  const TrackResult felt = fit_track(track, {});
  const auto type = static_cast<size_t>(felt.estimate.type);
  if (!felt.usable || felt.estimate.type == Type::rigid || felt.estimate.probabilities[type] < 0.8)
    return std::nullopt;
  return Motion{felt.estimate.type,  felt.estimate.axis,        felt.estimate.origin,
                felt.estimate.upper, felt.estimate.axis_sd_deg, felt.estimate.origin_sd_m};
}

/// The closed rectangle by the outline of the moved face. An edge is drawn in only where the scan saw past
/// it.
Front corrected_front(const Front& front, const Face& closed, const Hypothesis& found,
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
  if (places[0].size() < kLeastPoints) return corrected;
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

/// Limits are as wide as usual, and contain what was reached.
JointEstimate joint_of(const Motion& motion, const Front& front, double certainty, bool felt) {
  JointEstimate joint;
  joint.type = motion.type;
  joint.probabilities.fill((1 - certainty) / 2);
  joint.probabilities[static_cast<size_t>(motion.type)] = certainty;
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
}

DifferenceResult articulate(const ScanSet& before, const ScanSet& after, const Front& front,
                            const std::vector<Isometry3d>& hand_path, const DifferenceOptions& options) {
  if (!(front.width > 0) || !(front.height > 0))
    throw Error("front '" + front.name + "' has no extent", {}, "give it a width and a height");
  const std::vector<Vector3d> points_before = points_near(before, front),
                              points_after = points_near(after, front);
  const FreeSpace free_before(before, front.centre, options.tolerance_m);
  std::vector<Vector3d> moved;
  for (const Vector3d& p : points_after)
    if (free_before.is_free(p)) moved.push_back(p);

  DifferenceResult result;
  result.points = moved.size();
  const Face closed = closed_face(points_before, front);
  std::optional<Hypothesis> found;
  if (moved.size() >= kLeastPoints) found = explain(closed, moved, front, options.tolerance_m);
  if (!found) {
    result.reason =
        moved.size() < kLeastPoints
            ? "nothing stands where space was free before: " + std::to_string(moved.size()) + " points"
            : "what stands where space was free before is no front that slid or turned";
    const std::optional<Motion> felt = felt_motion(hand_path);
    if (!felt) return result;
    result.reason += "; the joint is as the hand felt it";
    result.joint = joint_of(*felt, front, 0.9, true);
    result.moved = felt->position;
    return result;
  }
  const bool felt = hand_path.size() >= 5;
  if (felt) follow_hand(hand_path, found->motion);
  result.joint = joint_of(found->motion, front, 0.97, felt);
  result.moved = found->motion.position;
  const FreeSpace free_after(after, front.centre, options.tolerance_m);
  result.corrected = corrected_front(front, closed, *found, moved, free_after, options.tolerance_m);
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

}  // namespace loci
