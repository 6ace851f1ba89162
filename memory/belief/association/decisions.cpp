#include "memory/belief/association/decisions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

constexpr double kMinProbability = 0.01;  ///< of a stored candidate
constexpr size_t kMinCandidates = 2;      ///< stored however improbable; 1 if settled
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Candidate candidate_of(const BeliefUpdate& update, Eigen::Index o, Eigen::Index k) {
  Candidate candidate;
  const ObjectOutcome& outcome = update.objects[static_cast<size_t>(o)];
  candidate.key = outcome.key;
  candidate.object = outcome.object;
  for (const PartnerProbability& partner : update.observations[static_cast<size_t>(k)].partners) {
    if (partner.key != outcome.key) continue;
    candidate.stay = static_cast<float>(partner.stay);
    candidate.move = static_cast<float>(partner.move);
    candidate.newview = static_cast<float>(partner.newview);
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
  decision.explanation = outcome.explanation;
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
  const size_t count = std::min(order.size(), settled ? 1 : kMinCandidates);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end());
  for (size_t i = 0; i < order.size(); ++i) {
    const int64_t key = update.objects[static_cast<size_t>(order[i].second)].key;
    const bool probable = std::ranges::any_of(outcome.partners, [&](const PartnerProbability& partner) {
      return partner.key == key && (partner.probability() >= kMinProbability || key == outcome.key);
    });
    if (i < count || probable) decision.candidates.push_back(candidate_of(update, order[i].second, k));
  }
  std::stable_sort(decision.candidates.begin(), decision.candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.probability() > b.probability(); });
  return decision;
}

ObjectDecision object_decision(const ObjectOutcome& outcome) {
  const Visibility& v = outcome.visibility;
  return {outcome.explanation,
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

bool was_observed(Explanation explanation) {
  return explanation == Explanation::stay || explanation == Explanation::move ||
         explanation == Explanation::newview;
}

uint8_t rounded(double value, double step) {
  if (!std::isfinite(value)) return SceneMatrices::kNone8;
  return static_cast<uint8_t>(std::clamp(std::round(value / step), 0.0, 254.0));
}

uint16_t millimetres(double metres) {
  const double mm = std::round(1000 * metres);
  return mm < SceneMatrices::kNone16 ? static_cast<uint16_t>(mm) : SceneMatrices::kNone16;
}

std::vector<Eigen::Index> columns_of(const BeliefUpdate& update, const Decisions& decisions) {
  std::vector<Eigen::Index> columns;
  for (size_t o = 0; o < update.objects.size(); ++o) {
    const ObjectOutcome& outcome = update.objects[o];
    const bool considered =
        std::ranges::any_of(decisions.observations, [&](const ObservationDecision& decision) {
          return std::ranges::any_of(decision.candidates,
                                     [&](const Candidate& c) { return c.key == outcome.key; });
        });
    if (considered || outcome.visibility.out_of_view < kParameters.out_of_view)
      columns.push_back(static_cast<Eigen::Index>(o));
  }
  return columns;
}

/// Distances of the first of these kinds that the scene has.
std::vector<double> stored_distances(const SceneMatrices& matrices,
                                     std::initializer_list<const char*> kinds) {
  std::vector<double> values;
  for (const char* kind : kinds) {
    const auto found = std::ranges::find(matrices.kinds, kind);
    if (found == matrices.kinds.end()) continue;
    for (const uint8_t distance : matrices.distances[static_cast<size_t>(found - matrices.kinds.begin())])
      values.push_back(distance == SceneMatrices::kNone8 ? kInfinity
                                                         : distance * SceneMatrices::kDistanceStep);
    return values;
  }
  values.assign(matrices.rows * matrices.keys.size(), kInfinity);
  return values;
}

}  // namespace

Decisions decisions_of(const BeliefUpdate& update) {
  Decisions decisions;
  for (const PairEvidence::Distances& d : update.evidence.distances) decisions.kinds.push_back(d.kind);
  for (size_t k = 0; k < update.observations.size(); ++k)
    decisions.observations.push_back(observation_decision(update, static_cast<Eigen::Index>(k)));
  for (const ObjectOutcome& outcome : update.objects)
    if (outcome.object != 0 && !was_observed(outcome.explanation) &&
        outcome.visibility.out_of_view < kParameters.out_of_view)
      decisions.unobserved.push_back(object_decision(outcome));
  decisions.gate_bound = static_cast<float>(update.gate_bound);
  return decisions;
}

std::string rejection_reason(const Decisions& decisions, size_t observation, const Candidate& candidate) {
  for (size_t k = 0; k < decisions.observations.size(); ++k)
    if (k != observation && decisions.observations[k].key == candidate.key)
      return fmt::format("an object is in one place only: it is observation {} ({:.0f} %)", k,
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

SceneMatrices matrices_of(const BeliefUpdate& update, const Decisions& decisions) {
  SceneMatrices matrices;
  const PairEvidence& evidence = update.evidence;
  const std::vector<Eigen::Index> columns = columns_of(update, decisions);
  matrices.rows = static_cast<uint32_t>(update.observations.size());
  for (const Eigen::Index o : columns) {
    matrices.keys.push_back(update.objects[static_cast<size_t>(o)].key);
    matrices.objects.push_back(update.objects[static_cast<size_t>(o)].object);
  }
  for (const PairEvidence::Distances& d : evidence.distances) {
    matrices.kinds.push_back(d.kind);
    std::vector<uint8_t>& table = matrices.distances.emplace_back();
    for (Eigen::Index k = 0; k < evidence.offset.cols(); ++k)
      for (const Eigen::Index o : columns)
        table.push_back(rounded(d.distance(o, k), SceneMatrices::kDistanceStep));
  }
  for (Eigen::Index k = 0; k < evidence.offset.cols(); ++k)
    for (const Eigen::Index o : columns) {
      matrices.offsets.push_back(millimetres(evidence.offset(o, k)));
      matrices.similarity.push_back(rounded(evidence.similarity(o, k), 1.0 / 254));
    }
  return matrices;
}

std::vector<TrackerVotes> votes(const SceneMatrices& matrices) {
  TrackerDistances distances{matrices.rows, matrices.keys, {}};
  for (const uint16_t offset : matrices.offsets)
    distances.of[0].push_back(offset == SceneMatrices::kNone16 ? kInfinity : 0.001 * offset);
  distances.of[1] = stored_distances(matrices, {"extents"});
  distances.of[2] = stored_distances(matrices, {"color_histogram", "mean_color"});
  return votes(distances);
}

void ArbiterCount::add(const SceneMatrices& matrices, const Decisions& decisions) {
  const std::vector<TrackerVotes> voted = votes(matrices);
  for (size_t k = 0; k < std::min(voted.size(), decisions.observations.size()); ++k) {
    ++observations;
    if (!voted[k].settled) continue;
    ++settled;
    as_decided += voted[k].settled == decisions.observations[k].key ? 1 : 0;
  }
}

}  // namespace loci::memory::belief
