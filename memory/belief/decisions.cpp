#include "memory/belief/decisions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace loci::memory::belief {
namespace {

constexpr double kMinProbability = 0.01;
constexpr size_t kMin = 2;  ///< of the best candidates are kept, however improbable; 1 if it was settled

Candidate candidate_of(const BeliefUpdate& update, Eigen::Index o, Eigen::Index k) {
  Candidate candidate;
  const ObjectOutcome& outcome = update.objects[static_cast<size_t>(o)];
  candidate.key = outcome.key;
  candidate.object = outcome.object;
  for (const Share& share : update.observations[static_cast<size_t>(k)].shares) {
    if (share.key != outcome.key) continue;
    candidate.stay = static_cast<float>(share.stay);
    candidate.move = static_cast<float>(share.move);
    candidate.newview = static_cast<float>(share.newview);
  }
  candidate.similar = static_cast<float>(update.evidence.log_similar(o, k));
  candidate.proximity = static_cast<float>(update.evidence.log_proximity(o, k));
  candidate.stay_prior = static_cast<float>(update.problem.stay_prior(o, k));
  candidate.move_prior = static_cast<float>(update.problem.move_prior(o, k));
  candidate.newview_prior = static_cast<float>(update.problem.newview_prior(o, k));
  for (const PairEvidence::Distances& d : update.evidence.distances) {
    candidate.distances.push_back(static_cast<float>(d.distance(o, k)));
    candidate.log_ratios.push_back(static_cast<float>(d.log_ratio(o, k)));
  }
  return candidate;
}

/// Best log weight of a pair under any explanation.
double weight(const BeliefUpdate& update, Eigen::Index o, Eigen::Index k) {
  const double similar = update.evidence.log_similar(o, k), near = update.evidence.log_proximity(o, k);
  return std::max({similar + near + update.problem.stay_prior(o, k),
                   similar + update.problem.move_prior(o, k), near + update.problem.newview_prior(o, k)});
}

ObservationDecision observation_decision(const BeliefUpdate& update, Eigen::Index k) {
  const ObservationOutcome& outcome = update.observations[static_cast<size_t>(k)];
  ObservationDecision decision;
  decision.explanation = static_cast<uint8_t>(outcome.explanation);
  decision.key = outcome.key;
  decision.object = outcome.object;
  decision.probability = static_cast<float>(outcome.probability);
  decision.appear = static_cast<float>(outcome.appear);
  decision.clutter = static_cast<float>(outcome.clutter);
  decision.appear_prior = static_cast<float>(update.problem.appear_prior[static_cast<size_t>(k)]);
  decision.clutter_prior = static_cast<float>(update.problem.clutter_prior[static_cast<size_t>(k)]);
  std::vector<std::pair<double, Eigen::Index>> order;
  for (Eigen::Index o = 0; o < update.evidence.log_similar.rows(); ++o)
    order.emplace_back(-weight(update, o, k), o);
  const bool settled = update.evidence.settled[static_cast<size_t>(k)].has_value();
  const size_t few = std::min(order.size(), settled ? 1 : kMin);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(few), order.end());
  for (size_t i = 0; i < order.size(); ++i) {
    const int64_t key = update.objects[static_cast<size_t>(order[i].second)].key;
    const bool counts = std::any_of(outcome.shares.begin(), outcome.shares.end(), [&](const Share& share) {
      return share.key == key && (share.probability() >= kMinProbability || key == outcome.key);
    });
    if (i < few || counts) decision.candidates.push_back(candidate_of(update, order[i].second, k));
  }
  std::stable_sort(decision.candidates.begin(), decision.candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.probability() > b.probability(); });
  return decision;
}

ObjectDecision object_decision(const ObjectOutcome& outcome) {
  const Visibility& v = outcome.visibility;
  return {static_cast<uint8_t>(outcome.explanation),
          outcome.key,
          outcome.object,
          static_cast<float>(v.out_of_view),
          static_cast<float>(v.hidden),
          static_cast<float>(v.unmeasured),
          static_cast<float>(v.occupied),
          static_cast<float>(v.seen_through),
          static_cast<float>(v.searched),
          static_cast<float>(outcome.disappear),
          static_cast<float>(outcome.missed),
          static_cast<float>(outcome.hidden),
          static_cast<float>(outcome.probability_here)};
}

bool was_seen(Explanation explanation) {
  return explanation == Explanation::stay || explanation == Explanation::move ||
         explanation == Explanation::newview;
}

}  // namespace

Decisions decisions_of(const BeliefUpdate& update) {
  Decisions decisions;
  for (const PairEvidence::Distances& d : update.evidence.distances) decisions.kinds.push_back(d.kind);
  for (size_t k = 0; k < update.observations.size(); ++k)
    decisions.observations.push_back(observation_decision(update, static_cast<Eigen::Index>(k)));
  for (const ObjectOutcome& outcome : update.objects)
    if (outcome.object != 0 && !was_seen(outcome.explanation) && outcome.visibility.out_of_view < 0.99)
      decisions.unseen.push_back(object_decision(outcome));
  decisions.gate_bound = static_cast<float>(update.gate_bound);
  return decisions;
}

std::vector<float> Decisions::log_ratios() const {
  std::vector<float> all;
  for (const ObservationDecision& observation : observations)
    for (const Candidate& candidate : observation.candidates)
      all.insert(all.end(), candidate.log_ratios.begin(), candidate.log_ratios.end());
  return all;
}

void Decisions::set_log_ratios(const std::vector<float>& all) {
  auto next = all.begin();
  for (ObservationDecision& observation : observations) {
    for (Candidate& candidate : observation.candidates) {
      candidate.log_ratios.clear();
      for (size_t i = 0; i < candidate.distances.size(); ++i) {
        const Comparison* comparison = find_comparison(kinds.at(i));
        candidate.log_ratios.push_back(
            next != all.end()       ? *next++
            : comparison == nullptr ? 0.0F
                                    : static_cast<float>(log_ratio(*comparison, candidate.distances[i])));
      }
    }
  }
}

std::string objection(const Decisions& decisions, size_t observation, const Candidate& candidate) {
  for (size_t k = 0; k < decisions.observations.size(); ++k)
    if (k != observation && decisions.observations[k].key == candidate.key)
      return fmt::format("one thing is in one place: it is taken for observation {} ({:.0f} %)", k,
                         100 * decisions.observations[k].probability);
  std::optional<size_t> worst;
  for (size_t i = 0; i < candidate.log_ratios.size(); ++i)
    if (candidate.log_ratios[i] < (worst ? candidate.log_ratios[*worst] : -1.0F)) worst = i;
  if (worst)
    return fmt::format("its {} differs too much (distance {:.2f}, evidence {:+.1f})", decisions.kinds[*worst],
                       candidate.distances[*worst], candidate.log_ratios[*worst]);
  if (candidate.proximity < 0 && candidate.move_prior < candidate.stay_prior - 1)
    return fmt::format("it stood elsewhere (evidence {:+.1f}) and was probably not moved (prior {:+.1f})",
                       candidate.proximity, candidate.move_prior);
  return "another explanation of the whole scene is more probable";
}

}  // namespace loci::memory::belief
