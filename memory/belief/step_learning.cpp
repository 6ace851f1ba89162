// What scenes teach about habits and noise.

#include <algorithm>
#include <map>

#include "memory/belief/proximity.h"
#include "memory/belief/step.h"

namespace loci::memory::belief {
namespace {

/// So probable must it be which object something is before its looks teach.
constexpr double kSure = 0.9;
/// Looks at one thing repeat each other.
constexpr double kLikenessWeight = 0.5;

}  // namespace

void Step::learn_from_sighting(size_t o, size_t k) {
  ProtoObject& object = state_.objects[o];
  if (object.status == Status::tentative) return;
  const std::string& place = scene_.observations[k].place;
  if (object.status == Status::gone) {
    state_.habits.learn_returns(attention_ - object.seen_attention_s, 1, options_);
    if (place != object.place) state_.habits.learn_found_again(object.place, place, 1);
    return;
  }
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  const double stay = solution_.stay(row, column) + solution_.newview(row, column);
  const double move = solution_.move(row, column);
  const double moved = stay + move > 0 ? move / (stay + move) : 0.0;
  const double seconds = attention_ - object.seen_attention_s;
  state_.habits.learn_handled(handled(object), object.handling, seconds, moved, options_);
  state_.habits.learn_moved(object.place, place, moved);
}

void Step::learn_view_noise(size_t o, size_t k) {
  constexpr double kWeight = 0.25, kFarthest = 4;
  const ProtoObject& object = state_.objects[o];
  const Observation& observation = scene_.observations[k];
  const bool whole = !object.partial && !observation.partial && object.sized && observation.sized;
  const double other = object.variance + observation_variance(observation, options_);
  if (!whole || object.id == 0 || update_.observations[k].probability < kSure) return;
  const double learned = view_noise(state_), expected = expected_[o].view_variance / learned;
  if (expected < 4 * other) return;  // about the same view point
  const Vector3d offset = observation.box.centre - expected_[o].box.centre;
  const double found = offset.head<2>().squaredNorm() / 2 / expected;
  state_.view_noise.count(kWeight * std::min(found, kFarthest * learned), kWeight);
}

void Step::learn_likeness() {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> sure;
  std::vector<Eigen::Index> told;  // tentative objects may be doubles of others
  for (size_t o = 0; o < partner_of_object_.size(); ++o) {
    if (state_.objects[o].id == 0) continue;
    told.push_back(static_cast<Eigen::Index>(o));
    const std::optional<size_t> k = partner_of_object_[o];
    if (k && update_.observations[*k].probability >= kSure) sure.emplace_back(o, *k);
  }
  const std::vector<Comparison>& known = comparisons();
  for (const PairEvidence::Distances& evidence : update_.evidence.distances) {
    const auto kind =
        static_cast<size_t>(std::ranges::find(known, evidence.kind, &Comparison::kind) - known.begin());
    Calibration::Counts* counts[] = {&state_.calibration.of(kind, false), &state_.calibration.of(kind, true)};
    for (const auto& [partner, k] : sure) {
      for (const Eigen::Index o : told) {
        const double distance = evidence.distance(o, k);
        if (!std::isfinite(distance)) continue;
        // As much about what differs as about what is the same.
        const double weight = o == partner ? kLikenessWeight : kLikenessWeight / double(told.size());
        counts[update_.evidence.colorless(o, k)]->count(o == partner, distance, weight);
      }
    }
    for (Calibration::Counts* of_kind : counts) of_kind->fade();
  }
}

void Step::learn_from_absence(ProtoObject& object) {
  const double seconds = attention_ - object.seen_attention_s;
  const double gone = 1 - object.probability_here;
  state_.habits.learn_handled(handled(object), object.handling, seconds, gone, options_);
  state_.habits.learn_carried_off(gone);
}

void Step::learn_doubt(ProtoObject& object, double if_false, double if_real) {
  if (object.doubt <= 0) return;
  const double doubted = object.doubt * if_false;
  state_.habits.learn_false(doubted / std::max(1e-300, doubted + (1 - object.doubt) * if_real), options_);
  object.doubt = 0;
}

void Step::learn_arrivals() {
  std::map<std::string, double> found;
  if (scene_.view.observed)
    for (const ObservedPlace& observed : *scene_.view.observed) found[observed.name];
  for (size_t k = 0; k < scene_.observations.size(); ++k) {
    const ObservationOutcome& outcome = update_.observations[k];
    const bool fresh = outcome.explanation == Explanation::appear;
    found[scene_.observations[k].place] += fresh ? outcome.appear + outcome.clutter : 0.0;
  }
  for (const auto& [place, count] : found) state_.habits.learn_arrivals(place, count, options_);
}

}  // namespace loci::memory::belief
