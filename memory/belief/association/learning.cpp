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
  const double seconds = timing_.exposure_s - object.last_seen_exposure_s;
  if (object.status == Status::gone) {
    state_.interaction.learn_returns(seconds, 1, options_);
    return;
  }
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  const double stay = stay_probability(o, k);
  const double move = solution_.move(row, column);
  const double moved = stay + move > 0 ? move / (stay + move) : 0.0;
  state_.interaction.learn_interaction(interaction_key(object), object.interaction, seconds, moved, options_);
}

void SceneUpdate::learn_detection(ProtoObject& object, Explanation explanation) {
  if (timing_.independent && object.id != 0) {
    state_.detection.detected += 1;
    if (explanation != Explanation::move) state_.detection.missed += object.missed_views;
  }
  object.missed_views = 0;
}

void SceneUpdate::learn_moves() {
  for (size_t o = 0; o < partner_of_object_.size(); ++o) {
    const ProtoObject& object = state_.objects[o];
    if (object.status == Status::tentative) continue;
    for (size_t k = 0; k < scene_.observations.size(); ++k) {
      const double moved = solution_.move(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(k));
      if (moved < kParameters.min_probability) continue;
      if (object.status == Status::gone)
        state_.interaction.learn_found_again(object.place, scene_.observations[k].place, moved);
      else
        state_.interaction.learn_moved(object.place, scene_.observations[k].place, moved);
      if (object.status == Status::gone || object.place != scene_.observations[k].place) continue;
      const double shorts = state_.interaction.short_share();
      const double near =
          shorts * short_move_ratio(predicted_[o].box.centre - scene_.observations[k].box.centre, options_);
      state_.interaction.learn_short_move(moved * near / (near + 1 - shorts));
    }
  }
}

void SceneUpdate::learn_from_absence(ProtoObject& object) {
  const double seconds = timing_.exposure_s - object.last_seen_exposure_s;
  const double gone = 1 - object.probability_here;
  state_.interaction.learn_interaction(interaction_key(object), object.interaction, seconds, gone, options_);
  state_.interaction.learn_carried_off(gone);
}

void SceneUpdate::learn_view_noise() {
  for (size_t o = 0; o < predicted_.size(); ++o) {
    const ProtoObject& object = state_.objects[o];
    if (object.id == 0 || object.partial) continue;
    for (size_t k = 0; k < scene_.observations.size(); ++k) {
      const Observation& observation = scene_.observations[k];
      const double stayed = stay_probability(o, k);
      if (stayed < kParameters.min_probability || observation.partial) continue;
      const PositionNoise noise = position_noise(object, predicted_[o], observation, {}, options_);
      if (noise.stated < kParameters.view_point_ratio * noise.known) continue;  // about the same view point
      const Vector3d offset = observation.box.centre - predicted_[o].box.centre;
      state_.view_noise.count(noise.densities(offset.head<2>().squaredNorm()), stayed, options_.noise_spread);
    }
  }
}

double SceneUpdate::stay_probability(size_t o, size_t k) const {
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  return solution_.stay(row, column) + solution_.newview(row, column);
}

void SceneUpdate::learn_similarity() {
  std::vector<Eigen::Index> confirmed;  // tentative objects may be doubles of others
  for (size_t o = 0; o < partner_of_object_.size(); ++o)
    if (state_.objects[o].id != 0) confirmed.push_back(static_cast<Eigen::Index>(o));
  const std::vector<Comparison>& known = comparisons();
  for (const PairEvidence::Distances& evidence : update_.evidence.distances) {
    const auto kind =
        static_cast<size_t>(std::ranges::find(known, evidence.kind, &Comparison::kind) - known.begin());
    Calibration::Counts* counts[] = {&state_.calibration.of(kind, false), &state_.calibration.of(kind, true)};
    for (const Eigen::Index o : confirmed) {
      for (Eigen::Index k = 0; k < evidence.distance.cols(); ++k) {
        const double distance = evidence.distance(o, k);
        if (!std::isfinite(distance)) continue;
        // Equal weight for the same and for all different objects.
        const double weight = kParameters.similarity_weight;
        Calibration::Counts& of_pair = *counts[update_.evidence.achromatic(o, k)];
        if (solution_.stay(o, k) > 0) of_pair.count(true, distance, weight * solution_.stay(o, k));
        of_pair.count(false, distance,
                      weight / double(confirmed.size()) * (1 - pair_probability(size_t(o), size_t(k))));
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
