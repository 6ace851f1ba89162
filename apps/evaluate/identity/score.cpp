#include "apps/evaluate/identity/experiment.h"

#include <algorithm>
#include <cmath>

namespace loci::apps::identity_experiment {
namespace {

size_t old_column(memory::Explanation explanation) {
  switch (explanation) {
    case memory::Explanation::newview:
      return 0;
    case memory::Explanation::move:
      return 1;
    case memory::Explanation::hidden:
      return 2;
    case memory::Explanation::stay:
      return 4;
    default:
      return 3;
  }
}

size_t new_column(memory::Explanation explanation) {
  switch (explanation) {
    case memory::Explanation::stay:
      return 0;
    case memory::Explanation::move:
      return 1;
    case memory::Explanation::newview:
      return 2;
    default:
      return 3;
  }
}

void count_evidence(const SimulatedScene& scene, const std::vector<Believed>& believed, Score& score) {
  for (const Believed& old : believed)
    for (const SimulatedObservation& observation : scene.seen) {
      const PairSimilarity close = compare(old.entry.last, observation.seen, kEffectiveScale);
      if (old.origin.object == observation.origin.object) {
        score.same_position.add(1 - close.proximity);
        score.same_color.add(1 - close.similar);
      } else if (old.entry.last.table == observation.seen.table) {
        score.other_position.add(close.proximity);
        score.other_color.add(close.similar);
      }
    }
}

/// Counts the answers about one side of the scene; reports wrong answers.
struct SideResult {
  bool association = true, explanation = true;
};

SideResult count_side(const std::vector<memory::IdentityDecision>& answers,
                      const std::vector<std::optional<size_t>>& partners,
                      const std::vector<memory::Explanation>& explanations, Success& side, Score& score) {
  SideResult result;
  for (size_t i = 0; i < answers.size(); ++i) {
    const bool association = answers[i].partner == partners[i];
    const bool explanation = answers[i].explanation == explanations[i];
    side.association.add(association);
    side.explanation.add(explanation);
    score.association.add(answers[i].partner_probability, association);
    score.explanation.add(answers[i].explanation_probability, explanation);
    result.association = result.association && association;
    result.explanation = result.explanation && explanation;
  }
  return result;
}

}  // namespace

double Calibration::Bin::allowed() const {
  if (answers.total == 0) return 1;
  const double p = mean_stated();
  return 0.01 + 2 * std::sqrt(std::max(0.0, p * (1 - p)) / double(answers.total));
}

void Calibration::add(double probability, bool right) {
  const auto bin = static_cast<size_t>(std::clamp(probability * 10, 0.0, 9.0));
  bins[bin].stated += probability;
  bins[bin].answers.add(right);
}

void Calibration::operator+=(const Calibration& other) {
  for (size_t i = 0; i < bins.size(); ++i) {
    bins[i].stated += other.bins[i].stated;
    bins[i].answers += other.bins[i].answers;
  }
}

double ErrorSum::deviation() const {
  return count == 0 ? 0 : std::sqrt(std::max(0.0, squares / double(count) - mean() * mean()));
}

void Score::operator+=(const Score& other) {
  all += other.all;
  of_new += other.of_new;
  of_old += other.of_old;
  whole_scenes += other.whole_scenes;
  for (const auto& [objects, success] : other.by_objects) by_objects[objects] += success;
  for (const auto& [actions, success] : other.by_actions) by_actions[actions] += success;
  for (size_t i = 0; i < 5; ++i)
    for (size_t j = 0; j < 5; ++j) old_confusion[i][j] += other.old_confusion[i][j];
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = 0; j < 4; ++j) new_confusion[i][j] += other.new_confusion[i][j];
  association += other.association;
  explanation += other.explanation;
  same_position += other.same_position;
  same_color += other.same_color;
  other_position += other.other_position;
  other_color += other.other_color;
}

SceneTruth truth_of(const SimulatedScene& scene, const std::vector<Believed>& believed) {
  SceneTruth truth;
  truth.partner_of_old.resize(believed.size());
  truth.partner_of_seen.resize(scene.seen.size());
  for (const Believed& old : believed) {
    const bool in_view = scene.view.contains(old.origin.table, old.origin.position.x());
    truth.old.push_back(in_view ? memory::Explanation::disappear : memory::Explanation::hidden);
  }
  truth.seen.assign(scene.seen.size(), memory::Explanation::appear);
  for (size_t k = 0; k < scene.seen.size(); ++k) {
    const Origin& now = scene.seen[k].origin;
    std::optional<size_t> newest;
    for (size_t o = 0; o < believed.size(); ++o)
      if (believed[o].origin.object == now.object &&
          (!newest || believed[o].entry.step >= believed[*newest].entry.step))
        newest = o;
    if (!newest) continue;
    const Origin& before = believed[*newest].origin;
    const bool moved = before.placements != now.placements, changed = before.appearances != now.appearances;
    if (moved && changed) continue;  // nothing in the evidence can link them
    truth.partner_of_seen[k] = newest;
    truth.partner_of_old[*newest] = k;
    truth.seen[k] = truth.old[*newest] = moved     ? memory::Explanation::move
                                         : changed ? memory::Explanation::newview
                                                   : memory::Explanation::stay;
  }
  return truth;
}

void count_scene(const SimulatedScene& scene, int actions, const std::vector<Believed>& believed,
                 const SceneTruth& truth, const Judgement& judgement, Score& score) {
  count_evidence(scene, believed, score);
  Success of_new, of_old;
  const SideResult seen = count_side(judgement.seen, truth.partner_of_seen, truth.seen, of_new, score);
  const SideResult old = count_side(judgement.old, truth.partner_of_old, truth.old, of_old, score);
  score.of_new += of_new;
  score.of_old += of_old;
  Success both = of_new;
  both += of_old;
  score.all += both;
  score.whole_scenes.association.add(seen.association && old.association);
  score.whole_scenes.explanation.add(seen.explanation && old.explanation);
  const auto links = std::count_if(truth.partner_of_seen.begin(), truth.partner_of_seen.end(),
                                   [](const auto& partner) { return partner.has_value(); });
  const int objects = static_cast<int>(believed.size() + scene.seen.size()) - static_cast<int>(links);
  if (objects > 0) score.by_objects[objects] += both;
  score.by_actions[actions] += both;
  for (size_t k = 0; k < scene.seen.size(); ++k)
    ++score.new_confusion[new_column(truth.seen[k])][new_column(judgement.seen[k].explanation)];
  for (size_t o = 0; o < believed.size(); ++o)
    ++score.old_confusion[old_column(truth.old[o])][old_column(judgement.old[o].explanation)];
}

}  // namespace loci::apps::identity_experiment
