#include "apps/evaluate/identity/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "mapping/base/parallel.h"

namespace loci::apps::identity_experiment {
namespace {

std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');)
    if (!part.empty()) parts.push_back(part);
  return parts;
}

double level_from(const std::string& text) {
  size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used != text.size() || !(value > 0) || value > 1)
    throw Error("levels: '" + text + "' is not a standard deviation in (0,1]", {},
                "give numbers with commas between them, e.g. 0.025,0.05");
  return value;
}

Condition condition_from(const std::string& text) {
  for (const Condition condition : kConditions)
    if (text == condition_name(condition)) return condition;
  throw Error("conditions: there is no '" + text + "'", {}, "there are A, B and C");
}

class Run {
 public:
  Run(Model& model, Condition condition, const Sequence& sequence, Score& score)
      : model_(model), condition_(condition), sequence_(sequence), score_(score) {}

  void run() {
    model_.begin(sequence_);
    for (size_t i = 0; i < sequence_.scenes.size(); ++i) step(sequence_.scenes[i], static_cast<int>(i));
  }

 private:
  void step(const SimulatedScene& scene, int number) {
    if (condition_ == Condition::fresh) {
      believed_.clear();
      for (const SimulatedObservation& observation : scene.before)
        believed_.push_back({{observation.seen, number - 1}, observation.origin});
    }
    std::vector<Entry> old;
    for (const Believed& believed : believed_) old.push_back(believed.entry);
    std::vector<Measurement> seen;
    for (const SimulatedObservation& observation : scene.seen) seen.push_back(observation.seen);
    const Judgement judgement = model_.judge(scene.view, number, old, seen);
    const SceneTruth truth = truth_of(scene, believed_);
    count_scene(scene, sequence_.actions, believed_, truth, judgement, score_);
    if (condition_ == Condition::own) go_on(scene, number, judgement.links, judgement.kept);
    if (condition_ == Condition::truth) go_on_with_truth(scene, number, truth);
  }

  /// The belief for the next scene: kept objects and all measurements.
  void go_on(const SimulatedScene& scene, int number, const std::vector<Link>& links,
             const std::vector<bool>& kept) {
    std::vector<bool> linked(believed_.size(), false);
    for (const Link& link : links) linked[link.old] = true;
    std::vector<Believed> next;
    for (size_t o = 0; o < believed_.size(); ++o)
      if (kept[o] && !linked[o]) next.push_back(believed_[o]);
    for (const SimulatedObservation& observation : scene.seen)
      next.push_back({{observation.seen, number}, observation.origin});
    believed_ = std::move(next);
  }

  void go_on_with_truth(const SimulatedScene& scene, int number, const SceneTruth& truth) {
    std::vector<Link> links;
    for (size_t k = 0; k < scene.seen.size(); ++k)
      if (truth.partner_of_seen[k]) links.push_back({*truth.partner_of_seen[k], k});
    std::vector<bool> kept;
    for (size_t o = 0; o < believed_.size(); ++o) {
      const bool seen =
          std::any_of(scene.seen.begin(), scene.seen.end(), [&](const SimulatedObservation& observation) {
            return observation.origin.object == believed_[o].origin.object;
          });
      kept.push_back(!seen && truth.old[o] == memory::Explanation::hidden);
    }
    go_on(scene, number, links, kept);
  }

  Model& model_;
  Condition condition_;
  const Sequence& sequence_;
  Score& score_;
  std::vector<Believed> believed_;
};

}  // namespace

const char* condition_name(Condition condition) {
  return condition == Condition::own ? "A" : condition == Condition::truth ? "B" : "C";
}

void ExperimentOptions::declare(OptionTable& table) {
  table.integer("seed", seed, "", "Seed of the random numbers.", 0, 1000000000);
  table.integer("runs", runs, "", "Runs of all sequences (800 scenes each) per noise level.", 1, 10000);
  table.text("levels", levels, "Standard deviations of the measurements.");
  table.text("conditions", conditions, "Beliefs to compare with: A own, B true, C true and fresh.");
  table.text("models", models, "Models to run; empty = all.");
}

std::string ExperimentResult::key(Condition condition, const std::string& model, size_t level) {
  return fmt::format("{} {} {}", condition_name(condition), model, level);
}

Score run_model(Model& model, Condition condition, const std::vector<Sequence>& sequences) {
  Score score;
  for (const Sequence& sequence : sequences) Run(model, condition, sequence, score).run();
  return score;
}

ExperimentResult run_experiment(const WorldOptions& world, const ExperimentOptions& options, int threads,
                                Progress& progress) {
  ExperimentResult result;
  for (const std::string& level : split_list(options.levels)) result.levels.push_back(level_from(level));
  for (const std::string& name : split_list(options.conditions))
    result.conditions.push_back(condition_from(name));
  result.models = options.models.empty() ? model_names() : split_list(options.models);
  const Random random(static_cast<uint64_t>(options.seed));
  const auto runs = static_cast<size_t>(options.runs);
  for (size_t level = 0; level < result.levels.size(); ++level) {
    progress.check(double(level) / double(result.levels.size()),
                   fmt::format("noise {}", result.levels[level]));
    std::vector<std::vector<Score>> scores(runs);
    std::vector<std::array<int64_t, kActions>> actions(runs);
    std::vector<int64_t> scenes(runs, 0);
    parallel_for(runs, threads, [&](size_t begin, size_t end) {
      for (size_t run = begin; run < end; ++run) {
        const std::vector<Sequence> sequences =
            simulate_level(world, result.levels[level], random.fork(run).fork(level));
        for (const Sequence& sequence : sequences)
          for (const SimulatedScene& scene : sequence.scenes) {
            ++scenes[run];
            for (size_t i = 0; i < kActions; ++i) actions[run][i] += scene.actions[i];
          }
        for (const Condition condition : result.conditions)
          for (const std::string& name : result.models) {
            const std::unique_ptr<Model> model = make_model(name);
            const bool judges = condition == Condition::own || !model->own_belief_only();
            scores[run].push_back(judges ? run_model(*model, condition, sequences) : Score());
          }
      }
    });
    auto& sum = result.actions.emplace_back();
    for (const auto& counts : actions)
      for (size_t i = 0; i < kActions; ++i) sum[i] += counts[i];
    result.scenes = 0;
    for (const int64_t count : scenes) result.scenes += count;
    size_t index = 0;
    for (const Condition condition : result.conditions)
      for (const std::string& name : result.models) {
        Cell& cell = result.cells[ExperimentResult::key(condition, name, level)];
        for (size_t run = 0; run < runs; ++run) {
          cell.score += scores[run][index];
          cell.runs.push_back(scores[run][index].all);
        }
        ++index;
      }
  }
  return result;
}

}  // namespace loci::apps::identity_experiment
