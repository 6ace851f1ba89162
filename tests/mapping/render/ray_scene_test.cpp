#include "mapping/render/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "mapping/render/render.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

using Eigen::Vector3f;

constexpr float kFar = 100;

World ray_world(const std::string& parts) {
  return parse_urdf("<robot name=\"w\">" + parts + "</robot>", "test.urdf");
}

/// A red wall at x = 2 and, on a slide along y, a green box with a glass knob before it.
World slide() {
  return ray_world(R"(
    <link name="wall"><visual><origin xyz="2.05 0 0"/><geometry><box size="0.1 4 4"/></geometry>
      <material name="red"><color rgba="1 0 0 1"/></material></visual></link>
    <link name="drawer"><visual><geometry><box size="0.2 0.2 0.2"/></geometry>
      <material name="green"><color rgba="0 1 0 1"/></material></visual></link>
    <link name="knob"><visual><geometry><sphere radius="0.02"/></geometry>
      <material name="GlassBlue"><color rgba="0 0 1 1"/></material></visual></link>
    <joint name="slide" type="prismatic"><parent link="wall"/><child link="drawer"/><origin xyz="1.5 0 0"/>
      <axis xyz="0 1 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
    <joint name="screw" type="fixed"><parent link="drawer"/><child link="knob"/><origin xyz="-0.12 0 0"/></joint>)");
}

RayScene ray_scene(const World& world) {
  RayScene scene;
  Warnings warnings;
  scene.add(world, {}, Isometry3d::Identity(), warnings);
  return scene;
}

std::string hit_name(const RayScene& scene, const Vector3f& origin, const Vector3f& direction) {
  const RayHit hit = scene.cast(origin, direction.normalized(), kFar);
  return hit.link < 0 ? "" : scene.link_names()[static_cast<size_t>(hit.link)];
}

TEST(RayScene, HitSaysDistanceLinkNormalAndColour) {
  const RayScene scene = ray_scene(slide());
  const RayHit hit = scene.cast({0, 1, 0}, {1, 0, 0}, kFar);
  EXPECT_NEAR(hit.distance, 2, 1e-6);
  EXPECT_EQ(scene.link_names()[static_cast<size_t>(hit.link)], "wall");
  EXPECT_LT((hit.normal - Vector3f(-1, 0, 0)).norm(), 1e-6);
  EXPECT_EQ(hit.color, (std::array<uint8_t, 3>{255, 0, 0}));
  EXPECT_FALSE(hit.glossy);
  EXPECT_FALSE(hit.from_behind);
}

TEST(RayScene, NormalPointsTowardsTheOriginFromInsideToo) {
  const RayScene scene = ray_scene(slide());
  const RayHit hit = scene.cast({2.05f, 0, 0}, {1, 0, 0}, kFar);
  EXPECT_LT((hit.normal - Vector3f(-1, 0, 0)).norm(), 1e-6);
  EXPECT_TRUE(hit.from_behind);
}

TEST(RayScene, MissAndTooFarAreNothing) {
  const RayScene scene = ray_scene(slide());
  for (const RayHit& hit :
       {scene.cast({0, 0, 0}, {-1, 0, 0}, kFar), scene.cast({0, 1, 0}, {1, 0, 0}, 1.9f)}) {
    EXPECT_EQ(hit.link, -1);
    EXPECT_TRUE(std::isinf(hit.distance));
  }
}

TEST(RayScene, JointMovesWhatHangsOnIt) {
  RayScene scene = ray_scene(slide());
  EXPECT_EQ(hit_name(scene, {0, 0, 0}, {1, 0, 0}), "knob");
  EXPECT_EQ(hit_name(scene, {0, 0.05f, 0}, {1, 0, 0}), "drawer");
  scene.set_joints(0, {{"slide", 0.7}});
  EXPECT_EQ(hit_name(scene, {0, 0, 0}, {1, 0, 0}), "wall");
  EXPECT_EQ(hit_name(scene, {0, 0.7f, 0}, {1, 0, 0}), "knob");
  EXPECT_NEAR(scene.map_from_link(2).translation().y(), 0.7, 1e-12);
  scene.set_joints(0, {});
  EXPECT_EQ(hit_name(scene, {0, 0, 0}, {1, 0, 0}), "knob");
}

TEST(RayScene, NameOfAMaterialMakesItGlossy) {
  const RayScene scene = ray_scene(slide());
  EXPECT_TRUE(scene.cast({0, 0, 0}, {1, 0, 0}, kFar).glossy);
  EXPECT_TRUE(glossy_material("front_glossy_white"));
  EXPECT_TRUE(glossy_material("Mirror"));
  EXPECT_FALSE(glossy_material("steel"));
  EXPECT_FALSE(glossy_material(""));
}

TEST(RayScene, PlacesAndNamesPartsAsRenderSceneDoes) {
  RayScene rays = ray_scene(slide());
  RenderScene render;
  Warnings warnings;
  Isometry3d moved = Isometry3d::Identity();
  moved.translation().y() = 10;
  render.add(slide(), {}, Isometry3d::Identity(), warnings);
  rays.add(slide(), {}, moved, warnings);
  render.add(slide(), {}, moved, warnings);
  EXPECT_EQ(rays.link_names(), render.link_names());
  for (size_t link = 0; link < rays.link_names().size(); ++link)
    EXPECT_TRUE(rays.map_from_link(link).isApprox(render.map_from_link(link)));
  EXPECT_EQ(hit_name(rays, {0, 10, 0}, {1, 0, 0}), rays.link_names()[5]);
}

