#include "apps/evaluate/identity/experiment.h"

#include <gtest/gtest.h>

#include "apps/evaluate/identity/tables.h"
#include "mapping/base/json.h"

namespace loci::test {
namespace {

using namespace identity_experiment;

ExperimentResult experiment(const std::string& models, int threads = 0, const WorldOptions& world = {},
                            int runs = 3) {
  ExperimentOptions options;
  options.runs = runs;
  options.models = models;
  options.levels = "0.05,0.1";
  NoProgress progress;
  return run_experiment(world, options, threads, progress);
}

TEST(IdentityExperiment, HasTheDissertationsNumbersOfScenesAndActions) {
  const Random random(3);
  std::array<double, kActions> actions{};
  size_t scenes = 0;
  for (uint64_t run = 0; run < 5; ++run)
    for (const Sequence& sequence : simulate_level(WorldOptions{}, 0.05, random.fork(run)))
      for (const SimulatedScene& scene : sequence.scenes) {
        ++scenes;
        for (size_t i = 0; i < kActions; ++i) actions[i] += scene.actions[i];
      }
  EXPECT_EQ(scenes, 5 * 800U);
  // Of 3200 scenes, as the specification measured them.
  const double scale = 3200.0 / double(scenes);
  EXPECT_NEAR(actions[0] * scale, 3345, 100);
  EXPECT_NEAR(actions[1] * scale, 3013, 100);
  EXPECT_NEAR(actions[2] * scale, 1753, 100);
  EXPECT_NEAR(actions[3] * scale, 1402, 100);
}

TEST(IdentityExperiment, HasAtMostAsManyObjectsAsItsLimit) {
  for (const SimulatedScene& scene : simulate(WorldOptions{}, 4, 5, 0.05, Random(9)).scenes)
    EXPECT_LE(scene.present, 4);
}

TEST(IdentityExperiment, GivesTheSameOnAnyNumberOfThreads) {
  EXPECT_EQ(json_of(experiment("ours,paper", 1)).dump(), json_of(experiment("ours,paper", 3)).dump());
}

TEST(IdentityExperiment, ReproducesThePapersModel) {
  const ExperimentResult result = experiment("paper", 0, {}, 10);
  const Success& own = result.cell(Condition::own, "paper", 0).score.all;
  EXPECT_NEAR(100 * own.association.fraction(), 96.4, 1.0);
  EXPECT_NEAR(100 * own.explanation.fraction(), 95.0, 1.0);
  const Success& fresh = result.cell(Condition::fresh, "paper", 1).score.all;
  EXPECT_NEAR(100 * fresh.association.fraction(), 91.9, 1.0);
  EXPECT_NEAR(100 * fresh.explanation.fraction(), 82.9, 1.0);
}

TEST(IdentityExperiment, LearnedRatesAreNearlyAsGoodAsToldOnesInOtherWorlds) {
  WorldOptions still;
  still.newview = 0;
  WorldOptions restless;
  restless.move = 2;
  WorldOptions crowded;
  crowded.tables = 2;
  crowded.view_m = 0.6;
  for (const WorldOptions& world : {still, restless, crowded}) {
    const ExperimentResult result = experiment("ours,told,paper", 0, world, 4);
    for (size_t level = 0; level < 2; ++level) {
      const Success& ours = result.cell(Condition::own, "ours", level).score.all;
      const Success& told = result.cell(Condition::own, "told", level).score.all;
      const Success& paper = result.cell(Condition::own, "paper", level).score.all;
      EXPECT_GT(ours.explanation.fraction(), told.explanation.fraction() - 0.015);
      EXPECT_GT(ours.explanation.fraction(), paper.explanation.fraction());
    }
  }
}

TEST(IdentityExperiment, LinksToTheNewestEntryAndNotWhatMovedAndChanged) {
  Origin first;
  first.object = 7;
  first.position = {0.5, 0.5};
  Origin moved = first, both = first;
  moved.placings = 1;
  both.placings = 1;
  both.looks = 1;
  SimulatedScene scene;
  scene.seen = {{Measurement{}, both}};
  const auto believed = [&](const Origin& origin, int step) {
    return Believed{Entry::first(Measurement{}, step), origin};
  };
  SceneTruth truth = truth_of(scene, {believed(first, 1)});
  EXPECT_EQ(truth.seen[0], Explanation::appear);
  EXPECT_EQ(truth.old[0], Explanation::disappear);
  truth = truth_of(scene, {believed(moved, 3), believed(first, 1)});
  EXPECT_EQ(truth.partner_of_seen[0], 0U);
  EXPECT_EQ(truth.seen[0], Explanation::newview);
  EXPECT_EQ(truth.old[1], Explanation::disappear);
}

TEST(IdentityExperiment, RefusesLevelsAndConditionsThatDoNotExist) {
  NoProgress progress;
  ExperimentOptions options;
  options.runs = 1;
  WorldOptions world;
  world.min_objects = 11;
  EXPECT_THROW(run_experiment(world, options, 1, progress), Error);
  options.levels = "0.05,x";
  EXPECT_THROW(run_experiment({}, options, 1, progress), Error);
  options.levels = "0.05";
  options.conditions = "D";
  EXPECT_THROW(run_experiment({}, options, 1, progress), Error);
  options.conditions = "A";
  options.models = "magic";
  EXPECT_THROW(run_experiment({}, options, 1, progress), Error);
}

}  // namespace
}  // namespace loci::test
