// Stages of SceneUpdate that learn interaction, similarity and noise.

#include <algorithm>

#include "memory/belief/association/scene_update.h"
#include "memory/belief/evidence/proximity.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {

void SceneUpdate::learn_detection(ProtoObject& object, Explanation explanation) {
  if (timing_.independent && object.id != 0) {
    state_.detection.detected += 1;
    if (explanation != Explanation::move) state_.detection.missed += object.missed_views;
  }
  object.missed_views = 0;
}

void SceneUpdate::learn_interactions() {
  for (size_t o = 0; o < partner_of_object_.size(); ++o)
    if (state_.objects[o].status != Status::tentative) learn_handling(o);
}

void SceneUpdate::learn_handling(size_t o) {
  ProtoObject& object = state_.objects[o];
  const Prediction& p = predicted_[o];
  const auto row = static_cast<Eigen::Index>(o);
  InteractionModel& model = state_.interaction;
  const double in_view = 1 - p.undetectable, detection = state_.detection.value(options_);
  model.learn_change(solution_.newview.row(row).sum(), in_view * detection * p.here * p.appearance_change);
  std::vector<double> found(places_.size(), 0.0);
  const double shorts = model.short_share();
  for (size_t k = 0; k < scene_.observations.size(); ++k) {
    const Observation& observation = scene_.observations[k];
    const double moved = solution_.move(row, static_cast<Eigen::Index>(k));
    found[index_of(places_, observation.place)] += moved;
    if (object.status == Status::gone || object.place != observation.place) continue;
    if (moved < kParameters.min_probability) continue;
    const double near = shorts * short_move_ratio(p.box.centre - observation.box.centre, options_);
    model.learn_short_move(moved, moved * near / (near + 1 - shorts));
  }
  for (size_t i = 0; i < places_.size(); ++i)
    model.learn_moved(object.place, places_[i].name, found[i], p.moved_to[i] * places_[i].share * detection);
  // Where an object is out of view and found nowhere else, nothing is known: a later view tells.
  const double known = 1 - solution_.hidden[o];
  if (object.status == Status::gone || known < kParameters.min_observed) return;
  const double away = std::max(1e-9, 1 - p.here), left = solution_.disappear[o];
  if (in_view >= kParameters.min_observed)
    model.learn_carried_off(left * p.carried_off / away, in_view * p.carried_off);
  // Part of what was handled was so before the last view of the spot.
  const double now = object.probability_here * p.interaction / away;
  const double handled = (left + solution_.move.row(row).sum()) * now / known;
  const double age = object.exposure_s - object.last_seen_exposure_s;
  model.learn_interaction(interaction_key(object), object.interaction, age,
                          age + timing_.exposure_s - object.exposure_s, std::min(1.0, handled), known,
                          options_);
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
    if (kind == known.size()) continue;  // textures are compared by a table that is not learned
    Calibration::Counts* counts[] = {&state_.calibration.of(kind, false), &state_.calibration.of(kind, true)};
    for (const Eigen::Index o : confirmed) {
      for (Eigen::Index k = 0; k < evidence.distance.cols(); ++k) {
        const double distance = evidence.distance(o, k);
        if (!std::isfinite(distance)) continue;
        if (kind == kMeanColor) {
          state_.calibration.count_color(distance, solution_.stay(o, k) + solution_.move(o, k));
          continue;
        }
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

void SceneUpdate::weigh_clutter(ProtoObject& object, double if_clutter, double if_object) const {
  const double clutter = object.clutter_probability * if_clutter;
  object.clutter_probability =
      clutter / std::max(1e-300, clutter + (1 - object.clutter_probability) * if_object);
}

void SceneUpdate::learn_clutter(ProtoObject& object) {
  if (object.clutter_probability > 0) state_.interaction.learn_clutter(object.clutter_probability, options_);
  object.clutter_probability = 0;
}

void SceneUpdate::learn_arrivals() {
  std::vector<double> found(places_.size(), 0.0);
  for (size_t k = 0; k < scene_.observations.size(); ++k)
    found[index_of(places_, scene_.observations[k].place)] += solution_.appear[k] + solution_.clutter[k];
  for (size_t i = 0; i < places_.size(); ++i)
    state_.interaction.learn_arrivals(places_[i], found[i], options_);
}

}  // namespace loci::memory::belief
