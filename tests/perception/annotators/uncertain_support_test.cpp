#include <gtest/gtest.h>

#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/structure/normals.h"
#include "tests/perception/annotators/synthetic_table.h"

namespace loci::perception {
namespace {

/// Objects on a table whose height is known to 15 mm only, with a disc of 12 mm on it.
std::vector<ObjectCluster> on_uncertain_table(const cv::Vec3b& table_color, const cv::Vec3b& disc_color,
                                              bool with_color = true) {
  test::SyntheticTable table;
  table.rounds = {{{{0, 0, 0}, 0.012, 0.1, 0.1}}};
  cv::Mat labels;
  const cv::Mat depth = smooth_depth(table.render(0.05, labels), table.camera, NormalOptions::for_objects());
  ClusterImages images;
  images.points = points_from_depth(depth, table.camera);
  images.normals = normals_from_depth(depth, table.camera, NormalOptions::for_objects());
  if (with_color) {
    images.color = cv::Mat(depth.size(), CV_8UC3, cv::Scalar(table_color));
    images.color.setTo(cv::Scalar(disc_color), labels == 1);
    images.color_camera = table.camera;
  }
  std::vector<SupportPlane> supports =
      find_supports(images.points, images.normals, table.camera, table.up(), SupportOptions());
  for (SupportPlane& support : supports) support.uncertainty = 0.015;
  return extract_clusters(images, table.camera, supports, ClusterOptions());
}

TEST(Supports, AreFoundAtTheResolutionOfAPhone) {
  test::SyntheticTable table;
  table.camera = {160, 120, 145, 145, 80, 60};
  cv::Mat labels;
  const cv::Mat depth = smooth_depth(table.render(0.05, labels), table.camera, NormalOptions::for_objects());
  SupportOptions options;
  options.min_area_m2 = 0.2;  // a third of the table
  const auto supports = find_supports(points_from_depth(depth, table.camera),
                                      normals_from_depth(depth, table.camera, NormalOptions::for_objects()),
                                      table.camera, table.up(), options);
  ASSERT_EQ(supports.size(), 1U);
  EXPECT_GT(supports[0].area, 0.4);
}

TEST(UncertainSupport, ALowObjectIsToldByItsColor) {
  const cv::Vec3b grey(90, 90, 90), red(40, 40, 200);
  EXPECT_EQ(on_uncertain_table(grey, red).size(), 1U);
  EXPECT_EQ(on_uncertain_table(grey, grey).size(), 0U);
  EXPECT_EQ(on_uncertain_table(grey, red, false).size(), 0U) << "its colour is not known";
}

}  // namespace
}  // namespace loci::perception
