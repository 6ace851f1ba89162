// Stages of SceneUpdate about one object that is observed or believed as several, and several observed as
// one.

#include <algorithm>
#include <cmath>

#include "memory/belief/association/scene_update.h"
#include "memory/belief/evidence/proximity.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

AxisBox grown(AxisBox box, double margin) {
  box.size += Vector3d::Constant(2 * margin);
  return box;
}

/// Whether two boxes are as near to each other as their faces are uncertain.
bool touch(const AxisBox& a, const AxisBox& b, double sigma) {
  return shared_volume(grown(a, sigma + kParameters.extent_noise_m), b) > 0;
}

/// Keeps those of some boxes that touch the first one, or one that does.
void keep_connected(std::vector<size_t>& parts, const std::vector<Prediction>& predicted) {
  auto end = parts.empty() ? parts.end() : parts.begin() + 1;
  for (auto from = parts.begin(); from != end; ++from)
    end = std::stable_partition(end, parts.end(), [&](size_t o) {
      return touch(predicted[*from].box, predicted[o].box,
                   std::sqrt(predicted[*from].variance + predicted[o].variance));
    });
  parts.erase(end, parts.end());
}

}  // namespace

void SceneUpdate::join_pieces() {
  piece_probability_.resize(scene_.observations.size());
  is_double_.resize(state_.objects.size());
  for (size_t k = 0; k < scene_.observations.size(); ++k) find_merged(k);
  for (size_t k = 0; k < scene_.observations.size(); ++k) find_further_piece(k);
  for (size_t k = 0; k < scene_.observations.size(); ++k) find_doubles(k);
}

std::vector<size_t> SceneUpdate::possible_parts(size_t k) const {
  const Observation& seen = scene_.observations[k];
  std::vector<size_t> parts;
  // In a video the frames before and after show them apart.
  if (!timing_.snapshot || seen.partial || !seen.has_size || seen.known_object) return parts;
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    const ProtoObject& object = state_.objects[o];
    const Prediction& p = predicted_[o];
    // Of what was seen in part only, the rest may be another part: see find_doubles().
    if (object.status != Status::present || !object.has_size || object.partial || !p.with_depth ||
        merged_[o] > 0 || partner_of_object_[o].value_or(k) != k)
      continue;
    const AxisBox around = grown(seen.box, std::sqrt(p.variance) + kParameters.extent_noise_m);
    if (shared_volume(p.box, around) >= kParameters.double_covered * p.box.volume()) parts.push_back(o);
  }
  std::ranges::stable_sort(parts, std::greater(), [&](size_t o) { return predicted_[o].box.volume(); });
  keep_connected(parts, predicted_);
  if (parts.size() < 2) parts.clear();
  return parts;
}

double SceneUpdate::log_absent(size_t o) const {
  return log_add(log_add(weights_.disappear[o], weights_.missed[o]), weights_.hidden[o]);
}

double SceneUpdate::merged_probability(size_t k, const std::vector<size_t>& parts) const {
  const Observation& seen = scene_.observations[k];
  const std::optional<size_t> now = partner_of_observation_[k];
  AxisBox box = predicted_[parts.front()].box;
  double merged = std::log(kParameters.joined_cluster), color = 0;
  double apart = now ? weights_.total(static_cast<Eigen::Index>(*now), static_cast<Eigen::Index>(k))
                     : log_add(weights_.appear[k], weights_.clutter[k]);
  if (now && std::ranges::count(parts, *now) == 0) merged += log_absent(*now);
  for (const size_t o : parts) {
    const Prediction& p = predicted_[o];
    box = join(box, p.box);
    merged += std::log(std::max(1e-6, p.here)) + p.log_surface;
    color = std::max(color, color_log_ratio(o, k));  // of the part that shows most
    if (now != o) apart += log_absent(o);
  }
  const size_t largest = parts.front();
  const PositionNoise noise = position_noise(state_.objects[largest], predicted_[largest], seen,
                                             state_.view_noise.weights(options_.noise_spread), options_);
  merged += color + belief::log_proximity(box, noise, false, seen, options_);
  return probability_from_log_odds(merged - apart);
}

void SceneUpdate::find_merged(size_t k) {
  const std::vector<size_t> parts = possible_parts(k);
  if (parts.empty()) return;
  const double merged = merged_probability(k, parts);
  if (merged <= 0.5) return;
  const std::optional<size_t> now = partner_of_observation_[k];
  const bool is_part = now && std::ranges::count(parts, *now) > 0;
  if (now) partner_of_object_[*now].reset();
  pair(is_part ? *now : parts.front(), k);
  for (const size_t o : parts) merged_[o] = merged;
  share_with_merged(k, parts, merged);
}

void SceneUpdate::share_with_merged(size_t k, const std::vector<size_t>& parts, double merged) {
  // What another hypothesis pairs is not found, or new, in this one.
  const auto unpair = [&](size_t o, size_t other, bool is_part) {
    const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(other);
    const double lost = merged * pair_probability(o, other);
    for (PairTable* table : {&solution_.stay, &solution_.move, &solution_.newview})
      (*table)(row, column) *= 1 - merged;
    if (!is_part) solution_.disappear[o] += lost;
    if (other != k) solution_.appear[other] += lost;
  };
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    const bool is_part = std::ranges::count(parts, o) > 0;
    for (size_t other = 0; other < scene_.observations.size(); ++other)
      if (is_part || other == k) unpair(o, other, is_part);
    if (!is_part) continue;
    for (std::vector<double>* absent : {&solution_.disappear, &solution_.missed, &solution_.hidden})
      (*absent)[o] *= 1 - merged;
    if (partner_of_observation_[k] != o) solution_.missed[o] += merged;
  }
  solution_.appear[k] *= 1 - merged;
  solution_.clutter[k] *= 1 - merged;
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
    if (partner_of_object_[o] || is_double_[o] || merged_[o] > 0 || object.status != Status::present ||
        !object.has_size || shared_volume(box, seen.box) < kParameters.double_covered * box.volume() ||
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
