#include "memory/exchange/marker_layers.h"

#include <gmock/gmock.h>

#include "mapping/world/urdf.h"
#include "tests/memory/exchange/mug_and_box.h"

namespace loci::memory {
namespace {

using mapping::Marker;
using testing_support::MugAndBox;

/// A frame without images at a time of the memory's day.
mapping::RgbdFrame frame_at(const char* time, const JointState& joints = {}) {
  mapping::RgbdFrame frame;
  frame.time_ns = parse_time(time);
  frame.joints = joints;
  return frame;
}

TEST_F(MugAndBox, IsDrawnWhereItWasBelievedToBeAtTheTime) {
  const Store store = Store::open_read(file_);
  const mapping::MarkerLayer layer = object_layer(store);
  EXPECT_EQ(layer.topic, "/objects");
  EXPECT_TRUE(layer.at(frame_at("2026-05-01T07:00:00Z")).value().empty()) << "nothing was seen yet";
  const auto first = layer.at(frame_at("2026-05-01T08:00:00Z"));
  ASSERT_TRUE(first);
  ASSERT_EQ(first->size(), 4U) << "a box and a name of each";
  EXPECT_EQ(first->at(0).shape, Marker::Shape::box);
  EXPECT_NEAR(first->at(0).map_from_marker.translation().x(), 1, 0.01);
  EXPECT_NEAR(first->at(0).size.z(), 0.1, 1e-6);
  EXPECT_GT(first->at(0).color.x(), first->at(0).color.z()) << "the mug is red";
  EXPECT_EQ(first->at(1).shape, Marker::Shape::text);
  EXPECT_THAT(first->at(1).text, testing::HasSubstr("red"));
  EXPECT_FALSE(layer.at(frame_at("2026-05-01T08:30:00Z"))) << "no scene since then";
  const auto second = layer.at(frame_at("2026-05-01T09:00:00Z"));
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->at(0).map_from_marker.translation().x(), 3, 0.01) << "the mug went to the shelf";
}

TEST(MapLayers, OnlyWhatMovesIsDrawnAgain) {
  const mapping::World map = mapping::parse_urdf(R"(<robot name="r"><link name="world"/>
    <link name="table"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
    <joint name="fixed" type="fixed"><parent link="world"/><child link="table"/></joint>
    <link name="drawer"><visual><geometry><box size="1 1 1"/></geometry>
      <material name="red"><color rgba="1 0 0 1"/></material></visual></link>
    <joint name="drawer_joint" type="prismatic"><parent link="world"/><child link="drawer"/><axis xyz="1 0 0"/>
      <limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>)",
                                                 "test.urdf");
  Warnings warnings;
  const std::vector<mapping::MarkerLayer> layers = map_layers(map, {}, warnings);
  ASSERT_EQ(layers.size(), 2U);
  const auto still = layers[0].at(frame_at("2026-05-01T08:00:00Z"));
  ASSERT_TRUE(still);
  ASSERT_EQ(still->size(), 1U);
  EXPECT_EQ(still->at(0).group, "table");
  EXPECT_EQ(still->at(0).points.size(), 36U) << "twelve triangles";
  EXPECT_FALSE(layers[0].at(frame_at("2026-05-01T08:00:01Z")));

  const auto x_of = [](const std::optional<std::vector<Marker>>& markers) {
    return markers.value().at(0).map_from_marker.translation().x();
  };
  const JointState open = {{"drawer_joint", 0.5}, {"of_a_robot", 1}};
  EXPECT_EQ(x_of(layers[1].at(frame_at("2026-05-01T08:00:00Z"))), 0);
  EXPECT_EQ(x_of(layers[1].at(frame_at("2026-05-01T08:00:01Z", open))), 0.5);
  EXPECT_FALSE(layers[1].at(frame_at("2026-05-01T08:00:02Z", open)));
}

}  // namespace
}  // namespace loci::memory
