#include "perception/conversions/pcl.h"

#include <gtest/gtest.h>

#include "mapping/base/text/json.h"
#include "perception/cas/json.h"

namespace loci::perception::types {
namespace {

template <typename Point>
std::shared_ptr<pcl::PointCloud<Point>> cloud_of(uint32_t width, uint32_t height) {
  auto cloud = std::make_shared<pcl::PointCloud<Point>>(width, height);
  auto* bytes = reinterpret_cast<uint8_t*>(cloud->points.data());
  for (size_t i = 0; i < cloud->size() * sizeof(Point); ++i) bytes[i] = static_cast<uint8_t>(i % 61);
  cloud->header.frame_id = "camera";
  cloud->header.stamp = 1234567;
  return cloud;
}

template <typename Point>
class CloudConversion : public testing::Test {};
using PointTypes = testing::Types<pcl::PointXYZ, pcl::Normal>;
TYPED_TEST_SUITE(CloudConversion, PointTypes);

TYPED_TEST(CloudConversion, SharedCloudsStayWhereTheyAre) {
  cas::Cas cas(type_system());
  using Cloud = pcl::PointCloud<TypeParam>;
  const auto cloud = cloud_of<TypeParam>(8, 6);
  const auto proxy = to(cas, cloud);
  EXPECT_EQ(points_of<TypeParam>(proxy).data(), cloud->points.data());
  EXPECT_EQ(from<std::shared_ptr<const Cloud>>(proxy), cloud);
  EXPECT_NE(from<std::shared_ptr<Cloud>>(proxy)->points.data(), cloud->points.data()) << "a copy to write to";
}

TYPED_TEST(CloudConversion, ComesBackFromJson) {
  cas::Cas cas(type_system()), other(type_system());
  const auto cloud = cloud_of<TypeParam>(8, 6);
  const auto json = cas::to_json(to(cas, cloud));
  const auto back = from<pcl::PointCloud<TypeParam>>(
      as<typename PointTraits<TypeParam>::Proxy>(cas::from_json(other, json)));
  ASSERT_EQ(back.size(), cloud->size());
  EXPECT_EQ(back.width, 8U);
  EXPECT_EQ(back.header.frame_id, "camera");
  EXPECT_EQ(back.header.stamp, 1234567U);
  EXPECT_EQ(std::memcmp(back.points.data(), cloud->points.data(), cloud->size() * sizeof(TypeParam)), 0);
}

TEST(CloudConversion, RefusesOtherPointsAndWrongSizes) {
  cas::Cas cas(type_system());
  const PointCloud proxy = to(cas, cloud_of<pcl::PointXYZ>(3, 1));
  EXPECT_THROW(points_of<pcl::Normal>(proxy), Error);
  proxy.width.set(4);
  EXPECT_THROW(points_of<pcl::PointXYZ>(proxy), Error);
}

}  // namespace
}  // namespace loci::perception::types
