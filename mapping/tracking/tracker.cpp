#include "mapping/tracking/tracker.h"

#include <algorithm>
#include <cmath>

namespace loci::mapping::tracking {
namespace {

constexpr double kMinMeasured = 0.05;  ///< part of an image with depth: with less nothing is tracked
constexpr double kMaxGap = 1.0;        ///< s; after a longer one the velocity is not known

double seconds_between(TimeNs from, TimeNs to) {
  return static_cast<double>(to - from) / static_cast<double>(kSecond);
}

double angle_of(const Isometry3d& motion) {
  return Eigen::AngleAxisd(motion.linear()).angle();
}

Vector6d vector_of(const Isometry3d& motion) {
  const Eigen::AngleAxisd turn(motion.linear());
  Vector6d v;
  v << motion.translation(), turn.angle() * turn.axis();
  return v;
}

/// Given poses hold the whole where they are, but not against what is measured.
PoseConstraint given_pose(size_t keyframe, const Isometry3d& pose) {
  constexpr double kShift = 0.05, kTurn = 2 * kDegree;
  PoseConstraint constraint{PoseConstraint::kMap, keyframe, pose, Matrix6d::Zero()};
  constraint.information.diagonal() << Vector3d::Constant(1 / (kShift * kShift)),
      Vector3d::Constant(1 / (kTurn * kTurn));
  return constraint;
}

}  // namespace

FrameResult Tracker::add(PreparedFrame frame) {
  FrameResult result;
  if (frame.images.measured < kMinMeasured) {
    result.objection = "there is hardly any depth in range";
    return result;
  }
  if (keyframes_.empty()) {
    result.keyframe = 0;
    remember(frame, frame.given.value_or(Isometry3d::Identity()));
    add_keyframe(std::move(frame), nullptr);
    return result;
  }
  const std::optional<Located> located = locate(frame);
  if (!located) {
    result.objection = objection_;
    if (undetermined_) remember(frame, *undetermined_);  // The start of the next frame, no more.
    return result;
  }
  const Isometry3d pose = located->alignment.map_from_camera;
  remember(frame, pose);
  result.covariance = located->alignment.covariance().value();
  result.keyframe = located->references.front();
  result.keyframe_from_camera = map_from_keyframes_[*result.keyframe].inverse() * pose;
  if (wants_keyframe(*located)) {
    result.keyframe = keyframes_.size();
    result.keyframe_from_camera = Isometry3d::Identity();
    add_keyframe(std::move(frame), &*located);
    last_->pose = map_from_keyframes_.back();  // Loops may have moved it.
  } else {
    keyframes_[*result.keyframe]->fuse(frame.images, result.keyframe_from_camera.inverse());
  }
  return result;
}

void Tracker::remember(const PreparedFrame& frame, const Isometry3d& pose) {
  Last now{frame.time_ns, frame.number, pose, frame.features, frame.given, Vector6d::Zero()};
  if (last_) {
    const double seconds = seconds_between(last_->time_ns, frame.time_ns);
    if (seconds > 1e-4 && seconds < kMaxGap) now.velocity = vector_of(last_->pose.inverse() * pose) / seconds;
  }
  last_ = std::move(now);
}

Isometry3d Tracker::predicted(const PreparedFrame& frame) const {
  if (frame.given && last_->given) return last_->pose * (last_->given->inverse() * *frame.given);
  const double seconds = seconds_between(last_->time_ns, frame.time_ns);
  if (seconds > kMaxGap) return last_->pose;
  return last_->pose * small_motion(last_->velocity * seconds);
}

bool Tracker::too_fast(const PreparedFrame& frame, const Isometry3d& pose) const {
  const double seconds = seconds_between(last_->time_ns, frame.time_ns) + 0.02;
  const Isometry3d motion = last_->pose.inverse() * pose;
  return motion.translation().norm() > kVerdict.max_speed * seconds ||
         angle_of(motion) > kVerdict.max_turn_rate * seconds;
}

std::vector<size_t> Tracker::references_at(const FrameImages& images, const Isometry3d& pose,
                                           double* best_overlap) const {
  std::vector<std::pair<double, size_t>> found;
  for (size_t k = 0; k < keyframes_.size(); ++k) {
    const Isometry3d motion = map_from_keyframes_[k].inverse() * pose;
    if (motion.translation().norm() > 3 || angle_of(motion) > 75 * kDegree) continue;
    const double share = overlap(images, {keyframes_[k].get(), map_from_keyframes_[k]}, pose);
    if (share > kKeyframes.min_overlap) found.emplace_back(share, k);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  if (found.size() > kKeyframes.references) found.resize(kKeyframes.references);
  if (best_overlap != nullptr) *best_overlap = found.empty() ? 0 : found.front().first;
  std::vector<size_t> keyframes;
  for (const auto& [share, k] : found) keyframes.push_back(k);
  return keyframes;
}

std::vector<Reference> Tracker::with_poses(const std::vector<size_t>& keyframes) const {
  std::vector<Reference> references;
  for (const size_t k : keyframes) references.push_back({keyframes_[k].get(), map_from_keyframes_[k]});
  return references;
}

std::optional<Tracker::Located> Tracker::try_pose(const PreparedFrame& frame, const Isometry3d& guess,
                                                  double min_inliers) {
  Located located;
  located.references = references_at(frame.images, guess, nullptr);
  if (located.references.empty()) {
    objection_ = "no keyframe shows the same";
    return std::nullopt;
  }
  located.alignment = align(frame.images, with_poses(located.references), guess);
  objection_ = objection_to(located.alignment, min_inliers);
  if (!objection_.empty()) {
    if (!undetermined_ && located.alignment.inlier_share() >= min_inliers &&
        !too_fast(frame, located.alignment.map_from_camera))
      undetermined_ = located.alignment.map_from_camera;
    return std::nullopt;
  }
  const std::vector<size_t> now =
      references_at(frame.images, located.alignment.map_from_camera, &located.best_overlap);
  if (now.empty()) {
    objection_ = "no keyframe shows the same";
    return std::nullopt;
  }
  located.references = now;
  return located;
}

std::vector<Isometry3d> Tracker::guesses_for(const PreparedFrame& frame) const {
  constexpr double kNear = 0.03, kNearAngle = 2 * kDegree;
  std::vector<Isometry3d> guesses = {predicted(frame)};
  if (const auto motion = match(last_->features, frame.features, Random(frame.number))) {
    const Isometry3d pose = last_->pose * motion->a_from_b;
    const Isometry3d difference = guesses.front().inverse() * pose;
    if (difference.translation().norm() > kNear || angle_of(difference) > kNearAngle) guesses.push_back(pose);
  }
  if (guesses.size() == 1) return guesses;
  // The start that fits better comes first.
  const auto fit = [&](const Isometry3d& pose) {
    const auto references = references_at(frame.images, pose, nullptr);
    return references.empty() ? 0.0 : compare(frame.images, with_poses(references), pose, 1).inlier_share();
  };
  if (fit(guesses[1]) > fit(guesses[0])) std::swap(guesses[0], guesses[1]);
  return guesses;
}

std::optional<Tracker::Located> Tracker::locate(const PreparedFrame& frame) {
  std::string first_objection;
  undetermined_.reset();
  for (const Isometry3d& guess : guesses_for(frame)) {
    auto located = try_pose(frame, guess, kVerdict.min_inliers);
    if (located && too_fast(frame, located->alignment.map_from_camera)) {
      objection_ = "the camera would have moved too fast";
      located.reset();
    }
    if (located) return located;
    if (first_objection.empty()) first_objection = objection_;
  }
  auto located = relocalise(frame);
  if (!located) objection_ = first_objection;
  return located;
}

std::optional<Tracker::Located> Tracker::relocalise(const PreparedFrame& frame) {
  for (const size_t k : appearance_.similar(frame.features, kKeyframes.loop_candidates)) {
    const auto motion = match(keyframes_[k]->features(), frame.features, Random(frame.number));
    if (!motion) continue;
    auto located = try_pose(frame, map_from_keyframes_[k] * motion->a_from_b, kKeyframes.min_loop_inliers);
    if (located) return located;
  }
  return std::nullopt;
}

bool Tracker::wants_keyframe(const Located& located) const {
  const Isometry3d motion =
      map_from_keyframes_[located.references.front()].inverse() * located.alignment.map_from_camera;
  return located.best_overlap < kKeyframes.new_below ||
         motion.translation().norm() > kKeyframes.new_beyond_m ||
         angle_of(motion) > kKeyframes.new_beyond_rad;
}

bool Tracker::constrain(const FrameImages& images, size_t keyframe, const Isometry3d& guess,
                        double min_inliers, const LevelRange& levels) {
  const std::vector<Reference> reference = {{keyframes_[keyframe].get(), Isometry3d::Identity()}};
  const Alignment alignment = align(images, reference, guess, levels);
  if (!objection_to(alignment, min_inliers).empty()) return false;
  constraints_.push_back({keyframe, keyframes_.size(), alignment.map_from_camera, alignment.information});
  return true;
}

void Tracker::close_loops(const FrameImages& images, const Features& features) {
  const size_t number = keyframes_.size();
  const auto constrained = [&](size_t keyframe) {
    return std::any_of(constraints_.begin(), constraints_.end(),
                       [&](const PoseConstraint& c) { return c.to == number && c.from == keyframe; });
  };
  for (const size_t k : appearance_.similar(features, kKeyframes.loop_candidates)) {
    if (k + kKeyframes.loop_gap > number || constrained(k)) continue;
    const auto motion = match(keyframes_[k]->features(), features, Random(number));
    if (motion && constrain(images, k, motion->a_from_b, kKeyframes.min_loop_inliers, {})) ++loops_;
  }
}

void Tracker::add_keyframe(PreparedFrame frame, const Located* located) {
  const size_t number = keyframes_.size();
  Isometry3d pose = frame.given.value_or(Isometry3d::Identity());
  if (located != nullptr) {
    pose = located->alignment.map_from_camera;
    bool linked = false;
    for (const size_t k : located->references)
      linked =
          constrain(frame.images, k, map_from_keyframes_[k].inverse() * pose, kVerdict.min_inliers, {1, 0}) ||
          linked;
    if (!linked) {  // Together they determine the pose, alone they do not.
      const size_t k = located->references.front();
      constraints_.push_back(
          {k, number, map_from_keyframes_[k].inverse() * pose, located->alignment.information});
    }
    close_loops(frame.images, frame.features);
  }
  if (frame.given) constraints_.push_back(given_pose(number, *frame.given));
  appearance_.add(frame.features);
  keyframes_.push_back(
      std::make_unique<Keyframe>(frame.number, std::move(frame.images), std::move(frame.features)));
  map_from_keyframes_.push_back(pose);
  if (number > 0) optimise(map_from_keyframes_, constraints_);
}

}  // namespace loci::mapping::tracking