TEST(RayScene, CylinderMeetsWhatReachesIntoIt) {
  const RayScene scene = ray_scene(slide());
  EXPECT_EQ(scene.link_in_cylinder({1, 0}, 0.25, -1, 1), -1);
  EXPECT_GE(scene.link_in_cylinder({1.2, 0}, 0.25, -1, 1), 1);     // The knob at 1.38 - 0.02.
  EXPECT_EQ(scene.link_in_cylinder({1.2, 0}, 0.25, 0.15, 1), -1);  // Above it and the drawer.
  EXPECT_EQ(scene.link_in_cylinder({1.8, 1}, 0.25, 0.15, 0.2), 0);
  // Inside a tall box that is wider than the cylinder, but not in a room that is one box.
  const auto box = [](const std::string& size) {
    return ray_scene(ray_world("<link name=\"box\"><visual><geometry><box size=\"" + size +
                               "\"/></geometry></visual></link>"));
  };
  EXPECT_EQ(box("0.7 0.7 4").link_in_cylinder({0, 0}, 0.25, 0.05, 1.3), 0);
  EXPECT_EQ(box("5 5 4").link_in_cylinder({0, 0}, 0.25, 0.05, 1.3), -1);
  EXPECT_EQ(box("0.7 0.7 4").link_in_cylinder({2, 0}, 0.25, 0.05, 1.3), -1);
  // In the middle of a wide top, far from its edges.
  const RayScene table = ray_scene(
      ray_world(R"(<link name="table"><visual><geometry><box size="4 4 0.04"/></geometry></visual></link>)"));
  EXPECT_EQ(table.link_in_cylinder({0.3, 0.2}, 0.25, 0, 1), 0);
  EXPECT_EQ(table.link_in_cylinder({0.3, 0.2}, 0.25, 0.03, 1), -1);
}

TEST(RayScene, NearestSurfaceIsFoundWithinReach) {
  const RayScene scene = ray_scene(slide());
  const NearestSurface found = scene.nearest({1.97, 1, 0.3}, 0.05);
  EXPECT_EQ(found.link, 0);
  EXPECT_NEAR(found.distance, 0.03, 1e-6);
  EXPECT_LT((found.point - Vector3d(2, 1, 0.3)).norm(), 1e-6);
  EXPECT_EQ(scene.nearest({1.9, 1, 0.3}, 0.05).link, -1);
  const NearestSurface corner = scene.nearest({1.37, 0.13, 0.14}, 0.1);  // Outside a corner of the drawer.
  EXPECT_EQ(corner.link, 1);
  EXPECT_LT((corner.point - Vector3d(1.4, 0.1, 0.1)).norm(), 1e-6);
}

Isometry3d looking(const Vector3d& from, const Vector3d& at) {
  Isometry3d map_from_camera = Isometry3d::Identity();
  const Vector3d z = (at - from).normalized(), x = z.cross(Vector3d::UnitZ()).normalized();
  map_from_camera.linear() << x, z.cross(x), z;
  map_from_camera.translation() = from;
  return map_from_camera;
}

/// Pixels of a view on which the rasteriser and single rays are more than 2 mm apart.
int different_pixels(const RenderScene& raster, const RayScene& rays, const Isometry3d& map_from_camera) {
  const PinholeCamera camera;
  const cv::Mat depth = raster.render(camera, map_from_camera, {}, 0).depth;
  const Vector3f origin = map_from_camera.translation().cast<float>();
  int different = 0;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Vector3d ray = camera.unproject(u, v, 1);
      const RayHit hit = rays.cast(origin, (map_from_camera.linear() * ray.normalized()).cast<float>(), kFar);
      const double a = hit.link < 0 ? 1e3 : hit.distance / ray.norm();
      const double z = static_cast<double>(depth.at<float>(v, u));
      if (!(std::abs(a - (std::isnan(z) ? 1e3 : z)) <= 0.002)) ++different;
    }
  return different;
}

TEST(RayScene, RasteriserAgreesOnTheApartment) {
  const std::filesystem::path data = std::filesystem::path(LOCI_SHARED_DIR) / "data";
  const std::filesystem::path urdf = data / "iai_apartment/apartment.urdf";
  if (!std::filesystem::exists(urdf)) GTEST_SKIP() << "no " << urdf;
  const World world = read_urdf(urdf);
  const JointState open = {{"cabinet9_drawer_top_joint", 0.3}};
  RenderScene raster;
  RayScene rays;
  Warnings warnings;
  const MeshSearch search{{data}, urdf.parent_path()};
  raster.add(world, search, Isometry3d::Identity(), warnings);
  rays.add(world, search, Isometry3d::Identity(), warnings);
  raster.set_joints(0, open);
  rays.set_joints(0, open);
  const std::vector<std::pair<Vector3d, Vector3d>> views = {
      {{1.5, 1.5, 1.3}, {0.3, 3, 0.8}}, {{1.5, 3.5, 1.6}, {2.6, 2, 0.6}}, {{1.4, 2.2, 1.5}, {0, 1.6, 1.0}},
      {{5, 3, 1.6}, {1, 2.5, 0.9}},     {{14, 3.5, 1.5}, {18.7, 1, 0.7}}, {{9, 2.5, 1.7}, {15, 2.4, 0.5}}};
  for (size_t i = 0; i < views.size(); ++i)
    EXPECT_LT(different_pixels(raster, rays, looking(views[i].first, views[i].second)), 50) << "view " << i;
}

}  // namespace
}  // namespace loci::mapping
