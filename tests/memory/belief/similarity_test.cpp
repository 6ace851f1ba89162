#include "memory/belief/evidence/similarity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace loci::memory::belief {
namespace {

TEST(Similarity, IsOneAtDistanceZeroAndFalls) {
  EXPECT_DOUBLE_EQ(gaussian_similarity(0), 1);
  EXPECT_NEAR(gaussian_similarity(0.25), std::exp(-1.0), 1e-12);
}

TEST(Similarity, DistancesAreZeroForEqualsSymmetricAndLargestForStrangers) {
  const std::vector<float> a = {4, 1, 0, 0}, b = {0, 0, 2, 2}, c = {1, 1, 1, 1};
  EXPECT_NEAR(histogram_distance(a, a), 0, 1e-7);
  EXPECT_DOUBLE_EQ(histogram_distance(a, b), 1);
  EXPECT_DOUBLE_EQ(histogram_distance(a, c), histogram_distance(c, a));
  EXPECT_NEAR(histogram_distance(a, {8, 2, 0, 0}), 0, 1e-7) << "the number of pixels does not matter";
  EXPECT_DOUBLE_EQ(extent_distance({0.1F, 0.2F, 0.3F}, {0.3F, 0.1F, 0.2F}), 0)
      << "a turned box has the same extents";
}

TEST(Similarity, EveryComparisonFallsFromEvidenceForToEvidenceAgainst) {
  for (const Comparison& comparison : comparisons()) {
    if (comparison.table.empty()) continue;
    EXPECT_GT(comparison.table.front().log_ratio, 0) << comparison.kind;
    EXPECT_LT(comparison.table.back().log_ratio, 0) << comparison.kind;
    for (size_t i = 1; i < comparison.table.size(); ++i) {
      EXPECT_GT(comparison.table[i].distance, comparison.table[i - 1].distance);
      EXPECT_LT(comparison.table[i].log_ratio, comparison.table[i - 1].log_ratio);
    }
    EXPECT_DOUBLE_EQ(log_ratio(comparison, -1), comparison.table.front().log_ratio);
    EXPECT_DOUBLE_EQ(log_ratio(comparison, 99), comparison.table.back().log_ratio);
  }
}

TEST(Similarity, MissingEvidenceIsMissing) {
  const ViewSimilarity none = compare({{"mean_color", {1, 0, 0}}}, {{"extents", {1, 1, 1}}}, {}, 1);
  EXPECT_EQ(none.count, 0U);
  EXPECT_DOUBLE_EQ(none.log_ratio, 0);
  EXPECT_FALSE(none.similarity());
  const ViewSimilarity unknown = compare({{"smell", {1}}}, {{"smell", {1}}}, {}, 1);
  EXPECT_EQ(unknown.count, 0U);
}

TEST(Similarity, WhatACutOffViewLacksInSizeCountsLess) {
  const std::vector<Descriptor> whole = {{"extents", {0.1F, 0.1F, 0.1F}}},
                                part = {{"extents", {0.1F, 0.02F, 0.1F}}};
  const double both_whole = compare(whole, part, {}, 1).log_ratio;
  EXPECT_LT(both_whole, 0);
  EXPECT_GT(compare(whole, part, {false, true}, 1).log_ratio, both_whole);
  EXPECT_DOUBLE_EQ(compare(whole, part, {true, false}, 1).log_ratio, both_whole)
      << "of the larger one nothing lacks";
}

TEST(Similarity, OtherExtentsOfACutOffViewHardlySpeakAgainst) {
  const std::vector<Descriptor> small = {{"extents", {0.1F, 0.1F, 0.1F}}},
                                large = {{"extents", {0.4F, 0.3F, 0.3F}}};
  Corrections apart;
  apart.misleading_partial = kParameters.misleading_partial;
  const auto of_appearance = [&](PartialViews partial) {
    return compare(Appearance(small), Appearance(large), partial, 1, apart).log_ratio;
  };
  EXPECT_LT(of_appearance({}), -3);
  EXPECT_GT(of_appearance({false, true}), -1.5);
  EXPECT_LT(of_appearance({false, true}), -0.5);
}

TEST(Similarity, WhatAViewHidesItselfIsNoDifference) {
  const std::vector<Descriptor> box = {{"extents", {0.20F, 0.07F, 0.28F, 1, 1, 1}}},
                                front = {{"extents", {0.20F, 0.01F, 0.28F, 1, 0, 1}}},
                                sheet = {{"extents", {0.20F, 0.01F, 0.28F, 1, 1, 1}}},
                                other_front = {{"extents", {0.10F, 0.01F, 0.28F, 1, 0, 1}}};
  EXPECT_GT(compare(box, front, {}, 1).log_ratio, 1);
  EXPECT_DOUBLE_EQ(compare(box, front, {}, 1).log_ratio, compare(front, box, {}, 1).log_ratio);
  EXPECT_LT(compare(box, front, {}, 1).log_ratio, compare(box, box, {}, 1).log_ratio) << "it says less";
  EXPECT_LT(compare(box, sheet, {}, 1).log_ratio, -1);
  EXPECT_LT(compare(box, other_front, {}, 1).log_ratio, 0);
  // The hidden extent of one may be any of the other: 0.07 m wide and 0.20 m deep.
  EXPECT_GT(compare(box, {{"extents", {0.07F, 0.01F, 0.28F, 1, 0, 1}}}, {}, 1).log_ratio, 1);
  EXPECT_GT(compare(box, {{"extents", {0.20F, 0.07F, 0.28F}}}, {}, 1).log_ratio, 1) << "without bounds";
}

TEST(Similarity, TheMeanColorIsNoSecondEvidenceBesideTheHistogram) {
  const Descriptor red{"mean_color", {1, 0, 0}}, blue{"mean_color", {0, 0, 1}};
  const Descriptor histogram{"color_histogram", {1, 2, 3}};
  EXPECT_LT(compare({red}, {blue}, {}, 1).log_ratio, 0);
  EXPECT_DOUBLE_EQ(compare({histogram, red}, {histogram, blue}, {}, 1).log_ratio,
                   compare({histogram}, {histogram}, {}, 1).log_ratio);
}

TEST(Similarity, BaselineIsTheGeometricMeanOfSimilarity) {
  const std::vector<Descriptor> a = {{"mean_color", {0, 0, 0}}, {"extents", {0.1F, 0.1F, 0.1F}}};
  const std::vector<Descriptor> b = {{"mean_color", {0.1F, 0.1F, 0.1F}}, {"extents", {0.1F, 0.1F, 0.1F}}};
  EXPECT_NEAR(*compare(a, b, {}, 1).similarity(), std::sqrt(gaussian_similarity(0.1) * 1.0), 1e-6);
}

TEST(Similarity, WhatIsNoNumberIsNoMatch) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<float> good = {1, 2, 3};
  for (const std::vector<float>& bad : {std::vector<float>{1, nan, 3}, {inf, 2, 3}, {nan, nan, nan}})
    for (const Comparison& comparison : comparisons()) {
      const auto of = [&](const std::vector<float>& values) {
        return std::vector<Descriptor>{{comparison.kind, values, {}}};
      };
      EXPECT_EQ(compare(of(good), of(bad), {}, 1).count, 0U) << comparison.kind;
      EXPECT_EQ(compare(of(bad), of(bad), {}, 1).count, 0U) << comparison.kind;
    }
}

}  // namespace
}  // namespace loci::memory::belief
