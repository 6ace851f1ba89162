#include "perception/annotators/structure/articulated_fronts.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "mapping/base/parallel.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {
namespace {

constexpr double kSpacing = 0.025;      ///< metres between points of a front
constexpr double kTolerance = 0.015;    ///< metres, plus twice the noise
constexpr double kThrough = 3;          ///< cost of a point in free space; one off by the tolerance costs 1
constexpr double kMinOn = 0.25;         ///< share of a front that must be seen for it to be determined
constexpr double kMaxThrough = 0.1;     ///< of those seen, that may lie in free space
constexpr double kMinCostGain = 0.1;    ///< of cost, for the given position to be given up
constexpr double kMinShown = 0.1;       ///< share of a whole front, in the image or not, that shows a motion
constexpr double kMinSeenAsOpen = 0.5;  ///< of what is in view, where one does not look through the front
constexpr int kFewPoints = 25;
constexpr int kPositions = 60;        ///< of a joint, tried first
constexpr TimeNs kWatched = kSecond;  ///< that a front is seen elsewhere in a video before it is there
constexpr double kReach = 0.5;        ///< metres before a front: what is further away is in nobody's way

}  // namespace

/// A front at a position against an image.
struct ArticulatedFronts::Match {
  int facing = 0;  ///< samples that look at the camera, in view or not
  int in_view = 0, on = 0, through = 0;
  double cost = 0;  ///< mean over those in view

  /// Whether it cannot become a sure one that costs less than `best`, when at most so many more come into
  /// view; `cost` is the sum of those so far.
  bool is_lost(int more, const Match& best) const {
    return through > kMaxThrough * (on + more) || (best.sure() && cost >= best.cost * (in_view + more));
  }
  bool sure() const { return in_view >= kFewPoints && on >= kMinOn * in_view && through <= kMaxThrough * on; }
  /// Whether it is enough to say that a front has left the position of `given`. What stands before a front
  /// may look like a part of it elsewhere, so where one does not look through the front, most of it has to be
  /// seen.
  bool shows_motion_from(const Match& given) const {
    const bool looked_through = given.through > kMaxThrough * given.in_view;
    return on >= kMinShown * facing && (looked_through || on >= kMinSeenAsOpen * in_view);
  }
};

ArticulatedFronts::ArticulatedFronts(const mapping::World& world, const mapping::MeshSearch& meshes)
    : world_(world) {
  for (const mapping::Joint& joint : world.joints) {
    const bool slides = joint.type == mapping::JointType::prismatic,
               turns = joint.type == mapping::JointType::revolute;
    if (!(slides || turns) || !joint.limits || joint.mimic) continue;
    if (!(joint.limits->upper > joint.limits->lower)) continue;
    Front front;
    front.joint = joint;
    front.link = world.link_index(joint.child);
    for (const mapping::Visual& visual : world.links[front.link].visuals)
      add_surface_samples(visual, meshes, kSpacing, front.samples);
    if (front.samples.size() < static_cast<size_t>(kFewPoints)) continue;
    Eigen::AlignedBox3d box;
    for (const SurfaceSample& sample : front.samples) {
      box.extend(sample.point);
      front.reach = std::max(front.reach, sample.point.cross(joint.axis.normalized()).norm());
    }
    front.middle = box.center();
    front.radius = box.diagonal().norm() / 2;
    fronts_.push_back(std::move(front));
  }
}

ArticulatedFronts::Match ArticulatedFronts::match(const Front& front, const Isometry3d& camera_from_link,
                                                  const cv::Mat& points, const mapping::PinholeCamera& camera,
                                                  const Match* best) const {
  Match match;
  if (out_of_view(camera_from_link * front.middle, front.radius, camera)) return match;
  const auto* measured = points.ptr<cv::Vec3f>();
  auto left = static_cast<int>(front.samples.size());
  const Vector3d eye = camera_from_link.inverse().translation();
  for (const SurfaceSample& sample : front.samples) {
    // What stands open in the image's free space is soon found out.
    if (best && match.is_lost(left, *best)) return {};
    --left;
    if (sample.normal.dot(eye - sample.point) < 0) continue;  // Half of them look away.
    const Vector3d point = camera_from_link * sample.point;
    if ((camera_from_link.linear() * sample.normal).dot(-point) < kFacing * point.norm()) continue;
    ++match.facing;
    const int pixel = pixel_of(point, camera);
    if (pixel < 0) continue;
    const auto depth = static_cast<double>(measured[pixel][2]);
    if (std::isnan(depth)) continue;
    const double off = (depth - point.z()) / (kTolerance + 2 * depth_noise(point.z()));
    ++match.in_view;
    if (std::abs(off) <= 1) ++match.on;
    if (off > 1) ++match.through;
    match.cost += off > 1 ? kThrough : std::min(1.0, off * off);
  }
  if (match.in_view > 0) match.cost /= match.in_view;
  return match;
}

