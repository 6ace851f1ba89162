#include "apps/evaluate/identity/experiment.h"

#include <gtest/gtest.h>

#include "apps/evaluate/identity/report.h"
#include "mapping/base/text/json.h"

namespace loci::apps::test {
namespace {

using namespace identity_experiment;

identity_experiment::ExperimentResult experiment(const std::string& models, int threads = 0,
                                                 const identity_experiment::WorldOptions& world = {},
                                                 int runs = 3) {
  identity_experiment::ExperimentOptions options;
  options.runs = runs;
  options.models = models;
  options.levels = "0.05,0.1";
  NoProgress progress;
  return run_experiment(world, options, threads, progress);
}

TEST(IdentityExperiment, HasTheDissertationsNumbersOfScenesAndActions) {
  const Random random(3);
  std::array<double, identity_experiment::kActions> actions{};
  size_t scenes = 0;
  for (uint64_t run = 0; run < 5; ++run)
    for (const identity_experiment::Sequence& sequence :
         simulate_level(identity_experiment::WorldOptions{}, 0.05, random.fork(run)))
      for (const identity_experiment::SimulatedScene& scene : sequence.scenes) {
        ++scenes;
        for (size_t i = 0; i < identity_experiment::kActions; ++i) actions[i] += scene.actions[i];
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
  for (const identity_experiment::SimulatedScene& scene :
       simulate(identity_experiment::WorldOptions{}, 4, 5, 0.05, Random(9)).scenes)
    EXPECT_LE(scene.present, 4);
}

TEST(IdentityExperiment, GivesTheSameOnAnyNumberOfThreads) {
  EXPECT_EQ(json_of(experiment("paper,shipped", 1)).dump(), json_of(experiment("paper,shipped", 3)).dump());
}

TEST(IdentityExperiment, ReproducesThePapersModel) {
  const identity_experiment::ExperimentResult result = experiment("paper", 0, {}, 10);
  const identity_experiment::Success& own =
      result.cell(identity_experiment::Condition::own, "paper", 0).score.all;
  EXPECT_NEAR(100 * own.association.fraction(), 96.4, 1.0);
  EXPECT_NEAR(100 * own.explanation.fraction(), 95.0, 1.0);
  const identity_experiment::Success& fresh =
      result.cell(identity_experiment::Condition::fresh, "paper", 1).score.all;
  EXPECT_NEAR(100 * fresh.association.fraction(), 91.9, 1.0);
  EXPECT_NEAR(100 * fresh.explanation.fraction(), 82.9, 1.0);
}

TEST(IdentityExperiment, TheBeliefIsBetterThanThePapersModelInOtherWorlds) {
  identity_experiment::WorldOptions still;
  still.newview = 0;
  identity_experiment::WorldOptions restless;
  restless.move = 2;
  identity_experiment::WorldOptions crowded;
  crowded.tables = 2;
  crowded.view_m = 0.6;
  for (const identity_experiment::WorldOptions& world : {still, restless, crowded}) {
    const identity_experiment::ExperimentResult result = experiment("shipped,paper", 0, world, 4);
    for (size_t level = 0; level < 2; ++level)
      EXPECT_GT(result.cell(Condition::own, "shipped", level).score.all.explanation.fraction(),
                result.cell(Condition::own, "paper", level).score.all.explanation.fraction());
  }
}

TEST(IdentityExperiment, LinksToTheNewestEntryAndNotWhatMovedAndChanged) {
  identity_experiment::Origin first;
  first.object = 7;
  first.position = {0.5, 0.5};
  identity_experiment::Origin moved = first, both = first;
  moved.placements = 1;
  both.placements = 1;
  both.appearances = 1;
  identity_experiment::SimulatedScene scene;
  scene.seen = {{identity_experiment::Measurement{}, both}};
  const auto believed = [&](const identity_experiment::Origin& origin, int step) {
    return identity_experiment::Believed{identity_experiment::Entry{{}, step}, origin};
  };
  identity_experiment::SceneTruth truth = truth_of(scene, {believed(first, 1)});
  EXPECT_EQ(truth.seen[0], memory::Explanation::appear);
  EXPECT_EQ(truth.old[0], memory::Explanation::disappear);
  truth = truth_of(scene, {believed(moved, 3), believed(first, 1)});
  EXPECT_EQ(truth.partner_of_seen[0], 0U);
  EXPECT_EQ(truth.seen[0], memory::Explanation::newview);
  EXPECT_EQ(truth.old[1], memory::Explanation::disappear);
}

TEST(IdentityExperiment, RefusesLevelsAndConditionsThatDoNotExist) {
  NoProgress progress;
  identity_experiment::ExperimentOptions options;
  options.runs = 1;
  identity_experiment::WorldOptions world;
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
}  // namespace loci::apps::test
