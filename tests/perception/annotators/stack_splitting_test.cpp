#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/base/math/random.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/structure/normals.h"
#include "perception/annotators/structure/supports.h"
#include "tests/perception/annotators/synthetic_table.h"

namespace loci::perception {
namespace {

using test::SyntheticTable;

const cv::Vec3b kLowerColor(60, 160, 70), kUpperColor(50, 60, 190), kTableColor(150, 170, 180);

/// A table whose objects have colours.
struct PaintedTable : SyntheticTable {
  std::vector<cv::Vec3b> colors;  ///< of what is labelled 1, 2, ...
  double seam_m = 0;              ///< above it everything is red; 0 = nowhere

  PaintedTable() { camera = {640, 480, 585, 585, 320, 240}; }

  cv::Mat color(const cv::Mat& labels, const cv::Mat& depth) const {
    Random random(7);
    cv::Mat image(labels.size(), CV_8UC3);
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const int label = labels.at<int>(v, u);
        cv::Vec3b ground = label > 0 ? colors.at(static_cast<size_t>(label) - 1) : kTableColor;
        const Vector3d p =
            map_from_camera * camera.unproject(u, v, static_cast<double>(depth.at<float>(v, u)));
        if (label > 0 && seam_m > 0 && p.z() > seam_m) ground = kUpperColor;
        for (int c = 0; c < 3; ++c)
          image.at<cv::Vec3b>(v, u)[c] = cv::saturate_cast<uchar>(ground[c] + random.normal(3));
      }
    return image;
  }
};

struct StackResult {
  cv::Mat labels;
  std::vector<ObjectCluster> clusters;

