// Stages of SceneUpdate that learn interaction, similarity and noise.

#include <algorithm>
#include <map>

#include "memory/belief/association/scene_update.h"
#include "memory/belief/evidence/proximity.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {

void SceneUpdate::learn_from_observation(size_t o, size_t k) {
  ProtoObject& object = state_.objects[o];
  if (object.status == Status::tentative) return;
  const std::string& place = scene_.observations[k].place;
  const double seconds = timing_.exposure_s - object.last_seen_exposure_s;
  if (object.status == Status::gone) {
    state_.interaction.learn_returns(seconds, 1, options_);
    if (place != object.place) state_.interaction.learn_found_again(object.place, place, 1);
    return;
  }
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  const double stay = solution_.stay(row, column) + solution_.newview(row, column);
  const double move = solution_.move(row, column);
  const double moved = stay + move > 0 ? move / (stay + move) : 0.0;
  state_.interaction.learn_interaction(interaction_key(object), object.interaction, seconds, moved, options_);
  state_.interaction.learn_moved(object.place, place, moved);
}

void SceneUpdate::learn_from_absence(ProtoObject& object) {
  const double seconds = timing_.exposure_s - object.last_seen_exposure_s;
  const double gone = 1 - object.probability_here;
  state_.interaction.learn_interaction(interaction_key(object), object.interaction, seconds, gone, options_);
  state_.interaction.learn_carried_off(gone);
}

void SceneUpdate::learn_view_noise(size_t o, size_t k) {
  const ProtoObject& object = state_.objects[o];
  const Observation& observation = scene_.observations[k];
  const bool whole = !object.partial && !observation.partial && object.has_size && observation.has_size;
  const double other = object.variance + observation_variance(observation, options_);
  if (!whole || object.id == 0 || update_.observations[k].probability < kParameters.certain) return;
  const double learned = view_noise(state_), expected = predicted_[o].view_variance / learned;
  if (expected < kParameters.view_point_ratio * other) return;  // about the same view point
  const Vector3d offset = observation.box.centre - predicted_[o].box.centre;
  const double found = offset.head<2>().squaredNorm() / 2 / expected;
  constexpr double kWeight = kParameters.view_noise_weight;
  state_.view_noise.count(kWeight * std::min(found, kParameters.max_view_noise * learned), kWeight);
}

void SceneUpdate::learn_similarity() {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> certain;
  std::vector<Eigen::Index> confirmed;  // tentative objects may be doubles of others
  for (size_t o = 0; o < partner_of_object_.size(); ++o) {
    if (state_.objects[o].id == 0) continue;
    confirmed.push_back(static_cast<Eigen::Index>(o));
    const std::optional<size_t> k = partner_of_object_[o];
    if (k && update_.observations[*k].probability >= kParameters.certain) certain.emplace_back(o, *k);
  }
  const std::vector<Comparison>& known = comparisons();
  for (const PairEvidence::Distances& evidence : update_.evidence.distances) {
    const auto kind =
        static_cast<size_t>(std::ranges::find(known, evidence.kind, &Comparison::kind) - known.begin());
    Calibration::Counts* counts[] = {&state_.calibration.of(kind, false), &state_.calibration.of(kind, true)};
    for (const auto& [partner, k] : certain) {
      for (const Eigen::Index o : confirmed) {
        const double distance = evidence.distance(o, k);
        if (!std::isfinite(distance)) continue;
        // Equal weight for the same and for all different objects.
        const double weight = o == partner ? kParameters.similarity_weight
                                           : kParameters.similarity_weight / double(confirmed.size());
        counts[update_.evidence.achromatic(o, k)]->count(o == partner, distance, weight);
      }
    }
    for (Calibration::Counts* of_kind : counts) of_kind->fade();
  }
}

void SceneUpdate::learn_clutter(ProtoObject& object, double if_clutter, double if_object) {
  if (object.clutter_probability <= 0) return;
  const double clutter = object.clutter_probability * if_clutter;
  state_.interaction.learn_clutter(
      clutter / std::max(1e-300, clutter + (1 - object.clutter_probability) * if_object), options_);
  object.clutter_probability = 0;
}

void SceneUpdate::learn_arrivals() {
  std::map<std::string, double> found;
  if (scene_.view.observed)
    for (const ObservedPlace& observed : *scene_.view.observed) found[observed.name];
  for (size_t k = 0; k < scene_.observations.size(); ++k) {
    const ObservationOutcome& outcome = update_.observations[k];
    const bool appeared = outcome.explanation == Explanation::appear;
    found[scene_.observations[k].place] += appeared ? outcome.appear + outcome.clutter : 0.0;
  }
  for (const auto& [place, count] : found) state_.interaction.learn_arrivals(place, count, options_);
}

}  // namespace loci::memory::belief
