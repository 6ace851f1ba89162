#include "mapping/world/world.h"

#include <algorithm>

#include "mapping/base/error.h"

namespace loci::mapping {

const Link* World::find_link(const std::string& link_name) const {
  const auto found = std::ranges::find(links, link_name, &Link::name);
  return found == links.end() ? nullptr : &*found;
}

const Joint* World::find_joint(const std::string& joint_name) const {
  const auto found = std::ranges::find(joints, joint_name, &Joint::name);
  return found == joints.end() ? nullptr : &*found;
}

size_t World::link_index(const std::string& link_name) const {
  const auto found = std::ranges::find(links, link_name, &Link::name);
  if (found != links.end()) return static_cast<size_t>(found - links.begin());
  std::vector<std::string> names;
  for (const Link& link : links) names.push_back(link.name);
  throw Error("the world '" + name + "' has no link '" + link_name + "'", {}, did_you_mean(link_name, names));
}

const Joint* World::parent_joint(const std::string& link_name) const {
  const auto found = std::ranges::find(joints, link_name, &Joint::child);
  return found == joints.end() ? nullptr : &*found;
}

const char* joint_type_name(JointType type) {
  switch (type) {
    case JointType::fixed:
      return "fixed";
    case JointType::revolute:
      return "revolute";
    case JointType::continuous:
      return "continuous";
    case JointType::prismatic:
      return "prismatic";
    case JointType::floating:
      return "floating";
    case JointType::planar:
      return "planar";
  }
  return "unknown";
}

}  // namespace loci::mapping