std::vector<FrontState> ArticulatedFronts::estimate(const cv::Mat& points,
                                                    const mapping::PinholeCamera& camera,
                                                    const Isometry3d& map_from_camera,
                                                    const JointState& joints, int threads) const {
  const std::vector<Isometry3d> map_from_links = root_from_links(world_, joints);
  const Isometry3d camera_from_map = map_from_camera.inverse();
  std::vector<FrontState> states(fronts_.size());
  const auto estimate_one = [&](size_t number) {
    const Front& front = fronts_[number];
    FrontState& state = states[number];
    state.joint = front.joint.name;
    if (front.joint.type == mapping::JointType::revolute) state.reach = front.reach;
    if (const auto given = joints.find(state.joint); given != joints.end()) state.given = given->second;
    state.position = state.given;
    const Isometry3d camera_from_joint =
        camera_from_map * map_from_links[front.link] * joint_motion(front.joint, state.given).inverse();
    const auto at = [&](double position, const Match* best) {
      return match(front, camera_from_joint * joint_motion(front.joint, position), points, camera, best);
    };
    const Match given = at(state.given, nullptr);
    const double low = front.joint.limits->lower, high = front.joint.limits->upper;
    Match best = given;
    const auto consider = [&](double position) {
      const Match tried = at(std::clamp(position, low, high), &best);
      if (!tried.sure() || (best.sure() && tried.cost >= best.cost)) return;
      best = tried;
      state.position = std::clamp(position, low, high);
    };
    const double step = (high - low) / kPositions;
    for (int i = 0; i <= kPositions; ++i) consider(low + i * step);
    for (double fine = step / 2; best.sure() && fine > step / 40; fine /= 2) {
      const double around = state.position;
      consider(around - fine);
      consider(around + fine);
    }
    const double shift = state.reach * std::abs(state.position - state.given);
    const bool differs =
        best.sure() && (!given.sure() || best.cost < given.cost - kMinCostGain) && shift >= kMinFrontMotion;
    const double range = (camera_from_joint * joint_motion(front.joint, state.given) * front.middle).z();
    state.moved = differs && shift >= kMinFrontMotion + kDistortion * depth_noise(range) &&
                  best.shows_motion_from(given);
    // Between the two the image shows neither that the front moved nor that it did not.
    state.determined = best.sure() && state.moved == differs;
    if (!state.moved) state.position = state.given;
    const Match& kept = state.moved ? best : given;
    state.in_view = kept.in_view;
    state.on = kept.on;
  };
  parallel_for(fronts_.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) estimate_one(i);
  });
  return states;
}

std::vector<Obstacle> ArticulatedFronts::obstacles(const cv::Mat& points, const cv::Mat& unknown,
                                                   const mapping::PinholeCamera& camera,
                                                   const Isometry3d& map_from_camera,
                                                   const JointState& joints) const {
  const std::vector<Isometry3d> map_from_links = root_from_links(world_, joints);
  std::vector<Obstacle> found;
  for (const Front& front : fronts_) {
    const Isometry3d camera_from_link = map_from_camera.inverse() * map_from_links[front.link];
    if (out_of_view(camera_from_link * front.middle, front.radius, camera)) continue;
    int in_view = 0, hidden = 0;
    Obstacle obstacle{front.joint.name, std::numeric_limits<double>::infinity(), 0};
    for (const SurfaceSample& sample : front.samples) {
      const Vector3d point = camera_from_link * sample.point;
      const Vector3d normal = camera_from_link.linear() * sample.normal;
      const int pixel = pixel_of(point, camera);
      if (pixel < 0 || normal.dot(-point) < kFacing * point.norm()) continue;
      ++in_view;
      const Vector3d seen = to_vector(points.ptr<cv::Vec3f>()[pixel]);
      if (std::isnan(seen.z()) || unknown.ptr<uint8_t>()[pixel] == 0) continue;
      const double before = normal.dot(seen - point);
      if (before < kTolerance + 2 * depth_noise(seen.z()) || before > kReach) continue;
      ++hidden;
      obstacle.distance_m = std::min(obstacle.distance_m, before);
    }
    if (in_view < kFewPoints || hidden < kFewPoints / 5 || hidden < 0.03 * in_view) continue;
    obstacle.share = static_cast<double>(hidden) / in_view;
    found.push_back(obstacle);
  }
  return found;
}

void FrontTracks::settle(FrontState& state, TimeNs time, bool in_video) {
  if (!state.determined) return;
  Track& track = tracks_.try_emplace(state.joint, Track{state.given, {}}).first->second;
  const auto seen_at = [&](double position) {
    return state.reach * std::abs(state.position - position) < kMinFrontMotion;
  };
  if (!seen_at(track.position)) {
    if (!track.pending || !seen_at(track.pending->position)) track.pending = {state.position, time};
    state.determined = !in_video || time - track.pending->since >= kWatched;
    if (state.determined) track.position = state.position;
  }
  if (state.determined) track.pending.reset();
  state.position = state.determined ? track.position : state.given;
  state.moved = state.determined && state.reach * std::abs(state.position - state.given) >= kMinFrontMotion;
}

}  // namespace loci::perception
