#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/simulation/simulated_robot.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "tests/mapping/simulation/samples.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

bool is_fixture(const SemanticLink& link) {
  return link.class_name == "handle" || link.class_name == "knob";
}

bool is_front(const SemanticLink& link) {
  return link.class_name == "drawer" || link.class_name == "door" || link.class_name == "flap" ||
         link.class_name == "front";
}

class SampleKitchen : public testing::TestWithParam<const char*> {
 protected:
  const fs::path urdf_ = kSamples / GetParam();
  const World world_ = read_urdf(urdf_);
  const SemanticMap map_ = read_semantic_map(sidecar_path(urdf_));
  const std::vector<Isometry3d> map_from_link_ = root_from_links(world_, {});

  const Isometry3d& pose(const std::string& link) const { return map_from_link_[world_.link_index(link)]; }
};

TEST_P(SampleKitchen, EveryLinkWithGeometryHasCollisionInertiaAndAClass) {
  for (const Link& link : world_.links) {
    if (link.visuals.empty()) continue;
    EXPECT_FALSE(link.collisions.empty()) << link.name;
    ASSERT_TRUE(link.inertial.has_value()) << link.name;
    EXPECT_GT(link.inertial->mass, 0) << link.name;
    // A column is no wall and no furniture: there is no class for it.
    EXPECT_TRUE(map_.links.contains(link.name) || link.name.starts_with("column")) << link.name;
  }
  for (const auto& [name, link] : map_.links) EXPECT_NE(world_.find_link(name), nullptr) << name;
}

TEST_P(SampleKitchen, SidecarSaysWhatTheLinksFramesSay) {
  for (const auto& [name, link] : map_.links) {
    if (link.geometry.contains("height") && link.geometry.contains("outline")) {
      EXPECT_NEAR(pose(name).translation().z(), link.geometry["height"].get<double>(), 1e-5) << name;
      EXPECT_NEAR(pose(name).linear()(2, 2), 1, 1e-9) << name;
    }
    if (link.class_name == "wall") {
      const Vector3d normal = vector_from_json(link.geometry["normal"]);
      EXPECT_LT((pose(name).linear().col(0) - normal).norm(), 1e-6) << name;
      EXPECT_NEAR(normal.dot(pose(name).translation()), link.geometry["offset"].get<double>(), 1e-6) << name;
    }
    if (is_front(link)) {
      const bool hinged = world_.find_link(name + "_front") != nullptr;
      const Isometry3d& front = pose(hinged ? name + "_front" : name);
      EXPECT_LT((front.translation() - vector_from_json(link.geometry["centre"])).norm(), 1e-5) << name;
      EXPECT_LT((front.linear().col(0) - vector_from_json(link.geometry["normal"])).norm(), 1e-5) << name;
    }
    if (is_fixture(link)) {  // The bar or the head is drawn first, then what holds it.
      const Isometry3d map_from_bar = pose(name) * world_.find_link(name)->visuals.front().link_from_visual;
      EXPECT_LT((map_from_bar.translation() - vector_from_json(link.geometry["centre"])).norm(), 1e-5)
          << name;
    }
  }
}

TEST_P(SampleKitchen, EveryHandleOpensItsFrontIntoTheRoom) {
  SimulatedRobotOptions options;
  options.odometry = {0, 0, 0};
  Warnings warnings;
  SimulatedRobot robot(urdf_, options, {2, 1.5, 0}, warnings);
  EXPECT_TRUE(warnings.empty());
  int pulled = 0;
  for (const auto& [name, link] : map_.links) {
    if (!is_fixture(link)) continue;
    const PullResult result = robot.pull(vector_from_json(link.geometry["centre"]), 0.2);
    EXPECT_EQ(result.link, name);
    const std::string front = name.substr(0, name.rfind('_'));
    EXPECT_TRUE(result.joint == front + "_joint" || result.joint == front + "_front_joint")
        << name << " moves " << result.joint;
    ASSERT_GE(result.hand_path.size(), 2u) << name;
    const Isometry3d way = result.hand_path.front().inverse() * result.hand_path.back();
    const SemanticLink& moved = map_.links.at(map_.links.contains(front) ? front : front + "_front");
    const Vector3d normal = vector_from_json(moved.geometry["normal"]);
    const Vector3d out = result.hand_path.back().translation() - result.hand_path.front().translation();
    EXPECT_GT(normal.dot(out), 0.15) << name;
    EXPECT_EQ(way.linear().isIdentity(0.05), moved.class_name == "drawer") << name;
    robot.close_all();
    ++pulled;
  }
  EXPECT_GE(pulled, 8);
}

