#include "memory/belief/association/scene_update.h"

#include <algorithm>
#include <map>

#include "memory/belief/association/association_problem.h"
#include "memory/belief/evidence/proximity.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

/// Alternatives but the track itself, most probable first.
std::vector<Alternative> ranked_alternatives(const std::map<int64_t, double>& keys, int64_t itself,
                                             double sum) {
  std::vector<Alternative> list;
  for (const auto& [key, weight] : keys)
    if (key != itself && weight / sum >= kParameters.min_alternative) list.push_back({key, weight / sum});
  std::stable_sort(list.begin(), list.end(),
                   [](const Alternative& a, const Alternative& b) { return a.probability > b.probability; });
  return list;
}

}  // namespace

SceneUpdate::SceneUpdate(BeliefState& state, const Scene& scene, const BeliefOptions& options)
    : state_(state), scene_(scene), options_(options), timing_(state, scene, options) {}

BeliefUpdate SceneUpdate::run() {
  drop_doubles();
  note_uses();
  // 1. Prediction: where each object is now, whether it still is, and what observing its spot showed.
  places_ = view_places(state_, scene_, options_);
  predicted_ = predict(state_, scene_, places_, options_);
  surfaces_ = sample_surfaces(scene_.view, scene_.observations.size(), kParameters.surface_points);
  // 2. Evidence of each pair of object and observation; the arbiter settles what all trackers agree on.
  update_.evidence = pair_evidence(state_, predicted_, scene_, options_);
  // 3. Association: exact posterior of all explanations, and the MAP hypothesis that is acted on.
  solve_association();
  choose_partners();
  join_pieces();
  reinstate_alternatives();
  report_observations();
  report_objects();
  if (timing_.independent) learn_view_noise();
  if (timing_.independent) learn_similarity();
  if (timing_.independent) learn_interactions();
  const std::vector<std::vector<Alternative>> alternatives = propagated_alternatives();
  // 4. Update of the believed objects, observed and unobserved.
  const size_t believed = state_.objects.size();
  for (size_t o = 0; o < believed; ++o) {
    if (partner_of_object_[o])
      update_observed(o, *partner_of_object_[o]);
    else
      update_unobserved(o);
  }
  for (size_t o = 0; o < believed; ++o) state_.objects[o].alternatives = alternatives[o];
  // 5. New objects and alternative hypotheses. Keys ascend in the order of the objects, as they are stored.
  for (size_t k = 0; k < scene_.observations.size(); ++k)
    if (!partner_of_observation_[k]) create_object(k);
  for (ProtoObject& alternative : alternatives_) {
    alternative.key = state_.next_key++;
    state_.objects.push_back(std::move(alternative));
  }
  // 6. Existence: confirm, delete and prune objects.
  if (timing_.independent) learn_arrivals();
  for (const PlaceView& view : places_) state_.places[view.name].add_view(timing_.exposure_s, view.share);
  if (scene_.seconds_to_next && *scene_.seconds_to_next >= options_.snapshot_gap_s) confirm_unrefuted();
  state_.exposure_s = timing_.exposure_s;
  delete_clutter();
  finish_outcomes();
  prune_gone();
  state_.last_scene = scene_.time;
  return std::move(update_);
}

void SceneUpdate::note_uses() {
  for (auto& [name, place] : state_.places) {
    if (!is_place_known(name, scene_.places)) continue;
    const Isometry3d& now = place_pose(name, scene_.places);
    const bool used = camera_motion(place.map_from_place, now) > kParameters.use_motion;
    place.map_from_place = now;
    if (!used || !timing_.independent) continue;  // a video shows what is taken out
    const auto lies_there = [&](const ProtoObject& object) {
      return object.place == name && object.status == Status::present;
    };
    const auto contents = std::ranges::count_if(state_.objects, lies_there);
    for (ProtoObject& object : state_.objects)
      if (lies_there(object)) object.uses += 1 / static_cast<double>(contents);
  }
}

