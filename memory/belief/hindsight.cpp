#include "memory/belief/hindsight.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

constexpr int64_t kNewObject = -1;  ///< as Observation::known_object

/// An observation, the object that it was taken for, and those that it might be.
struct Decision {
  int64_t observation = 0, object = 0;
  std::vector<int64_t> candidates;
};

class Hindsight {
 public:
  Hindsight(const BeliefState& before, const std::vector<Scene>& scenes, const BeliefOptions& options)
      : scenes_(scenes), options_(options), state_(before), decisions_(scenes.size()) {}

  std::map<int64_t, Supposition> find(Progress& progress) {
    for (size_t i = 0; i < scenes_.size() && advances_ < kParameters.hindsight_advances;) {
      progress.check(static_cast<double>(i) / static_cast<double>(scenes_.size()), "looking back");
      BeliefState before = state_;
      const BeliefUpdate update = advanced(state_, i, known_);
      note(i, update, std::move(before));
      i = revised(i, update).value_or(i + 1);
    }
    return known_;
  }

 private:
  BeliefUpdate advanced(BeliefState& state, size_t i, const std::map<int64_t, Supposition>& known) {
    ++advances_;
    Scene scene = scenes_[i];
    for (Observation& observation : scene.observations)
      if (const auto one = known.find(observation.id); one != known.end())
        observation.known_object = one->second.object;
    return advance(state, scene, options_);
  }

  /// Decisions of a scene, and the belief before it where one of them was a guess.
  void note(size_t i, const BeliefUpdate& update, BeliefState before) {
    decisions_[i].clear();
    bool guessed = false;
    for (size_t k = 0; k < update.observations.size(); ++k) {
      const ObservationOutcome& outcome = update.observations[k];
      if (outcome.object == 0) continue;
      Decision& decision = decisions_[i].emplace_back();
      decision.observation = scenes_[i].observations[k].id;
      decision.object = outcome.object;
      const bool guess =
          outcome.explanation == Explanation::move && outcome.probability <= kParameters.certain_partner;
      if (!guess || scenes_[i].observations[k].known_object) continue;  // people know
      guessed = true;
      for (const PartnerProbability& partner : outcome.partners)
        if (partner.object != 0 && partner.probability() >= kParameters.min_alternative)
          decision.candidates.push_back(partner.object);
      decision.candidates.push_back(kNewObject);
    }
    before_.erase(before_.upper_bound(i), before_.end());
    if (guessed)
      before_.insert_or_assign(i, std::move(before));
    else
      before_.erase(i);
  }

  /// The scene to go on with, from which on more is known now; unset = nothing new.
  std::optional<size_t> revised(size_t i, const BeliefUpdate& update) {
    for (const Mistake& mistake : update.mistakes) {
      const auto [first, decision] = first_mistaken(mistake, i);
      if (decision == nullptr || !judged_.insert(decision->observation).second) continue;
      const Supposition best = most_probable(*decision, first, i);
      if (best.object == decision->object) continue;
      known_[decision->observation] = best;
      state_ = before_.at(first);
      return first;
    }
    return std::nullopt;
  }

  /// The first guess by which something else was taken for the object; null where none is known.
  std::pair<size_t, const Decision*> first_mistaken(const Mistake& mistake, size_t end) const {
    for (size_t i = 0; i < end; ++i) {
      if (scenes_[i].time <= mistake.since) continue;
      for (const Decision& decision : decisions_[i])
        if (decision.object == mistake.object)
          return {i, decision.candidates.empty() || !before_.contains(i) ? nullptr : &decision};
    }
    return {0, nullptr};
  }

  /// Under which supposition the scenes from `first` to `last` are most probable; what was decided, where
  /// none is clearly more probable.
  Supposition most_probable(const Decision& decision, size_t first, size_t last) {
    std::map<int64_t, double> log_likelihood;
    for (const int64_t candidate : decision.candidates) {
      std::map<int64_t, Supposition> supposed = known_;
      supposed[decision.observation] = {candidate};
      BeliefState state = before_.at(first);
      for (size_t i = first; i <= last; ++i)
        log_likelihood[candidate] += advanced(state, i, supposed).log_likelihood_ratio;
    }
    const auto best =
        std::ranges::max_element(log_likelihood, {}, [](const auto& one) { return one.second; });
    const bool clear = best->second > log_likelihood[decision.object] + kParameters.min_hindsight_log_ratio;
    if (!clear) return {decision.object};
    double sum = 0;
    for (const auto& [candidate, one] : log_likelihood) sum += std::exp(one - best->second);
    return {best->first, 1 / sum};
  }

  const std::vector<Scene>& scenes_;
  const BeliefOptions& options_;
  BeliefState state_;
  std::vector<std::vector<Decision>> decisions_;  ///< by scene
  std::map<size_t, BeliefState> before_;          ///< scenes in which something was guessed
  std::map<int64_t, Supposition> known_;
  std::set<int64_t> judged_;  ///< observations
  size_t advances_ = 0;
};

}  // namespace

std::map<int64_t, Supposition> hindsight(const BeliefState& before, const std::vector<Scene>& scenes,
                                         const BeliefOptions& options, Progress& progress) {
  return Hindsight(before, scenes, options).find(progress);
}

}  // namespace loci::memory::belief
