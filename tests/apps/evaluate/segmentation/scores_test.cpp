#include <gtest/gtest.h>

#include "apps/evaluate/segmentation/comparison.h"

namespace loci::apps::segmentation_evaluation {
namespace {

/// One row of pixels: objects, segments, and whether anybody knows.
Scores scores_of(const std::vector<int>& objects, const std::vector<int>& segments,
                 const std::vector<int>& judged = {}) {
  const auto width = static_cast<int>(objects.size());
  LabelledImage truth{cv::Mat(1, width, CV_16U), cv::Mat(1, width, CV_8U, cv::Scalar(255))};
  cv::Mat found(1, width, CV_16U);
  for (int i = 0; i < width; ++i) {
    truth.object.at<uint16_t>(0, i) = static_cast<uint16_t>(objects.at(static_cast<size_t>(i)));
    found.at<uint16_t>(0, i) = static_cast<uint16_t>(segments.at(static_cast<size_t>(i)));
    if (!judged.empty())
      truth.judged.at<unsigned char>(0, i) = static_cast<unsigned char>(judged.at(static_cast<size_t>(i)));
  }
  Scores scores;
  scores.add(truth, found);
  return scores;
}

TEST(SegmentationScores, AreFullForTheTruthUnderOtherNumbers) {
  const Scores scores = scores_of({0, 1, 1, 2, 2, 2}, {0, 7, 7, 3, 3, 3});
  EXPECT_EQ(scores.weighted_overlap(), 1);
  EXPECT_EQ(scores.over_segmentation(), 0);
  EXPECT_EQ(scores.under_segmentation(), 0);
  EXPECT_EQ(scores.f1(), 1);
}

TEST(SegmentationScores, TellPiecesFromWhatIsRunTogether) {
  const Scores pieces = scores_of({1, 1, 1, 1, 0, 0}, {1, 1, 2, 2, 0, 0});
  EXPECT_DOUBLE_EQ(pieces.weighted_overlap(), 0.5);
  EXPECT_DOUBLE_EQ(pieces.over_segmentation(), 0.5);
  EXPECT_DOUBLE_EQ(pieces.under_segmentation(), 0);
  EXPECT_EQ(pieces.f1(), 0);
  const Scores together = scores_of({1, 1, 2, 2, 0, 0}, {1, 1, 1, 1, 0, 0});
  EXPECT_DOUBLE_EQ(together.weighted_overlap(), 0.5);
  EXPECT_DOUBLE_EQ(together.over_segmentation(), 0);
  EXPECT_DOUBLE_EQ(together.under_segmentation(), 1);
}

TEST(SegmentationScores, WeighObjectsByTheirPixelsAndCountEachOnceInF1) {
  // The large object is found, the small one missed, and one segment is nothing.
  const Scores scores = scores_of({1, 1, 1, 2, 0, 0}, {1, 1, 1, 0, 2, 2});
  EXPECT_DOUBLE_EQ(scores.weighted_overlap(), 0.75);
  EXPECT_DOUBLE_EQ(scores.precision(), 0.5);
  EXPECT_DOUBLE_EQ(scores.recall(), 0.5);
}

TEST(SegmentationScores, SaysWhatSegmentsAreThatFindNoObject) {
  // A half and a quarter of the first object, the table, and two objects as one.
  const Scores::Wrong wrong =
      scores_of({1, 1, 1, 1, 0, 0, 2, 2, 3, 3}, {1, 1, 2, 0, 3, 3, 4, 4, 4, 4}).wrong_segments();
  EXPECT_EQ(wrong.inexact, 1);
  EXPECT_EQ(wrong.pieces, 1);
  EXPECT_EQ(wrong.table, 1);
  EXPECT_EQ(wrong.joined, 1);
  EXPECT_EQ(scores_of({1, 1, 1, 1, 0}, {1, 1, 1, 1, 1}).wrong_segments().table, 0) << "it finds its object";
}

TEST(SegmentationScores, LeaveOutWhatNobodyKnows) {
  const Scores scores = scores_of({1, 1, 0, 0}, {1, 1, 1, 2}, {1, 1, 0, 0});
  EXPECT_EQ(scores.weighted_overlap(), 1);
  EXPECT_EQ(scores.segments(), 1);
}

TEST(SegmentationComparison, FindsStackedAndTouchingThingsAheadOfItsPeers) {
  NoProgress progress;
  Warnings warnings;
  const Comparison comparison =
      compare(open_labelled_scenes(std::filesystem::path(LOCI_SOURCE_DIR) / "tests/data/blocks"), {}, {}, {},
              progress, warnings);
  ASSERT_EQ(comparison.frames.size(), 2U);
  ASSERT_EQ(comparison.methods.size(), 4U);
  const Scores& ours = comparison.methods[0].scores;
  EXPECT_EQ(ours.objects(), 6);
  EXPECT_EQ(ours.f1(), 1);
  for (size_t i = 1; i < comparison.methods.size(); ++i) {
    EXPECT_GT(ours.weighted_overlap(), comparison.methods[i].scores.weighted_overlap());
    EXPECT_GT(comparison.methods[i].scores.weighted_overlap(), 0.3) << comparison.methods[i].name;
  }
}

}  // namespace
TEST(SegmentationComparison, DrawsTheSameTablesFromASeed) {
  NoProgress progress;
  Warnings warnings;
  ComparisonOptions options;
  options.peers = false;
  const auto judge = [&](int seed) {
    return compare(drawn_tables(mapping::Arrangement::stacked, 2, seed), {}, {}, options, progress, warnings);
  };
  const Comparison first = judge(1), again = judge(1), other = judge(2);
  ASSERT_EQ(first.frames.size(), 2U);
  ASSERT_EQ(first.methods.size(), 1U);
  const Scores& scores = first.methods[0].scores;
  EXPECT_GT(scores.objects(), 4);
  EXPECT_GT(scores.weighted_overlap(), 0.3);
  EXPECT_EQ(scores.weighted_overlap(), again.methods[0].scores.weighted_overlap());
  EXPECT_NE(scores.weighted_overlap(), other.methods[0].scores.weighted_overlap());
}

}  // namespace loci::apps::segmentation_evaluation
