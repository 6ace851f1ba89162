#include "memory/belief/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/base/math.h"
#include "memory/belief/proximity.h"

namespace loci::memory::belief {
namespace {

Eigen::Index index(size_t i) {
  return static_cast<Eigen::Index>(i);
}

/// The different places of a scene's observations.
struct SeenPlaces {
  explicit SeenPlaces(const std::vector<Observation>& observations) {
    for (const Observation& observation : observations) {
      const auto known = std::find(names.begin(), names.end(), observation.place);
      of.push_back(static_cast<size_t>(known - names.begin()));
      if (known == names.end()) names.push_back(observation.place);
    }
  }
  std::vector<std::string> names;
  std::vector<size_t> of;  ///< index of each observation's
};

/// Log ratio of where a moved thing is put down, against anywhere on the place: half of all moves are short.
double log_near(const Vector3d& offset, const BeliefOptions& options) {
  const double variance = options.nudge_m * options.nudge_m;
  const double density = std::exp(-offset.head<2>().squaredNorm() / (2 * variance)) / (2 * kPi * variance);
  return std::log(0.5 + 0.5 * options.area_m2 * density);
}

}  // namespace

double seconds_since_last_scene(const BeliefState& state, const Scene& scene) {
  return state.last_scene ? double(scene.time - *state.last_scene) / double(kSecond)
                          : std::numeric_limits<double>::infinity();
}

bool is_snapshot(const BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  const double before = seconds_since_last_scene(state, scene);
  const double after = scene.seconds_to_next.value_or(std::numeric_limits<double>::infinity());
  return std::min(before, after) >= options.snapshot_gap_s;
}

double attention_at(const BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  if (!state.last_scene) return state.attention_s;
  const double watched = is_snapshot(state, scene, options) ? 1.0 : options.watched;
  return state.attention_s + watched * seconds_since_last_scene(state, scene);
}

std::vector<Expectation> expect(const BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  std::vector<Expectation> expected;
  const double attention = attention_at(state, scene, options);
  for (const ProtoObject& object : state.objects) {
    Expectation e;
    e.box = box_in_map(object, scene.places);
    e.view_variance =
        view_noise(state) * view_change_variance(object.map_from_camera, scene.view.map_from_camera,
                                                 e.box.size.maxCoeff(), options);
    e.variance = object.variance + e.view_variance;
    e.handled = handled_until(object, attention, state, options);
    const Isometry3d change = object.map_from_camera.inverse() * scene.view.map_from_camera;
    const double motion = change.translation().norm() + Eigen::AngleAxisd(change.linear()).angle();
    e.turned = 0.002 + e.handled / 2 + options.newview * (1 - std::exp(-motion / 0.5));
    e.here = object.probability_here * (1 - e.handled);
    e.seen = scene.view.depth.empty()
                 ? look_without_depth(scene.view, e.box, object.place, scene.observations, options.visibility)
                 : look_at_who(scene.view, e.box, std::sqrt(e.variance), scene.observations.size(),
                               options.visibility);
    e.undetectable = undetectable(e.seen.visibility);
    expected.push_back(std::move(e));
  }
  return expected;
}

EmptinessEvidence emptiness(const Expectation& expected, double empty_share, double seconds,
                            const BeliefOptions& options) {
  const Visibility& seen = expected.seen.visibility;
  const double searched = seen.searched > 0 ? seen.searched / seen.looked() : 0.0;
  const double taken = std::max(0.0, 1 - empty_share - searched);
  const double height = expected.box.size.z();
  const double independence = std::clamp(seconds, 0.05, 1.0);
  const double found_occupied_if_gone = 0.1;
  const double solid = std::clamp((height - 0.015) / 0.02, 0.0, 1.0);
  const double detection = options.detection * (0.4 + 0.6 * solid);
  return {independence * (solid * empty_share * std::log(options.empty_if_there) + std::log(1 - detection)),
          independence * solid * taken * std::log(found_occupied_if_gone)};
}

double empty_share(const OccupiedBy& seen, const std::vector<double>& taken_by_other) {
  double against = seen.visibility.seen_through;
  for (size_t k = 0; k < seen.share.size(); ++k) against += seen.share[k] * taken_by_other[k];
  const double looked = seen.visibility.looked();
  return looked > 0 ? std::min(1.0, against / looked) : 0.0;
}

double covered_share(const Expectation& believed, const AxisBox& seen) {
  AxisBox grown = believed.box;
  grown.size += Vector3d::Constant(4 * std::sqrt(believed.variance));
  return shared_volume(grown, seen) / std::max(1e-9, seen.volume());
}

bool is_piece(const Expectation& believed, const AxisBox& seen) {
  return seen.volume() < 0.5 * believed.box.volume() && covered_share(believed, seen) > 0.6;
}

namespace {

/// What is settled is an explanation of its own beside which nothing else is considered for either of the
/// two: how probable it is, against something new or false in place of what is not found, remains the
/// model's to say.
void settle(LogOddsProblem& problem, const std::vector<std::optional<size_t>>& settled) {
  for (size_t k = 0; k < settled.size(); ++k) {
    if (!settled[k]) continue;
    for (PairTable* table : {&problem.log_similar, &problem.log_proximity}) {
      const double kept = (*table)(index(*settled[k]), index(k));
      table->row(index(*settled[k])).setConstant(kNever);
      table->col(index(k)).setConstant(kNever);
      (*table)(index(*settled[k]), index(k)) = kept;
    }
  }
}

}  // namespace

LogOddsProblem identity_problem(const BeliefState& state, const std::vector<Expectation>& expected,
                                const Scene& scene, const PairEvidence& evidence,
                                const BeliefOptions& options) {
  const size_t m = state.objects.size(), n = scene.observations.size();
  const double seconds = std::min(1e9, seconds_since_last_scene(state, scene));
  const bool snapshot = is_snapshot(state, scene, options);
  LogOddsProblem problem;
  problem.log_similar = evidence.log_similar;
  problem.log_proximity = evidence.log_proximity;
  settle(problem, evidence.settled);
  for (PairTable* table : {&problem.stay_prior, &problem.move_prior, &problem.newview_prior})
    table->setZero(index(m), index(n));
  const SeenPlaces places(scene.observations);
  for (size_t o = 0; o < m; ++o) {
    const Expectation& e = expected[o];
    const double before = state.objects[o].probability_here;
    std::vector<double> other(n, 0.0);
    for (size_t k = 0; k < n; ++k) {
      // Unless it is there itself; and in a video two things that touch often melt into one for some frames.
      const double same =
          evidence.log_proximity(index(o), index(k)) + evidence.log_similar(index(o), index(k));
      other[k] = (snapshot ? 1.0 : 0.3) / (1 + std::exp(std::clamp(same, -30.0, 30.0)));
    }
    const EmptinessEvidence empty = emptiness(e, empty_share(e.seen, other), seconds, options);
    const double in_view = 1 - e.undetectable;
    const double stays = std::max(1e-6, e.here) * options.detection;
    const ProtoObject& object = state.objects[o];
    const bool gone = object.status == Status::gone;
    problem.stay_prior.row(index(o)).setConstant(std::log(stays * (1 - e.turned)));
    const double turns = std::log(stays * e.turned);
    for (size_t k = 0; k < n; ++k) {
      // Another side may have other colours, though seldom altogether; it hardly has another size.
      const double size = evidence.log_size(index(o), index(k));
      const double color = evidence.log_similar(index(o), index(k)) - options.appearance_weight * size;
      problem.newview_prior(index(o), index(k)) = turns + size + 0.25 * std::min(0.0, color);
    }
    const double left = options.detection * (e.undetectable + in_view * std::exp(empty.if_gone));
    const double returns =
        gone ? state.habits.returns(attention_at(state, scene, options) - object.seen_attention_s, options)
             : 0.0;
    std::vector<double> moves_to;
    for (const std::string& place : places.names) {
      const double put_here = state.habits.moved_to(object.place, place);
      const double back = gone ? returns : put_here;
      const double moves = before * e.handled * put_here + (1 - before) * back;
      moves_to.push_back(std::log(std::max(1e-9, moves * left)));
    }
    for (size_t k = 0; k < n; ++k) {
      const Observation& observation = scene.observations[k];
      // A video would have shown the hand that nudges; what was gone may come back anywhere.
      const bool anywhere = !snapshot || gone || object.place != observation.place;
      problem.move_prior(index(o), index(k)) =
          moves_to[places.of[k]] +
          (anywhere ? 0.0 : log_near(e.box.centre - observation.box.centre, options));
    }
    if (object.leftover_of != 0) {  // elsewhere it is another object's already
      problem.move_prior.row(index(o)).setConstant(kNever);
      problem.newview_prior.row(index(o)).setConstant(kNever);
    }
    problem.out_of_view.push_back(e.undetectable);
    problem.disappear_prior.push_back(std::log(std::max(1e-6, 1 - e.here)) + empty.if_gone);
    problem.missed_prior.push_back(std::log(std::max(1e-6, e.here)) + empty.if_there);
    problem.hidden_prior.push_back(0.0);
  }
  for (const Observation& observation : scene.observations) {
    // A piece of something that is already believed in: objects fall into parts, more often than a new one
    // is put inside an old one.
    double piece = 0;
    for (size_t o = 0; o < m && observation.sized; ++o) {
      double inside =
          shared_volume(expected[o].box, observation.box) / std::max(1e-9, observation.box.volume());
      if (!snapshot && is_piece(expected[o], observation.box)) inside = 1;
      piece = std::max(piece, inside * expected[o].here);
    }
    const double fresh = state.habits.arrivals(observation.place, options);
    const double mistaken = state.habits.false_share(observation.place, options);
    problem.appear_prior.push_back(std::log(fresh * (1 - mistaken)));
    problem.clutter_prior.push_back(std::log(fresh * mistaken + (snapshot ? 0.1 : 1.0) * piece));
  }
  return problem;
}

}  // namespace loci::memory::belief