/// Position and extent of a front's rectangle along its right and up.
struct Rectangle {
  Eigen::Vector2d low, high;
};

TEST_P(SampleKitchen, FrontsOfOnePlaneKeepTheirSeams) {
  std::vector<std::pair<std::string, const SemanticLink*>> fronts;
  for (const auto& [name, link] : map_.links)
    if (is_front(link)) fronts.emplace_back(name, &link);
  const auto rectangle = [](const SemanticLink& link, const Vector3d& normal) {
    const Vector3d up = vector_from_json(link.geometry["up"]),
                   centre = vector_from_json(link.geometry["centre"]);
    const Eigen::Vector2d middle(up.cross(normal).dot(centre), up.dot(centre));
    const Eigen::Vector2d half(link.geometry["width"].get<double>() / 2,
                               link.geometry["height"].get<double>() / 2);
    return Rectangle{middle - half, middle + half};
  };
  for (size_t i = 0; i < fronts.size(); ++i)
    for (size_t j = i + 1; j < fronts.size(); ++j) {
      const Vector3d normal = vector_from_json(fronts[i].second->geometry["normal"]);
      const Vector3d between = vector_from_json(fronts[i].second->geometry["centre"]) -
                               vector_from_json(fronts[j].second->geometry["centre"]);
      if (normal.dot(vector_from_json(fronts[j].second->geometry["normal"])) < 0.999) continue;
      if (std::abs(normal.dot(between)) > 0.02) continue;
      const Rectangle a = rectangle(*fronts[i].second, normal), b = rectangle(*fronts[j].second, normal);
      const Eigen::Vector2d gap = (a.low - b.high).cwiseMax(b.low - a.high);
      EXPECT_GE(gap.maxCoeff(), 0.003 - 1e-6) << fronts[i].first << " and " << fronts[j].first;
    }
}

INSTANTIATE_TEST_SUITE_P(Samples, SampleKitchen, testing::Values("kitchen.urdf", "kitchen_l.urdf"),
                         [](const auto& tested) { return fs::path(tested.param).stem().string(); });

TEST(SampleKitchenL, HasWhatExplorationHasToCopeWith) {
  const SemanticMap map = read_semantic_map(kSamples / "kitchen_l.semantic.json");
  std::map<std::string, int> classes;
  for (const auto& [name, link] : map.links) ++classes[link.class_name];
  EXPECT_EQ(classes["wall"], 6);
  EXPECT_GE(classes["handle"] + classes["knob"], 20);
  EXPECT_EQ(classes["knob"], 2);
  EXPECT_GE(classes["flap"], 1);
  EXPECT_GE(classes["front"], 1);
  EXPECT_EQ(classes["island"], 1);
}

TEST(Apartment, EveryVisibleHandleOpensWhatItHangsOn) {
  const fs::path data = fs::path(LOCI_SHARED_DIR) / "data";
  if (!fs::exists(data / "iai_apartment")) GTEST_SKIP() << "no shared data";
  SimulatedRobotOptions options;
  options.package_paths = {data};
  Warnings warnings;
  SimulatedRobot robot(data / "iai_apartment/apartment.urdf", options, {1.5, 2, 0}, warnings);
  const Json truth = read_json(data / "iai_apartment/truth.json");
  int opened = 0;
  for (const Json& handle : truth["handles"]) {
    if (!handle["visible_when_closed"].get<bool>()) continue;
    const PullResult result = robot.pull(vector_from_json(handle["bar_centre"]), 0.2);
    const Joint* joint = robot.world().parent_joint(handle["front_link"].get<std::string>());
    ASSERT_NE(joint, nullptr);
    // The lower half of a folding door follows the upper one, which is what opens.
    EXPECT_EQ(result.joint, joint->mimic ? joint->mimic->joint : joint->name) << handle["link"];
    ASSERT_GE(result.hand_path.size(), 2u) << handle["link"];
    EXPECT_GT((result.hand_path.back().translation() - result.hand_path.front().translation()).norm(), 0.15);
    robot.close_all();
    ++opened;
  }
  EXPECT_GE(opened, 20);
}

TEST(SampleKitchenFirst, DrawersOpenIntoTheRoom) {
  const World world = read_urdf(kSamples / "kitchen.urdf");
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
}  // namespace loci::mapping
