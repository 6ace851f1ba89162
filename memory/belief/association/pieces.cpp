// Stages of SceneUpdate about one object that is observed or believed as several.

#include <algorithm>
#include <cmath>

#include "memory/belief/association/scene_update.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {

void SceneUpdate::join_pieces() {
  piece_probability_.resize(scene_.observations.size());
  is_double_.resize(state_.objects.size());
  for (size_t k = 0; k < scene_.observations.size(); ++k) find_further_piece(k);
  for (size_t k = 0; k < scene_.observations.size(); ++k) find_doubles(k);
}

double SceneUpdate::expected_pieces(size_t o, size_t k) const {
  const Observation &piece = scene_.observations[k], &found = scene_.observations[*partner_of_object_[o]];
  if (!piece.partial || !found.partial || !piece.has_size || found.known_object ||
      pair_explanation(o, *partner_of_object_[o]) == Explanation::move)
    return 0;
  const Vector3d& size = predicted_[o].box.size;
  const double footprint = std::max(kParameters.min_footprint_m2, size.x() * size.y());
  return kParameters.further_pieces * covered_share(predicted_[o], piece.box) * options_.area_m2 / footprint *
         std::exp(std::min(color_log_ratio(o, k), kParameters.max_piece_color));
}

void SceneUpdate::find_further_piece(size_t k) {
  if (partner_of_observation_[k] || scene_.observations[k].known_object) return;
  const double appears = std::exp(update_.problem.appear_prior[k]);
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    if (!partner_of_object_[o]) continue;
    const double expected = expected_pieces(o, k);
    if (expected <= appears) continue;
    size_t piece = k;
    if (scene_.observations[k].points > scene_.observations[*partner_of_object_[o]].points) {
      piece = *partner_of_object_[o];
      partner_of_observation_[piece].reset();
      pair(o, k);
    }
    piece_probability_[piece] = expected / (expected + appears);
    return;
  }
}

void SceneUpdate::find_doubles(size_t k) {
  const Observation& seen = scene_.observations[k];
  if (!partner_of_observation_[k] || !seen.has_size || seen.partial) return;
  if (pair_explanation(*partner_of_observation_[k], k) == Explanation::move) return;
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    const ProtoObject& object = state_.objects[o];
    const AxisBox& box = predicted_[o].box;
    if (partner_of_object_[o] || is_double_[o] || object.status != Status::present || !object.has_size ||
        shared_volume(box, seen.box) < kParameters.double_covered * box.volume() ||
        color_log_ratio(o, k) < 0 || log_proximity(o, k) < 0)
      continue;
    const size_t other = *partner_of_observation_[k];
    const bool is_known_better =
        !seen.known_object && object.observation_count > state_.objects[other].observation_count;
    is_double_[is_known_better ? other : o] = true;
    if (!is_known_better) continue;
    partner_of_object_[other].reset();
    pair(o, k);
  }
}

void SceneUpdate::remove_double(size_t o) {
  ProtoObject& object = state_.objects[o];
  object.exists_log_odds = kParameters.is_double_log_odds;
  if (object.status == Status::tentative) return;
  object.probability_here = 0;
  update_.objects[o].explanation = Explanation::disappear;
  set_gone(o);
}

void SceneUpdate::drop_doubles() {
  std::erase_if(state_.objects, [](const ProtoObject& object) {
    return object.status == Status::gone && object.exists_log_odds <= kParameters.is_double_log_odds;
  });
}

}  // namespace loci::memory::belief