void SceneUpdate::solve_association() {
  update_.problem = association_problem(state_, predicted_, scene_, places_, update_.evidence, options_);
  IdentityOptions identity;
  identity.best = 1;
  identity.gate = kParameters.gate;
  identity.priors.clutter = 0;
  identity.priors.missed = 0;
  weights_ = weights_of(update_.problem, identity);
  solution_ = solve(weights_, identity);
  update_.log_evidence = solution_.log_evidence;
  update_.log_likelihood_ratio = solution_.log_z;
  update_.gate_bound = solution_.gate_bound;
}

void SceneUpdate::choose_partners() {
  partner_of_object_.resize(state_.objects.size());
  partner_of_observation_.resize(scene_.observations.size());
  merged_.resize(state_.objects.size());
  for (const auto& [o, k] : solution_.map.pairs) pair(o, k);
  if (timing_.snapshot) return;
  for (size_t k = 0; k < partner_of_observation_.size(); ++k) prefer_known_object(k);
}

void SceneUpdate::pair(size_t o, size_t k) {
  partner_of_object_[o] = k;
  partner_of_observation_[k] = o;
}

double SceneUpdate::log_proximity(size_t o, size_t k) const {
  return update_.evidence.log_proximity(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(k));
}

double SceneUpdate::color_log_ratio(size_t o, size_t k) const {
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  return update_.evidence.log_similar(row, column) -
         options_.appearance_weight * update_.evidence.log_size(row, column);
}

void SceneUpdate::prefer_known_object(size_t k) {
  if (scene_.observations[k].known_object) return;
  const std::optional<size_t> now = partner_of_observation_[k];
  if (now && (state_.objects[*now].status != Status::tentative || state_.objects[*now].alternative_of != 0))
    return;
  std::optional<size_t> known;
  double best = kParameters.covered;
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    if (state_.objects[o].status != Status::present || partner_of_object_[o]) continue;
    const AxisBox& seen = scene_.observations[k].box;
    // Nearness does not overrule the evidence of the model.
    if (pair_probability(o, k) < kParameters.min_probability) continue;
    const double covered = covered_share(predicted_[o], seen);
    if (covered <= best || color_log_ratio(o, k) < kParameters.min_color_log_ratio ||
        seen.volume() > kParameters.max_covering_volume * predicted_[o].box.volume())
      continue;
    best = covered;
    known = o;
  }
  if (!known) return;
  if (now) {
    partner_of_object_[*now].reset();
    state_.objects[*now].exists_log_odds = kParameters.is_double_log_odds;
  }
  pair(*known, k);
}

Explanation SceneUpdate::pair_explanation(size_t o, size_t k) const {
  if (merged_[o] > 0) return Explanation::stay;
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  const double stay = weights_.stay(row, column), move = weights_.move(row, column),
               newview = weights_.newview(row, column);
  if (stay >= move && stay >= newview) return Explanation::stay;
  // Somebody who moves what was seen just now would have been seen, too.
  const bool watched = in_seconds(scene_.time - state_.objects[o].last_seen) < options_.snapshot_gap_s;
  if (watched && covered_share(predicted_[o], scene_.observations[k].box) > kParameters.covered)
    return Explanation::stay;
  return move >= newview ? Explanation::move : Explanation::newview;
}

void SceneUpdate::report_observations() {
  for (size_t k = 0; k < scene_.observations.size(); ++k) {
    ObservationOutcome outcome;
    const auto column = static_cast<Eigen::Index>(k);
    for (size_t o = 0; o < state_.objects.size(); ++o) {
      const auto row = static_cast<Eigen::Index>(o);
      const PartnerProbability partner{state_.objects[o].key, state_.objects[o].id,
                                       solution_.stay(row, column) + in_cluster(o, k),
                                       solution_.move(row, column), solution_.newview(row, column)};
      if (partner_of_observation_[k] == o) {
        outcome.key = partner.key;
        outcome.explanation = pair_explanation(o, k);
        outcome.probability = partner.probability();
      }
      if (partner.probability() >= kParameters.min_probability || partner_of_observation_[k] == o)
        outcome.partners.push_back(partner);
    }
    std::stable_sort(outcome.partners.begin(), outcome.partners.end(),
                     [](const PartnerProbability& a, const PartnerProbability& b) {
                       return a.probability() > b.probability();
                     });
    outcome.appear = solution_.appear[k];
    outcome.clutter = solution_.clutter[k];
    outcome.clutter += piece_probability_[k] * outcome.appear;
    outcome.appear *= 1 - piece_probability_[k];
    update_.observations.push_back(std::move(outcome));
  }
}

