#include "perception/conversions/opencv.h"

#include <gtest/gtest.h>

namespace loci::perception::types {
namespace {

TEST(CameraConversion, BothCamerasComeBack) {
  cas::Cas cas(type_system());
  const SceneCas scene_cas(cas);
  scene_cas.create_scene();
  EXPECT_THROW(cameras(scene_cas), Error);
  mapping::RgbdCamera camera;
  camera.color.fx = camera.color.fy = 528;
  camera.depth_from_color.translation().x() = 0.022;
  set_cameras(scene_cas, camera);
  set_cameras(scene_cas, camera);
  const mapping::RgbdCamera back = cameras(scene_cas);
  EXPECT_EQ(back.depth, camera.depth);
  EXPECT_EQ(back.color, camera.color);
  EXPECT_TRUE(back.depth_from_color.isApprox(camera.depth_from_color));
  EXPECT_EQ(scene_cas.scene().cameras.size(), 2U);
}

}  // namespace
}  // namespace loci::perception::types
