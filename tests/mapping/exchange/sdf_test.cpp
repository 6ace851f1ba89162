#include "mapping/exchange/formats/sdf.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <sdf/sdf.hh>

#include "mapping/exchange/map_colors.h"
#include "mapping/world/kinematics.h"
#include "tests/mapping/exchange/photographed_map.h"

namespace loci::mapping::test {
namespace {

/// What sdformat has to say against a text; empty = nothing.
std::string complaints(const sdf::Errors& errors) {
  std::string text;
  for (const sdf::Error& error : errors) text += error.Message() + "\n";
  return text;
}

Isometry3d pose_of(const ignition::math::Pose3d& pose) {
  Isometry3d result = Isometry3d::Identity();
  result.translation() = Vector3d(pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z());
  result.linear() =
      Eigen::Quaterniond(pose.Rot().W(), pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z()).toRotationMatrix();
  return result;
}

void expect_same_world(const World& world, const sdf::Model& model) {
  const std::vector<Isometry3d> root_from_link = root_from_links(world, {});
  for (size_t i = 0; i < world.links.size(); ++i) {
    const std::string& name = world.links[i].name;
    ignition::math::Pose3d pose;
    const sdf::Link* link = model.LinkByName(name);
    const sdf::Frame* frame = model.FrameByName(name);
    ASSERT_TRUE(link != nullptr || frame != nullptr) << name;
    const sdf::SemanticPose place = link != nullptr ? link->SemanticPose() : frame->SemanticPose();
    ASSERT_EQ(complaints(place.Resolve(pose, "__model__")), "") << name;
    EXPECT_LT((pose_of(pose).matrix() - root_from_link[i].matrix()).norm(), 1e-6) << name;
    if (link == nullptr) continue;
    EXPECT_EQ(link->VisualCount(), world.links[i].visuals.size()) << name;
    EXPECT_EQ(link->CollisionCount(), world.links[i].collisions.size()) << name;
    if (world.links[i].inertial) {
      EXPECT_NEAR(link->Inertial().MassMatrix().Mass(), world.links[i].inertial->mass, 1e-9) << name;
      EXPECT_TRUE(link->Inertial().MassMatrix().IsValid()) << name;
    }
  }
  for (const Joint& joint : world.joints) {
    if (joint.type == JointType::fixed) continue;
    const sdf::Joint* other = model.JointByName(joint.name);
    ASSERT_NE(other, nullptr) << joint.name;
    EXPECT_EQ(other->Type() == sdf::JointType::PRISMATIC, joint.type == JointType::prismatic) << joint.name;
    EXPECT_EQ(other->ChildLinkName(), joint.child);
    ignition::math::Vector3d axis;
    ASSERT_EQ(complaints(other->Axis(0)->ResolveXyz(axis, joint.child)), "");
    EXPECT_LT((Vector3d(axis.X(), axis.Y(), axis.Z()) - joint.axis).norm(), 1e-6) << joint.name;
    EXPECT_NEAR(other->Axis(0)->Upper(), joint.limits->upper, 1e-9) << joint.name;
  }
}

TEST(Sdf, SdformatReadsTheSameWorldFromIt) {
  const FurnishedMap map;
  Warnings warnings;
  sdf::Root root;
  ASSERT_EQ(complaints(root.LoadSdfString(sdf_text(map.world, warnings))), "");
  ASSERT_NE(root.Model(), nullptr);
  expect_same_world(map.world, *root.Model());
  EXPECT_TRUE(warnings.empty());
}

TEST(Sdf, SdformatReadsTheSampleKitchen) {
  const World world = read_urdf(std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf");
  Warnings warnings;
  sdf::Root root;
  ASSERT_EQ(complaints(root.LoadSdfString(sdf_text(world, warnings))), "");
  expect_same_world(world, *root.Model());
}

TEST(Sdf, SdformatReadsAWorldOfMeshesAndMimicJoints) {
  const std::filesystem::path urdf =
      std::filesystem::path(LOCI_SHARED_DIR) / "data/iai_apartment/apartment.urdf";
  if (!std::filesystem::exists(urdf)) GTEST_SKIP() << "no shared data";
  const World world = read_urdf(urdf);
  Warnings warnings;
  sdf::Root root;
  ASSERT_EQ(complaints(root.LoadSdfString(sdf_text(world, warnings))), "");
  EXPECT_FALSE(warnings.empty());  // mimic joints
  EXPECT_EQ(root.Model()->LinkCount() + root.Model()->FrameCount(), world.links.size());
}

TEST(Sdf, SdformatAcceptsTheUrdf) {
  const FurnishedMap map;
  sdf::Root root;
  ASSERT_EQ(complaints(root.LoadSdfString(urdf_text(map.world))), "");
  ASSERT_NE(root.Model(), nullptr);
  for (const char* joint : {"drawer_1_front_joint", "door_1_joint"})
    EXPECT_NE(root.Model()->JointByName(joint), nullptr) << joint;
}

TEST(Sdf, SdformatAcceptsTexturesInUrdfAndSdf) {
  InterpretedMap map = photographed_map();
  ASSERT_FALSE(add_textures(map).empty());
  Warnings warnings;
  for (const std::string& text : {urdf_text(map.world), sdf_text(map.world, warnings)}) {
    sdf::Root root;
    ASSERT_EQ(complaints(root.LoadSdfString(text)), "");
    const sdf::Link& door = *root.Model()->LinkByName("door_1");
    std::vector<std::string> meshes;  // sdformat joins the fixed handle to the door
    for (uint64_t i = 0; i < door.VisualCount(); ++i)
      if (const sdf::Mesh* mesh = door.VisualByIndex(i)->Geom()->MeshShape()) meshes.push_back(mesh->Uri());
    EXPECT_EQ(meshes, std::vector<std::string>{"textures/door_1.obj"});
  }
}

}  // namespace
}  // namespace loci::mapping::test
