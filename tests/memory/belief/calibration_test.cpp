#include "memory/belief/evidence/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/math/random.h"

namespace loci::memory::belief {
namespace {

constexpr size_t kHistogram = 0, kExtents = 2;

double learned(const Calibration& calibration, size_t kind, double distance, bool colorless = false) {
  return prior_log_ratio(comparisons()[kind], distance, colorless) +
         calibration.corrections().of[kind][colorless].at(distance);
}

TEST(Calibration, SaysWhatTheTablesSayUntilThereIsEvidence) {
  Calibration calibration;
  calibration.of(kExtents, false);
  for (size_t kind = 0; kind < kComparisons; ++kind)
    for (const double distance : {0.0, 0.01, 0.1, 0.3, 0.77, 1.0, 5.0})
      EXPECT_NEAR(learned(calibration, kind, distance), log_ratio(comparisons()[kind], distance), 1e-9);
}

TEST(Calibration, FindsTheRatioOfTheTrueDensities) {
  Calibration calibration;
  Random random(3);
  const double same = 0.04, different = 0.4;  // rates of two exponential distributions
  for (int i = 0; i < 20000; ++i)
    for (const bool one : {true, false})
      calibration.of(kExtents, false)
          .count(one, -std::log(1 - random.uniform()) * (one ? same : different), 0.5);
  for (const double distance : {0.03, 0.09, 0.13, 0.19}) {
    const double truth = std::log(different / same) - distance / same + distance / different;
    EXPECT_NEAR(learned(calibration, kExtents, distance), truth, 0.35) << distance;
  }
}

TEST(Calibration, LittleEvidenceChangesLittle) {
  Calibration calibration;
  for (int i = 0; i < 3; ++i) calibration.of(kHistogram, false).count(true, 0.0, 0.5);
  for (const double distance : {0.0, 0.1, 0.5})
    EXPECT_NEAR(learned(calibration, kHistogram, distance), log_ratio(comparisons()[kHistogram], distance),
                0.3);
}

TEST(Calibration, NoiseOfColoursIsLearned) {
  const std::vector<Descriptor> red = {{"mean_color", {0.8F, 0.3F, 0.4F}}},
                                similar = {{"mean_color", {0.75F, 0.35F, 0.45F}}};
  const auto ratio = [&](const Calibration& calibration) {
    return compare(Appearance(red), Appearance(similar), {}, 1, calibration.corrections()).log_ratio;
  };
  Calibration exact, noisy;
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    exact.count_color(0.01 * std::abs(random.normal(1)), 1);
    noisy.count_color(0.1 * std::abs(random.normal(1)), 1);
  }
  EXPECT_LT(ratio(exact), 0) << "five times the noise is another colour";
  EXPECT_GT(ratio(noisy), 2);
}

TEST(Calibration, FewDistancesTellTheScale) {
  Calibration calibration;
  for (int i = 0; i < 10; ++i) calibration.of(kExtents, false).count(true, 0.2 + 0.01 * i, 1);
  // By the histogram alone, nothing among as many distances as the prior is worth would halve the likelihood.
  EXPECT_GT(learned(calibration, kExtents, 0.35), log_ratio(comparisons()[kExtents], 0.35) - 0.3);
}

TEST(Calibration, ThingsWithoutColourAreApart) {
  Calibration calibration;
  for (int i = 0; i < 500; ++i) calibration.of(kHistogram, true).count(false, 0.01, 1);
  EXPECT_LT(learned(calibration, kHistogram, 0.01, true), 0) << "grey things are all alike";
  EXPECT_DOUBLE_EQ(learned(calibration, kHistogram, 0.01, false), log_ratio(comparisons()[kHistogram], 0.01));
}

TEST(Calibration, NewEvidenceOverrulesOld) {
  Calibration calibration;
  for (int i = 0; i < 60000; ++i) {
    calibration.of(kExtents, false).count(true, i < 30000 ? 0.0 : 0.5, 1);
    calibration.of(kExtents, false).fade();
  }
  EXPECT_GT(learned(calibration, kExtents, 0.47), learned(calibration, kExtents, 0.0));
}

}  // namespace
}  // namespace loci::memory::belief