  double best_overlap(int label) const {
    double best = 0;
    const int labelled = cv::countNonZero(labels == label);
    for (const ObjectCluster& cluster : clusters) {
      const auto both =
          std::ranges::count_if(cluster.pixels, [&](int pixel) { return labels.ptr<int>()[pixel] == label; });
      const auto all = static_cast<double>(cluster.pixels.size()) + labelled - static_cast<double>(both);
      best = std::max(best, static_cast<double>(both) / all);
    }
    return best;
  }
};

StackResult find_stacks(const PaintedTable& table, bool with_color = true,
                        const ClusterOptions& options = ClusterOptions()) {
  StackResult found;
  const cv::Mat measured = table.render(0.05, found.labels);
  const cv::Mat depth = smooth_depth(measured, table.camera, NormalOptions::for_objects());
  ClusterImages images{points_from_depth(depth, table.camera),
                       normals_from_depth(depth, table.camera, NormalOptions::for_objects()),
                       {},
                       {}};
  if (with_color) {
    images.color = table.color(found.labels, measured);
    images.color_camera = table.camera;
  }
  const auto supports =
      find_supports(images.points, images.normals, table.camera, table.up(), SupportOptions());
  found.clusters = extract_clusters(images, table.camera, supports, options);
  return found;
}

/// A round object upon a round object; only the outline and the front step, and the colours differ.
PaintedTable two_cans(double lower_radius, double upper_radius) {
  PaintedTable table;
  table.rounds = {{{{0, 0, 0}, 0.10, lower_radius, lower_radius}},
                  {{{0.002, 0.002, 0.10}, 0.09, upper_radius, upper_radius}}};
  table.colors = {kLowerColor, kUpperColor};
  return table;
}

TEST(Stacks, ObjectsOfNearlyOneWidthUponEachOtherAreTwo) {
  for (const auto& [lower, upper] : {std::pair(0.036, 0.043), {0.044, 0.036}, {0.04, 0.05}}) {
    const StackResult found = find_stacks(two_cans(lower, upper));
    EXPECT_EQ(found.clusters.size(), 2U) << lower << " " << upper;
    for (int label = 1; label <= 2; ++label)
      EXPECT_GT(found.best_overlap(label), 0.8) << lower << " " << upper << " " << label;
  }
}

TEST(Stacks, AreCutOnlyWhereThatIsWanted) {
  const PaintedTable table = two_cans(0.036, 0.043);
  ClusterOptions options;
  options.stacks.stack_probability = 1;
  EXPECT_EQ(find_stacks(table, true, options).clusters.size(), 1U);
  EXPECT_EQ(find_stacks(table, false).clusters.size(), 1U);
}

TEST(Stacks, TheUpperOneStandsOnTheLowerOne) {
  const StackResult found = find_stacks(two_cans(0.036, 0.043));
  ASSERT_EQ(found.clusters.size(), 2U);
  const size_t upper = found.clusters[0].top > found.clusters[1].top ? 0 : 1;
  EXPECT_EQ(found.clusters[upper].stands_on, static_cast<int>(1 - upper));
}

TEST(Stacks, APrintIsNoSeam) {
  PaintedTable table;
  table.rounds = {{{{-0.1, 0, 0}, 0.19, 0.04, 0.04}}};
  table.boxes = {{{0.15, 0, 0.09}, {0.10, 0.07, 0.18}}};
  table.colors = {kLowerColor, kLowerColor};
  table.seam_m = 0.1;
  EXPECT_EQ(find_stacks(table).clusters.size(), 2U);
}

TEST(Stacks, TheKnobOfALidIsOfThePot) {
  PaintedTable table;
  table.rounds = {{{{0, 0, 0}, 0.11, 0.09, 0.09}}, {{{0, 0, 0.11}, 0.025, 0.02, 0.02}}};
  table.colors = {kLowerColor, kUpperColor};
  EXPECT_EQ(find_stacks(table).clusters.size(), 1U);
}

TEST(Stacks, ABarOnOneSideIsNoSeam) {
  PaintedTable table;  // as a handle is
  table.boxes = {{{0, 0, 0.09}, {0.10, 0.07, 0.18}}, {{0.065, 0, 0.12}, {0.03, 0.02, 0.08}}};
  table.colors = {kLowerColor, kUpperColor};
  const StackResult found = find_stacks(table);
  EXPECT_GT(found.best_overlap(1), 0.75);
}

/// A step that is a stack by every measure.
StackStep clear_step() {
  StackStep step;
  step.height = step.above = step.below = 0.1f;
  step.points_above = step.points_below = 2000;
  step.width_above = 0.09f;
  step.width_below = 0.07f;
  step.left = step.right = 0.01f;
  step.front = -0.01f;
  step.left_sigmas = step.right_sigmas = step.front_sigmas = 6;
  step.left_seen = step.right_seen = true;
  step.color = 40;
  return step;
}

TEST(StackProbability, NeedsTwoKindsOfEvidence) {
  const StackOptions options;
  EXPECT_GT(stack_probability(clear_step(), options), 0.95);
  StackStep step = clear_step();
  step.color = 2;
  step.front_sigmas = 0;
  EXPECT_LT(stack_probability(step, options), 0.5);  // two handles
  step = clear_step();
  step.left_sigmas = step.right_sigmas = step.front_sigmas = 0;
  EXPECT_LT(stack_probability(step, options), 0.1);  // a print
  step = clear_step();
  step.left_sigmas = 0;
  step.front_sigmas = 0;
  EXPECT_LT(stack_probability(step, options), 0.1);  // a print and a handle
}

TEST(StackProbability, IsNoneForLidsCapsAndWhatIsHardlySeen) {
  const StackOptions options;
  StackStep lid = clear_step();
  lid.above = 0.03f;
  lid.width_above = 0.06f;
  EXPECT_EQ(stack_probability(lid, options), 0);
  StackStep cap = clear_step();
  cap.above = 0.04f;
  cap.width_above = 0.045f;
  cap.width_below = 0.04f;
  EXPECT_EQ(stack_probability(cap, options), 0);
  StackStep hidden = clear_step();
  hidden.points_below = 100;
  EXPECT_EQ(stack_probability(hidden, options), 0);
  StackStep sliver = clear_step();
  sliver.left_seen = false;
  sliver.width_below = 0.02f;
  EXPECT_EQ(stack_probability(sliver, options), 0);
}

}  // namespace
}  // namespace loci::perception
