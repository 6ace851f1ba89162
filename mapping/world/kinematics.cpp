#include "mapping/world/kinematics.h"

#include <cmath>
#include <string_view>
#include <unordered_map>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

using Index = std::unordered_map<std::string_view, size_t>;

void check_state(const World& world, const Index& joints, const JointState& state) {
  for (const auto& [name, position] : state) {
    if (!joints.contains(name)) {
      std::vector<std::string> names;
      for (const Joint& joint : world.joints) names.push_back(joint.name);
      throw Error("the world '" + world.name + "' has no joint '" + name + "'", {},
                  did_you_mean(name, names));
    }
    if (!std::isfinite(position)) throw Error("the position of joint '" + name + "' is not a finite number");
  }
}

/// Position of a joint, following mimic chains.
double joint_position(const World& world, const Index& joints, const JointState& state, size_t joint) {
  double multiplier = 1, offset = 0;
  for (size_t steps = 0; steps <= world.joints.size(); ++steps) {
    const Joint& current = world.joints[joint];
    if (!current.mimic) {
      const auto given = state.find(current.name);
      return multiplier * (given == state.end() ? 0.0 : given->second) + offset;
    }
    offset += multiplier * current.mimic->offset;
    multiplier *= current.mimic->multiplier;
    const auto next = joints.find(current.mimic->joint);
    if (next == joints.end())
      throw Error("joint '" + current.name + "' mimics '" + current.mimic->joint + "', which does not exist");
    joint = next->second;
  }
  throw Error("joint '" + world.joints[joint].name + "' mimics itself");
}

Index index_of_links(const World& world) {
  Index links;
  for (size_t i = 0; i < world.links.size(); ++i) links.emplace(world.links[i].name, i);
  return links;
}

/// The tree from the root down, in linear time: going up from each link is quadratic in a long chain.
template <class Visit>
void for_each_joint_downwards(const World& world, const Index& links, Visit visit) {
  std::vector<std::vector<size_t>> joints_below(world.links.size());
  for (size_t i = 0; i < world.joints.size(); ++i) {
    const auto parent = links.find(world.joints[i].parent);
    if (parent == links.end() || !links.contains(world.joints[i].child))
      throw Error("joint '" + world.joints[i].name + "' joins links that the world does not have");
    joints_below[parent->second].push_back(i);
  }
  std::vector<size_t> open;
  if (const auto root = links.find(world.root); root != links.end()) open.push_back(root->second);
  for (size_t done = 0; done < open.size() && done < world.links.size(); ++done) {
    const size_t parent = open[done];
    for (const size_t joint : joints_below[parent]) {
      const size_t child = links.at(world.joints[joint].child);
      visit(parent, joint, child);
      open.push_back(child);
    }
  }
}

}  // namespace

Isometry3d joint_motion(const Joint& joint, double position) {
  Isometry3d motion = Isometry3d::Identity();
  switch (joint.type) {
    case JointType::revolute:
    case JointType::continuous:
      motion.linear() = Eigen::AngleAxisd(position, joint.axis.normalized()).toRotationMatrix();
      break;
    case JointType::prismatic:
      motion.translation() = position * joint.axis.normalized();
      break;
    case JointType::fixed:
    case JointType::floating:
    case JointType::planar:
      break;
  }
  return motion;
}

JointState joints_of_world(const World& world, JointState state) {
  std::erase_if(state, [&](const auto& joint) { return world.find_joint(joint.first) == nullptr; });
  return state;
}

std::vector<Isometry3d> root_from_links(const World& world, const JointState& state) {
  Index joints;
  for (size_t i = 0; i < world.joints.size(); ++i) joints.emplace(world.joints[i].name, i);
  check_state(world, joints, state);

  std::vector<Isometry3d> root_from(world.links.size(), Isometry3d::Identity());
  for_each_joint_downwards(world, index_of_links(world), [&](size_t parent, size_t joint, size_t child) {
    root_from[child] = root_from[parent] * world.joints[joint].parent_from_joint *
                       joint_motion(world.joints[joint], joint_position(world, joints, state, joint));
  });
  return root_from;
}

const Joint* moving_joint(const World& world, const std::string& link) {
  const Joint* joint = world.parent_joint(link);
  while (joint != nullptr && joint->type == JointType::fixed) joint = world.parent_joint(joint->parent);
  return joint;
}

std::vector<bool> moving_links(const World& world) {
  std::vector<bool> moving(world.links.size(), false);
  for_each_joint_downwards(world, index_of_links(world), [&](size_t parent, size_t joint, size_t child) {
    moving[child] = moving[parent] || world.joints[joint].type != JointType::fixed;
  });
  return moving;
}

}  // namespace loci::mapping
