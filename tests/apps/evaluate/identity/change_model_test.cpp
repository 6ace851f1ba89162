#include "apps/evaluate/identity/change_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "mapping/base/random.h"

namespace loci::apps::identity_experiment {
namespace {

double away(const LocationBelief& object) {
  return std::accumulate(object.elsewhere.begin(), object.elsewhere.end(), 0.0);
}

TEST(LocationBelief, KeepsMassOverTime) {
  ChangeRates rates;
  LocationBelief object;
  UndetectedIntensity undetected(10);
  for (int i = 0; i < 20; ++i) predict(object, interactions(rates, 0.3), 10, undetected);
  EXPECT_NEAR(away(object), object.moved + object.returned, 1e-12);
  // An object that moved and changed is unrecognisable: an undetected object, or taken away.
  EXPECT_LT(object.present() + object.gone, 1.0);
  EXPECT_GT(undetected.sum(), 0.0);
  EXPECT_LE(object.present() + object.gone + undetected.sum(), 1.0 + 1e-12);
}

TEST(LocationBelief, IsEmptyWhereNothingWasObserved) {
  LocationBelief object;
  UndetectedIntensity undetected(4);
  predict(object, interactions(ChangeRates{}, 0.5), 4, undetected);
  const double gone = object.gone, before = object.elsewhere[2];
  const double probability = observe_absence(object, 0.0, {1, 1, 0, 0});
  EXPECT_EQ(object.elsewhere[0], 0.0);
  EXPECT_GT(object.elsewhere[2], before);  // the rest becomes likelier
  EXPECT_NEAR(object.gone, gone / probability, 1e-12);
  EXPECT_NEAR(away(object), object.moved + object.returned, 1e-12);
  observe_absence(object, 1.0, {0, 0, 0, 0});
  EXPECT_EQ(object.here, 0.0);
}

TEST(Interactions, NeverHandlesMoreThanEverything) {
  ChangeRates rates;
  const Interactions much = interactions(rates, 1e6);
  EXPECT_GT(much.untouched(), 0.0);
  EXPECT_NEAR(much.removed, much.moved, 1e-12);
  const Interactions none = interactions(rates, 0);
  EXPECT_EQ(none.untouched(), 1.0);
}

TEST(NoiseEstimate, FindsTheDeviationOfRepeatedMeasurements) {
  Random random(6);
  NoiseEstimate estimate(0.1);
  for (int i = 0; i < 3000; ++i) estimate.count(random.normal(0.03) - random.normal(0.03), 1, 1);
  EXPECT_NEAR(std::sqrt(estimate.variance()), 0.03, 0.003);
  EXPECT_NEAR(NoiseEstimate::known(0.2).variance(), 0.04, 1e-12);
}

TEST(RateLearner, ComesToExpectWhatIsFound) {
  Random random(7);
  RateLearner learner;
  for (int i = 0; i < 4000; ++i) {
    const double rate = learner.rates()[Change::moved];
    for (int object = 0; object < 5; ++object)
      learner.count(Change::moved, random.uniform() < 0.03 ? 1 : 0, std::min(0.9, rate * 0.2));
    learner.finish_scene();
  }
  EXPECT_NEAR(learner.rates()[Change::moved] * 0.2, 0.03, 0.004);
}

TEST(RateLearner, LearnsNothingFromScenesWithoutInformation) {
  RateLearner learner, fresh;
  for (int i = 0; i < 1000; ++i) {
    learner.count(Change::moved, 0.1, 0.1);
    learner.finish_scene();
  }
  // It is not more certain: the same event has the same effect.
  for (RateLearner* each : {&learner, &fresh}) {
    each->count(Change::moved, 1, 0.1);
    each->finish_scene();
  }
  EXPECT_NEAR(learner.rates()[Change::moved], fresh.rates()[Change::moved], 1e-9);
}

TEST(ActivityLevel, IsTheLevelThatPredictsBest) {
  ActivityLevel activity;
  std::vector<double> evidence(activity.levels(), -1.0);
  evidence.back() = 0;
  for (int i = 0; i < 10; ++i) activity.observe(evidence);
  EXPECT_GT(activity.weight(activity.levels() - 1), 0.99);
  activity.begin_world();
  EXPECT_LT(activity.weight(activity.levels() - 1), 0.5);
  EXPECT_GT(activity.weight(activity.levels() - 1), activity.weight(0));
}

}  // namespace
}  // namespace loci::apps::identity_experiment
