#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/world/kinematics.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"

namespace loci {
namespace {

const std::filesystem::path kKitchen = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";

TEST(SampleKitchen, EveryLinkWithGeometryHasCollisionInertiaAndAClass) {
  const World world = read_urdf(kKitchen);
  const SemanticMap map = read_semantic_map(sidecar_path(kKitchen));
  for (const Link& link : world.links) {
    if (link.visuals.empty()) continue;
    EXPECT_FALSE(link.collisions.empty()) << link.name;
    ASSERT_TRUE(link.inertial.has_value()) << link.name;
    EXPECT_GT(link.inertial->mass, 0) << link.name;
    ASSERT_TRUE(map.links.contains(link.name)) << link.name;
  }
  for (const auto& [name, link] : map.links) EXPECT_NE(world.find_link(name), nullptr) << name;
}

TEST(SampleKitchen, SidecarSaysWhatTheLinksFramesSay) {
  const World world = read_urdf(kKitchen);
  const SemanticMap map = read_semantic_map(sidecar_path(kKitchen));
  const auto poses = root_from_links(world, {});
  for (const auto& [name, link] : map.links) {
    const Isometry3d& pose = poses[world.link_index(name)];
    if (link.geometry.contains("height") && link.geometry.contains("outline")) {
      EXPECT_NEAR(pose.translation().z(), link.geometry["height"].get<double>(), 1e-6) << name;
      EXPECT_NEAR(pose.linear()(2, 2), 1, 1e-9) << name;
    }
    if (link.class_name == "wall") {
      const auto n = link.geometry["normal"].get<std::array<double, 3>>();
      const Vector3d normal(n[0], n[1], n[2]);
      EXPECT_LT((pose.linear().col(0) - normal).norm(), 1e-6) << name;
      EXPECT_NEAR(normal.dot(pose.translation()), link.geometry["offset"].get<double>(), 1e-6) << name;
    }
    if (link.class_name == "drawer" || link.class_name == "handle") {
      const auto c = link.geometry["centre"].get<std::array<double, 3>>();
      EXPECT_LT((pose * Vector3d(link.class_name == "handle" ? 0.035 : 0, 0, 0) - Vector3d(c[0], c[1], c[2]))
                    .norm(),
                1e-6)
          << name;
    }
  }
}

TEST(SampleKitchen, DrawersOpenIntoTheRoom) {
  const World world = read_urdf(kKitchen);
  for (int i = 1; i <= 3; ++i) {
    const std::string drawer = "drawer_" + std::to_string(i);
    const auto closed = root_from_links(world, {});
    const auto open = root_from_links(world, {{drawer + "_front_joint", 0.5}});
    for (const char* part : {"_front", "_left", "_right", "_back", "_bottom", "_handle"}) {
      const size_t link = world.link_index(drawer + part);
      EXPECT_LT((open[link].translation() - closed[link].translation() - Vector3d(0, -0.5, 0)).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace loci
