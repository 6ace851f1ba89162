#include "memory/belief/belief.h"

#include <map>

#include "memory/belief/step.h"

namespace loci::memory::belief {

Step::Step(BeliefState& state, const Scene& scene, const BeliefOptions& options)
    : state_(state),
      scene_(scene),
      options_(options),
      snapshot_(is_snapshot(state, scene, options)),
      seconds_(seconds_since_last_scene(state, scene)),
      apart_(seconds_ >= options.snapshot_gap_s),
      attention_(attention_at(state, scene, options)) {}

BeliefUpdate Step::run() {
  expected_ = expect(state_, scene_, options_);
  update_.evidence = pair_evidence(state_, expected_, scene_, options_);
  update_.problem = identity_problem(state_, expected_, scene_, update_.evidence, options_);
  IdentityOptions identity;
  identity.best = 1;
  identity.gate = 1e-4;  // a tenth of the smallest share that is told
  identity.priors.clutter = 0;
  identity.priors.missed = 0;
  weights_ = weights_of(update_.problem, identity);
  solution_ = solve(weights_, identity);
  update_.log_evidence = solution_.log_evidence;
  update_.gate_bound = solution_.gate_bound;
  pair_up();
  reclaim_leftovers();
  report_distributions();
  if (apart_) learn_likeness();
  const std::vector<std::vector<Alternative>> alternatives = mixed_alternatives();
  const size_t believed = state_.objects.size();
  for (size_t o = 0; o < believed; ++o) {
    if (partner_of_object_[o])
      see(o, *partner_of_object_[o]);
    else
      miss(o);
  }
  for (size_t o = 0; o < believed; ++o) state_.objects[o].alternatives = alternatives[o];
  for (size_t k = 0; k < scene_.observations.size(); ++k)
    if (!partner_of_observation_[k]) meet(k);
  for (ProtoObject& leftover : leftovers_) {
    leftover.key =
        state_.next_key++;  // Only now: objects stand in the order of their keys, as they are stored.
    state_.objects.push_back(std::move(leftover));
  }
  if (apart_) learn_arrivals();
  if (scene_.seconds_to_next && *scene_.seconds_to_next >= options_.snapshot_gap_s) confirm_unrefuted();
  state_.attention_s = attention_;
  forget_clutter();
  finish_outcomes();
  retire();
  state_.last_scene = scene_.time;
  return std::move(update_);
}

void Step::finish_outcomes() {
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
    for (Share& share : outcome.shares) share.object = id_of(share.key);
  }
  for (ObjectOutcome& outcome : update_.objects) {
    outcome.object = id_of(outcome.key);
    if (const ProtoObject* object = find(outcome.key))
      outcome.probability_here = probability_here(*object, state_, options_);
  }
}

BeliefUpdate advance(BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  if (state.last_scene && scene.time < *state.last_scene)
    throw Error(
        "a scene at " + format_time(scene.time) + " comes after one at " + format_time(*state.last_scene), {},
        "perceive recordings in the order of time");
  return Step(state, scene, options).run();
}

}  // namespace loci::memory::belief
