#include "mapping/world/contacts.h"

#include <gtest/gtest.h>

#include "mapping/base/math/math.h"

namespace loci::mapping {
namespace {

/// A door of 0.6 m in the plane y = 0 that turns about its left edge, and what stands around it.
struct Room {
  World world;

  Room() {
    world.name = world.root = "room";
    world.links.push_back({"room", {}, {}, {}});
    add("door", "room", Vector3d::Zero(), {0.3, 0, 0}, {0.6, 0.02, 1});
    world.joints.back().type = JointType::revolute;
    world.joints.back().axis = -Vector3d::UnitZ();
    world.joints.back().limits = JointLimits{0, kPi / 2, 20, 1};
  }

  void add(const std::string& name, const std::string& parent, const Vector3d& at, const Vector3d& middle,
           const Vector3d& size) {
    Link link;
    link.name = name;
    link.collisions.push_back({"", Isometry3d(Eigen::Translation3d(middle)), Box{size}});
    world.links.push_back(link);
    Joint joint;
    joint.name = name + "_joint";
    joint.parent = parent;
    joint.child = name;
    joint.parent_from_joint.translation() = at;
    world.joints.push_back(joint);
  }
};

TEST(Contacts, NamesWhatPenetratesAndHowDeep) {
  Room room;
  EXPECT_TRUE(closed_contacts(room.world).empty());
  room.add("post", "room", {0.603, 0, 0}, {0, 0, 0}, {0.01, 0.1, 1});
  room.add("wall", "room", {0.65, 0, 0}, {0, 0, 0}, {0.1, 1, 1});  // in the post: both stand still
  room.add("handle", "door", {0.5, -0.03, 0}, {0, 0, 0}, {0.2, 0.02, 0.02});
  const std::vector<Contact> contacts = closed_contacts(room.world);
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(contacts[0].first, "handle");
  EXPECT_EQ(contacts[0].second, "post");
  EXPECT_NEAR(contacts[1].depth, 0.002, 1e-9);
}

TEST(Contacts, AnAskewBoxBesideACornerDoesNotTouchIt) {
  Room room;
  room.add("post", "room", {0.67, -0.07, 0}, {0, 0, 0}, {0.1, 0.1, 1});
  room.world.joints.back().parent_from_joint.rotate(Eigen::AngleAxisd(kPi / 4, Vector3d::UnitZ()));
  EXPECT_TRUE(closed_contacts(room.world).empty());
}

TEST(Contacts, AJointIsFreeUntilSomethingIsInItsWay) {
  Room room;
  const Joint& door = room.world.joints[0];
  EXPECT_DOUBLE_EQ(free_range(room.world, door).upper, kPi / 2);
  EXPECT_EQ(free_range(room.world, door).blocker, "");
  room.add("table", "room", {0, -0.5, 0}, {0.5, 0, 0}, {0.2, 0.2, 1});
  const FreeRange range = free_range(room.world, room.world.joints[0]);
  EXPECT_EQ(range.blocker, "table");
  EXPECT_NEAR(range.upper, std::asin(0.4 / 0.6), 2.5 * kDegree);
}

}  // namespace
}  // namespace loci::mapping
