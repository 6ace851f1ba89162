#include "memory/belief/whereabouts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "mapping/base/random.h"
#include "memory/belief/likelihood.h"

namespace loci::memory::test {
namespace {

using namespace belief;

double away(const belief::Whereabouts& object) {
  return std::accumulate(object.elsewhere.begin(), object.elsewhere.end(), 0.0);
}

TEST(Whereabouts, KeepMassAsTimeGoesBy) {
  belief::ChangeRates rates;
  belief::Whereabouts object;
  belief::Untracked untracked(10);
  for (int i = 0; i < 20; ++i) predict(object, handling(rates, 0.3), 10, untracked);
  EXPECT_NEAR(away(object), object.moved + object.returned, 1e-12);
  // What is moved and changed can never be recognised: it is among the unknown things or was taken away.
  EXPECT_LT(object.present() + object.gone, 1.0);
  EXPECT_GT(untracked.sum(), 0.0);
  EXPECT_LE(object.present() + object.gone + untracked.sum(), 1.0 + 1e-12);
}

TEST(Whereabouts, AreNotWhereOneLookedInVain) {
  belief::Whereabouts object;
  belief::Untracked untracked(4);
  predict(object, handling(belief::ChangeRates{}, 0.5), 4, untracked);
  const double gone = object.gone, before = object.elsewhere[2];
  const double probability = not_seen(object, 0.0, {1, 1, 0, 0});
  EXPECT_EQ(object.elsewhere[0], 0.0);
  EXPECT_GT(object.elsewhere[2], before);  // the rest becomes likelier
  EXPECT_NEAR(object.gone, gone / probability, 1e-12);
  EXPECT_NEAR(away(object), object.moved + object.returned, 1e-12);
  not_seen(object, 1.0, {0, 0, 0, 0});
  EXPECT_EQ(object.here, 0.0);
}

TEST(Handling, NeverHandlesMoreThanEverything) {
  belief::ChangeRates rates;
  const belief::Handling much = handling(rates, 1e6);
  EXPECT_GT(much.untouched(), 0.0);
  EXPECT_NEAR(much.removed, much.moved, 1e-12);
  const belief::Handling none = handling(rates, 0);
  EXPECT_EQ(none.untouched(), 1.0);
}

TEST(LogSame, IsALikelihoodRatioThatKnowsTheBorders) {
  // Averaged over all that the domain may hold, the ratio of densities is one.
  Random random(5);
  const double sigma = 0.1;
  double sum = 0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double believed = 0.03;
    const double seen = random.uniform() + random.normal(sigma);
    sum += std::exp(log_same({believed, sigma * sigma}, {0, 1}, {seen, sigma * sigma}, {0, 1}));
  }
  EXPECT_NEAR(sum / kDraws, 1.0, 0.02);
}

TEST(NoiseEstimate, FindsTheDeviationOfRepeatedMeasurements) {
  Random random(6);
  belief::NoiseEstimate estimate(0.1);
  for (int i = 0; i < 3000; ++i) estimate.count(random.normal(0.03) - random.normal(0.03), 1, 1);
  EXPECT_NEAR(std::sqrt(estimate.variance()), 0.03, 0.003);
  EXPECT_NEAR(belief::NoiseEstimate::known(0.2).variance(), 0.04, 1e-12);
}

TEST(RateLearner, ComesToExpectWhatIsFound) {
  Random random(7);
  belief::RateLearner learner;
  for (int i = 0; i < 4000; ++i) {
    const double rate = learner.rates()[belief::Change::moved];
    for (int object = 0; object < 5; ++object)
      learner.count(belief::Change::moved, random.uniform() < 0.03 ? 1 : 0, std::min(0.9, rate * 0.2));
    learner.finish_scene();
  }
  EXPECT_NEAR(learner.rates()[belief::Change::moved] * 0.2, 0.03, 0.004);
}

TEST(RateLearner, LearnsNothingFromScenesThatTellNothing) {
  belief::RateLearner learner, fresh;
  for (int i = 0; i < 1000; ++i) {
    learner.count(belief::Change::moved, 0.1, 0.1);
    learner.finish_scene();
  }
  // It has not become surer of itself: the same news moves it as far.
  for (belief::RateLearner* each : {&learner, &fresh}) {
    each->count(belief::Change::moved, 1, 0.1);
    each->finish_scene();
  }
  EXPECT_NEAR(learner.rates()[belief::Change::moved], fresh.rates()[belief::Change::moved], 1e-9);
}

TEST(Busyness, IsTheLevelThatPredictsBest) {
  belief::Busyness busyness;
  std::vector<double> evidence(busyness.levels(), -1.0);
  evidence.back() = 0;
  for (int i = 0; i < 10; ++i) busyness.observe(evidence);
  EXPECT_GT(busyness.weight(busyness.levels() - 1), 0.99);
  busyness.begin_world();
  EXPECT_LT(busyness.weight(busyness.levels() - 1), 0.5);
  EXPECT_GT(busyness.weight(busyness.levels() - 1), busyness.weight(0));
}

}  // namespace
}  // namespace loci::memory::test
