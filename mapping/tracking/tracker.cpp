#include "mapping/tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "mapping/base/math/eigenvalues.h"

namespace loci::mapping::tracking {
namespace {

constexpr double kMinMeasured = 0.05;  ///< part of an image with depth: with less nothing is tracked
constexpr double kGivenShift = 0.05, kGivenTurn = 2 * kDegree;  // σ of poses that are given

double seconds_between(TimeNs from, TimeNs to) {
  return in_seconds(to - from);
}

double angle_of(const Isometry3d& motion) {
  return Eigen::AngleAxisd(motion.linear()).angle();
}

bool is_near(const Isometry3d& a, const Isometry3d& b) {
  constexpr double kNear = 0.03, kNearAngle = 2 * kDegree;
  const Isometry3d difference = a.inverse() * b;
  return difference.translation().norm() <= kNear && angle_of(difference) <= kNearAngle;
}

Matrix6d information_of(double shift, double turn) {
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << Vector3d::Constant(1 / (shift * shift)), Vector3d::Constant(1 / (turn * turn));
  return information;
}

/// Given poses hold the whole where they are, but not against what is measured.
PoseConstraint given_pose(size_t keyframe, const Isometry3d& pose) {
  return {PoseConstraint::kMap, keyframe, pose, information_of(kGivenShift, kGivenTurn)};
}

/// The information of an alignment that is not determined, without directions of less than none, and with
/// that of the prediction.
Matrix6d with_prediction(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() *
             solver.eigenvectors().transpose() +
         information_of(0.1, 5 * kDegree);
}

}  // namespace

FrameResult Tracker::add(PreparedFrame frame) {
  FrameResult result;
  if (frame.images.measured < kMinMeasured) {
    result.objection = frame.is_damaged ? "the depth image cannot be read" : kHardlyAnyDepth;
    return result;
  }
  if (keyframes_.empty()) return begin_region(std::move(frame));
  const std::optional<Located> located = locate(frame);
  if (!located) {
    if (++lost_ >= kKeyframes.patience) result = begin_region(std::move(frame));
    result.objection = objection_;
    return result;
  }
  lost_ = 0;
  const Isometry3d pose = located->alignment.map_from_camera;
  result.keyframe = located->references.front();
  result.keyframe_from_camera = map_from_keyframes_[*result.keyframe].inverse() * pose;
  remember(frame, pose, region_[*result.keyframe]);
  if (located->determined) last_->keyframe = result.keyframe;
  if (located->determined)
    result.covariance = located->alignment.covariance().value();
  else
    result.objection = kUndetermined;
  if (wants_keyframe(*located)) {
    index(*result.keyframe);
    result.keyframe = keyframes_.size();
    result.keyframe_from_camera = Isometry3d::Identity();
    extend(std::move(frame), *located);
    last_->pose = map_from_keyframes_.back();  // Loops may have moved it, and its region.
    last_->region = region_.back();
    if (last_->keyframe) last_->keyframe = result.keyframe;
  } else if (located->determined) {
    index(*result.keyframe);
    keyframes_[*result.keyframe]->fuse(frame.images, result.keyframe_from_camera.inverse());
  }
  if (located->determined) ++attached_[*result.keyframe];
  return result;
}

void Tracker::remember(const PreparedFrame& frame, const Isometry3d& pose, size_t region) {
  Last now{frame.time_ns, frame.number, pose, region, {}, frame.features, frame.given, {}};
  if (last_ && last_->region == region) {
    const double seconds = seconds_between(last_->time_ns, frame.time_ns);
    if (seconds > 1e-4 && seconds < kMaxGap) now.velocity = vector_of(last_->pose.inverse() * pose) / seconds;
  }
  last_ = std::move(now);
}

bool Tracker::motion_is_known(const PreparedFrame& frame, const Isometry3d& pose) const {
  return (frame.given && last_->given) || seconds_between(last_->time_ns, frame.time_ns) < kMaxGap ||
         (matched_ && is_near(*matched_, pose));
}

PosePrior Tracker::predicted(const PreparedFrame& frame) const {
  const double seconds = std::max(seconds_between(last_->time_ns, frame.time_ns), 1e-3);
  PosePrior prior{last_->pose, Vector6d::Zero()};
  double shift = kMotion.speed * seconds, turn = kMotion.turn_rate * seconds;
  if (frame.given && last_->given) {
    prior.map_from_camera = last_->pose * (last_->given->inverse() * *frame.given);
    shift = kGivenShift;
    turn = kGivenTurn;
  } else if (seconds < kMaxGap && last_->velocity) {
    prior.map_from_camera = last_->pose * small_motion(*last_->velocity * seconds);
    shift = std::min(shift, 0.5 * kMotion.acceleration * seconds * seconds);
    turn = std::min(turn, 0.5 * kMotion.angular_acceleration * seconds * seconds);
  }
  prior.sigma << Vector3d::Constant(shift), Vector3d::Constant(turn);
  return prior;
}

bool Tracker::too_fast(const PreparedFrame& frame, const Isometry3d& pose) const {
  const double seconds = seconds_between(last_->time_ns, frame.time_ns) + 0.02;
  const Isometry3d motion = last_->pose.inverse() * pose;
  return motion.translation().norm() > kVerdict.max_speed * seconds ||
         angle_of(motion) > kVerdict.max_turn_rate * seconds;
}

/// Poses of different parts are not known well enough to be aligned with at once. The part of the last frame
/// comes first, then that with the most frames: what shows most overlap may be a bare wall.
std::vector<Tracker::View> Tracker::views_at(const FrameImages& images, const Isometry3d& pose,
                                             size_t region) const {
  std::vector<std::pair<double, size_t>> found;
  for (size_t k = 0; k < keyframes_.size(); ++k) {
    if (region_[k] != region) continue;
    const Isometry3d motion = map_from_keyframes_[k].inverse() * pose;
    if (motion.translation().norm() > 3 || angle_of(motion) > 75 * kDegree) continue;
    const double share = overlap(images, {keyframes_[k].get(), map_from_keyframes_[k]}, pose);
    if (share > kKeyframes.min_overlap) found.emplace_back(share, k);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<View> views;
  for (const auto& [share, k] : found) {
    auto view = std::ranges::find(views, part_of(k), &View::part);
    if (view == views.end()) view = views.insert(view, View{part_of(k), {}, share});
    if (view->keyframes.size() < kKeyframes.references) view->keyframes.push_back(k);
  }
  const std::vector<size_t> frames = frames_of_parts();
  std::ranges::stable_sort(views, std::greater(),
                           [&](const View& view) { return std::pair(is_of_last(view), frames[view.part]); });
  return views;
}

bool Tracker::is_of_last(const View& view) const {
  return last_ && last_->keyframe && part_of(*last_->keyframe) == view.part;
}

std::vector<Reference> Tracker::with_poses(const std::vector<size_t>& keyframes) const {
  std::vector<Reference> references;
  for (const size_t k : keyframes) references.push_back({keyframes_[k].get(), map_from_keyframes_[k]});
  return references;
}

std::optional<Tracker::Located> Tracker::try_pose(const PreparedFrame& frame, const Isometry3d& guess,
                                                  size_t region, const PosePrior* prior) {
  constexpr size_t kMaxParts = 3;
  std::vector<View> views = views_at(frame.images, guess, region);
  objection_ = "no keyframe shows the same";
  views.resize(std::min(views.size(), kMaxParts));
  for (const View& view : views) {
    Located located;
    located.alignment = align(frame.images, with_poses(view.keyframes), guess, {}, prior);
    const bool follows =
        prior != nullptr && is_of_last(view) && motion_is_known(frame, located.alignment.map_from_camera);
    objection_ = misfit_of(located.alignment, follows ? kVerdict.min_inliers : kKeyframes.min_loop_inliers);
    if (!objection_.empty()) continue;
    objection_ = "surfaces are seen through at the place that fits";
    if (!follows && contradiction(frame.images, with_poses(view.keyframes),
                                  located.alignment.map_from_camera) > kKeyframes.max_contradiction)
      continue;
    const auto now = views_at(frame.images, located.alignment.map_from_camera, region);
    const auto same = std::ranges::find(now, view.part, &View::part);
    objection_ = "no keyframe shows the same";
    if (same == now.end()) continue;
    located.references = same->keyframes;
    located.best_overlap = same->best_overlap;
    located.determined = is_determined(located.alignment);
    if (located.determined) return located;
    objection_ = kUndetermined;
    if (prior != nullptr && (!sliding_ || is_newest(located)) &&
        !too_fast(frame, located.alignment.map_from_camera))
      sliding_ = located;
  }
  return std::nullopt;
}

bool Tracker::is_newest(const Located& located) const {
  return std::ranges::find(located.references, keyframes_.size() - 1) != located.references.end();
}

std::vector<Isometry3d> Tracker::guesses_for(const PreparedFrame& frame) const {
  std::vector<Isometry3d> guesses = {predicted(frame).map_from_camera};
  if (matched_ && !is_near(guesses.front(), *matched_)) guesses.push_back(*matched_);
  if (guesses.size() == 1) return guesses;
  // The start that fits better comes first.
  const auto fit = [&](const Isometry3d& pose) {
    const std::vector<View> views = views_at(frame.images, pose, last_->region);
    return views.empty() ? 0.0
                         : compare(frame.images, with_poses(views.front().keyframes), pose, 1).inlier_share();
  };
  if (fit(guesses[1]) > fit(guesses[0])) std::swap(guesses[0], guesses[1]);
  return guesses;
}

std::optional<Tracker::Located> Tracker::locate(const PreparedFrame& frame) {
  std::string first_objection;
  sliding_.reset();
  matched_.reset();
  if (const auto motion = match(last_->features, frame.features, Random(frame.number)))
    matched_ = last_->pose * motion->a_from_b;
  const PosePrior prior = predicted(frame);
  for (const Isometry3d& guess : guesses_for(frame)) {
    auto located = try_pose(frame, guess, last_->region, &prior);
    if (located && too_fast(frame, located->alignment.map_from_camera)) {
      objection_ = "the camera would have moved too fast";
      located.reset();
    }
    if (located) return located;
    if (first_objection.empty()) first_objection = objection_;
  }
  auto located = relocalise(frame);
  if (located) return located;
  objection_ = first_objection;
  return sliding_;
}

std::optional<Tracker::Located> Tracker::relocalise(const PreparedFrame& frame) {
  for (const size_t entry : appearance_.similar(frame.features, kKeyframes.loop_candidates)) {
    const size_t k = indexed_[entry];
    const auto motion = match(keyframes_[k]->features(), frame.features, Random(frame.number));
    if (!motion) continue;
    auto located = try_pose(frame, map_from_keyframes_[k] * motion->a_from_b, region_[k], nullptr);
    if (located) return located;
  }
  return std::nullopt;
}

bool Tracker::wants_keyframe(const Located& located) const {
  const Isometry3d motion =
      map_from_keyframes_[located.references.front()].inverse() * located.alignment.map_from_camera;
  // What slides along a bare wall may show more than the wall: the next frame is compared with that, too.
  if (!located.determined && !is_newest(located)) return true;
  return located.best_overlap < kKeyframes.new_below ||
         motion.translation().norm() > kKeyframes.new_beyond_m ||
         angle_of(motion) > kKeyframes.new_beyond_rad;
}

bool Tracker::constrain(const FrameImages& images, size_t keyframe, const Isometry3d& guess,
                        double min_inliers, const LevelRange& levels) {
  const std::vector<Reference> reference = {{keyframes_[keyframe].get(), Isometry3d::Identity()}};
  const Alignment alignment = align(images, reference, guess, levels);
  if (!misfit_of(alignment, min_inliers).empty() || !is_determined(alignment)) return false;
  constraints_.push_back({keyframe, keyframes_.size(), alignment.map_from_camera, alignment.information});
  return true;
}

bool Tracker::constrain_loop(const FrameImages& images, size_t keyframe, const Isometry3d& guess) {
  if (!constrain(images, keyframe, guess, kKeyframes.min_loop_inliers, {})) return false;
  const std::vector<Reference> reference = {{keyframes_[keyframe].get(), Isometry3d::Identity()}};
  if (contradiction(images, reference, constraints_.back().from_from_to) <= kKeyframes.max_contradiction)
    return true;
  constraints_.pop_back();
  return false;
}

void Tracker::close_loops(const FrameImages& images, const Features& features, const Isometry3d& pose,
                          size_t region) {
  const size_t number = keyframes_.size();
  const auto is_far = [&](size_t keyframe) {
    return keyframe + kKeyframes.loop_gap <= number &&
           std::none_of(constraints_.begin(), constraints_.end(),
                        [&](const PoseConstraint& c) { return c.to == number && c.from == keyframe; });
  };
  for (const size_t entry : appearance_.similar(features, kKeyframes.loop_candidates)) {
    const size_t k = indexed_[entry];
    if (!is_far(k)) continue;
    const auto motion = match(keyframes_[k]->features(), features, Random(number));
    if (motion && constrain_loop(images, k, motion->a_from_b)) ++loops_;
  }
  // What looks like nothing in particular is found by where it is.
  std::vector<std::pair<double, size_t>> near;
  for (size_t k = 0; k < number; ++k) {
    const Isometry3d motion = map_from_keyframes_[k].inverse() * pose;
    if (region_[k] != region || !is_far(k) || angle_of(motion) > 60 * kDegree) continue;
    const double share = overlap(images, {keyframes_[k].get(), map_from_keyframes_[k]}, pose);
    if (share > kKeyframes.loop_overlap) near.emplace_back(-share, k);
  }
  std::sort(near.begin(), near.end());
  if (near.size() > 2) near.resize(2);
  for (const auto& [share, k] : near) constrain_loop(images, k, map_from_keyframes_[k].inverse() * pose);
}

/// The last keyframe may have been found in regions other than its own: they become one.
void Tracker::join_regions() {
  const size_t number = keyframes_.size() - 1;
  for (const PoseConstraint& constraint : constraints_) {
    if (constraint.to != number || constraint.from == PoseConstraint::kMap) continue;
    const size_t from = region_[constraint.from], own = region_[number];
    if (from == own) continue;
    // The older one stays.
    Isometry3d motion = map_from_keyframes_[constraint.from] * constraint.from_from_to *
                        map_from_keyframes_[number].inverse();
    if (own < from) motion = motion.inverse();
    for (size_t k = 0; k <= number; ++k) {
      if (region_[k] != std::max(from, own)) continue;
      region_[k] = std::min(from, own);
      map_from_keyframes_[k] = motion * map_from_keyframes_[k];
    }
  }
}

size_t Tracker::part_of(size_t keyframe) const {
  while (part_[keyframe] != keyframe) keyframe = part_[keyframe];
  return keyframe;
}

void Tracker::join_parts(size_t a, size_t b) {
  a = part_of(a);
  b = part_of(b);
  part_[std::max(a, b)] = std::min(a, b);
}

std::vector<size_t> Tracker::frames_of_parts() const {
  std::vector<size_t> frames(keyframes_.size());
  for (size_t k = 0; k < keyframes_.size(); ++k) frames[part_of(k)] += attached_[k];
  return frames;
}

std::vector<bool> Tracker::in_main_part() const {
  const std::vector<size_t> frames = frames_of_parts();
  const auto largest = static_cast<size_t>(std::ranges::max_element(frames) - frames.begin());
  std::vector<bool> main(keyframes_.size());
  for (size_t k = 0; k < keyframes_.size(); ++k) main[k] = part_of(k) == largest;
  return main;
}

void Tracker::index(size_t keyframe) {
  if (std::find(indexed_.begin(), indexed_.end(), keyframe) != indexed_.end()) return;
  appearance_.add(keyframes_[keyframe]->features());
  indexed_.push_back(keyframe);
}

FrameResult Tracker::begin_region(PreparedFrame frame) {
  FrameResult result;
  const bool first = keyframes_.empty();
  const Isometry3d pose = frame.given.value_or(first ? Isometry3d::Identity() : last_->pose);
  const size_t number = keyframes_.size();
  lost_ = 0;
  if (!first && region_.back() == regions_ - 1 && attached_.back() == 0 &&
      std::count(region_.begin(), region_.end(), region_.back()) == 1) {
    // Nothing was tracked from the last beginning.
    remember(frame, pose, region_.back());
    keyframes_.back() = std::make_unique<Keyframe>(frame.number, frame.images, std::move(frame.features));
    return result;
  }
  remember(frame, pose, regions_);
  add_keyframe(std::move(frame), pose, regions_++);
  if (first) {
    result.keyframe = 0;
    ++attached_[0];
    index(0);
  } else {
    constraints_.push_back(
        {number - 1, number, map_from_keyframes_[number - 1].inverse() * pose, information_of(1, 1)});
  }
  return result;
}

void Tracker::add_keyframe(PreparedFrame frame, const Isometry3d& pose, size_t region) {
  const size_t number = keyframes_.size();
  if (frame.given) constraints_.push_back(given_pose(number, *frame.given));
  keyframes_.push_back(std::make_unique<Keyframe>(frame.number, frame.images, std::move(frame.features)));
  map_from_keyframes_.push_back(pose);
  region_.push_back(region);
  part_.push_back(number);
  attached_.push_back(0);
}

void Tracker::extend(PreparedFrame frame, const Located& located) {
  const size_t number = keyframes_.size(), first = constraints_.size();
  const Isometry3d pose = located.alignment.map_from_camera;
  const size_t nearest = located.references.front(), region = region_[nearest];
  for (const size_t k : located.references)
    constrain(frame.images, k, map_from_keyframes_[k].inverse() * pose, kVerdict.min_inliers, {1, 0});
  bool linked = constraints_.size() > first;
  close_loops(frame.images, frame.features, pose, region);
  add_keyframe(std::move(frame), pose, region);
  for (size_t i = first; i < constraints_.size(); ++i)
    if (constraints_[i].from != PoseConstraint::kMap) join_parts(constraints_[i].from, number);
  if (!linked) {  // Together they determine the pose, alone they do not; or nothing does.
    constraints_.push_back({nearest, number, map_from_keyframes_[nearest].inverse() * pose,
                            located.determined ? located.alignment.information
                                               : with_prediction(located.alignment.information)});
    if (located.determined) join_parts(nearest, number);
  }
  index(number);
  join_regions();
  optimise(map_from_keyframes_, constraints_);
}

}  // namespace loci::mapping::tracking