void SceneUpdate::report_objects() {
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    ObjectOutcome outcome;
    outcome.key = state_.objects[o].key;
    outcome.visibility = predicted_[o].seen.visibility;
    outcome.disappear = solution_.disappear[o];
    outcome.missed = solution_.missed[o];
    outcome.hidden = solution_.hidden[o];
    outcome.matched = std::max(0.0, 1 - outcome.disappear - outcome.missed - outcome.hidden);
    update_.objects.push_back(outcome);
  }
}

std::vector<std::vector<Alternative>> SceneUpdate::propagated_alternatives() const {
  std::vector<std::vector<Alternative>> propagated;
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    if (state_.objects[o].id == 0) {
      propagated.emplace_back();
      continue;
    }
    std::map<int64_t, double> keys;
    double sum = 0;
    const auto add = [&](size_t other, double weight) {
      if (weight <= 0 || state_.objects[other].id == 0) return;
      sum += weight;
      keys[state_.objects[other].key] += weight * state_.objects[other].probability_itself();
      for (const Alternative& alternative : state_.objects[other].alternatives)
        keys[alternative.key] += weight * alternative.probability;
    };
    if (const std::optional<size_t> partner = partner_of_object_[o]) {
      for (size_t other = 0; other < state_.objects.size(); ++other)
        add(other, pair_probability(other, *partner));
    } else {
      double matched = 0;
      for (size_t k = 0; k < scene_.observations.size(); ++k) matched += pair_probability(o, k);
      if (matched < kParameters.min_alternative) {
        propagated.push_back(state_.objects[o].alternatives);
        continue;
      }
      for (size_t k = 0; k < scene_.observations.size(); ++k)
        if (partner_of_observation_[k]) add(*partner_of_observation_[k], pair_probability(o, k));
      add(o, std::max(0.0, 1 - matched));
    }
    propagated.push_back(ranked_alternatives(keys, state_.objects[o].key, sum));
  }
  return propagated;
}

double SceneUpdate::pair_probability(size_t o, size_t k) const {
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  return solution_.stay(row, column) + solution_.move(row, column) + solution_.newview(row, column) +
         in_cluster(o, k);
}

double SceneUpdate::in_cluster(size_t o, size_t k) const {
  return partner_of_observation_[k] == o ? merged_[o] : 0;
}

void SceneUpdate::finish_outcomes() {
  std::map<int64_t, const ProtoObject*> by_key;
  for (const ProtoObject& object : state_.objects) by_key[object.key] = &object;
  const auto find = [&](int64_t key) {
    const auto found = by_key.find(key);
    return found == by_key.end() ? nullptr : found->second;
  };
  const auto id_of = [&](int64_t key) {
    const ProtoObject* object = find(key);
    return object == nullptr ? int64_t{0} : object->id;
  };
  for (ObservationOutcome& outcome : update_.observations) {
    outcome.object = id_of(outcome.key);
    for (PartnerProbability& partner : outcome.partners) partner.object = id_of(partner.key);
  }
  for (ObjectOutcome& outcome : update_.objects) {
    outcome.object = id_of(outcome.key);
    if (const ProtoObject* object = find(outcome.key))
      outcome.probability_here = probability_here(*object, state_, options_);
  }
}

}  // namespace loci::memory::belief
