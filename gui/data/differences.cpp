#include "gui/data/differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "mapping/base/math/math.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/world.h"

namespace loci::gui {
namespace {

constexpr double kMinJointMove = 0.02;  // metres or radians; below is noise

bool is_there(const BelievedObject* object) {
  return object != nullptr && object->status != memory::ObjectStatus::gone;
}

std::string place_text(const Belief& belief, const BelievedObject* object) {
  if (!is_there(object)) return {};
  const std::string place = belief.place_of(*object);
  return place.empty() ? "somewhere" : place;
}

/// Pose of the link that a joint moves, in the map; unset where the map does not know it.
std::optional<Isometry3d> pose_behind(const Belief& belief, const std::string& joint) {
  const mapping::Joint* moved = belief.world == nullptr ? nullptr : belief.world->find_joint(joint);
  if (moved == nullptr) return std::nullopt;
  const auto poses = root_from_links(*belief.world, joints_of_world(*belief.world, belief.joints));
  for (size_t i = 0; i < poses.size(); ++i)
    if (belief.world->links[i].name == moved->child) return poses[i];
  return std::nullopt;
}

/// How far an object was moved; what stays in a drawer is not moved with it.
double distance_of(const Belief& belief_then, const BelievedObject& then, const Belief& belief_now,
                   const BelievedObject& now) {
  if (!then.position || !now.position) return 0;
  Vector3d before = *then.position;
  const auto& joints = belief_now.names->joint_of_place;
  if (const auto joint = then.place == now.place && now.place ? joints.find(*now.place) : joints.end();
      joint != joints.end()) {
    const auto was = pose_behind(belief_then, joint->second), is = pose_behind(belief_now, joint->second);
    if (was && is) before = *is * (was->inverse() * before);
  }
  return (*now.position - before).norm();
}

std::optional<Difference> difference_of(const Belief& belief_then, const BelievedObject* then,
                                        const Belief& belief_now, const BelievedObject* now, PlaceNames names,
                                        double min_move) {
  Difference difference{.object = now != nullptr ? now->object : then->object,
                        .name = now != nullptr ? belief_now.name_of(*now) : belief_then.name_of(*then),
                        .then = place_text(belief_then, then),
                        .now = place_text(belief_now, now)};
  if (!is_there(then) && !is_there(now)) return std::nullopt;
  if (!is_there(then)) {
    difference.kind = memory::EventKind::appeared;
    return difference;
  }
  if (!is_there(now)) {
    difference.kind = memory::EventKind::gone;
    return difference;
  }
  difference.distance = distance_of(belief_then, *then, belief_now, *now);
  const bool same_place = difference.then == difference.now ||
                          (names == PlaceNames::of_two_memories && then->position && now->position);
  if (difference.distance < min_move && same_place) return std::nullopt;
  return difference;
}

/// How far a joint is open, in the unit of its type: "38 cm", "90°".
std::string joint_text(const Belief& belief, const std::string& name) {
  const auto found = belief.joints.find(name);
  if (found == belief.joints.end()) return {};
  const mapping::Joint* joint = belief.world == nullptr ? nullptr : belief.world->find_joint(name);
  if (joint == nullptr) return fmt::format("{:.2f}", found->second);
  return joint->type == mapping::JointType::prismatic ? fmt::format("{:.0f} cm", 100 * found->second)
                                                      : fmt::format("{:.0f}°", found->second * 180 / kPi);
}

void add_joints(const Belief& then, const Belief& now, std::vector<Difference>& all) {
  for (const auto& [name, position] : now.joints) {
    const auto before = then.joints.find(name);
    const double moved = std::abs(position - (before == then.joints.end() ? 0 : before->second));
    if (moved >= kMinJointMove)
      all.push_back(
          {memory::EventKind::joint_changed, 0, name, joint_text(then, name), joint_text(now, name), moved});
  }
  for (const auto& [name, position] : then.joints)
    if (!now.joints.contains(name) && std::abs(position) >= kMinJointMove)
      all.push_back(
          {memory::EventKind::joint_changed, 0, name, joint_text(then, name), "", std::abs(position)});
}

}  // namespace

std::vector<Difference> differences(const Belief& then, const Belief& now, PlaceNames names,
                                    double min_move) {
  std::vector<Difference> all;
  for (const BelievedObject& object : now.objects)
    if (auto difference = difference_of(then, then.find(object.object), now, &object, names, min_move))
      all.push_back(std::move(*difference));
  for (const BelievedObject& object : then.objects)
    if (now.find(object.object) == nullptr)
      if (auto difference = difference_of(then, &object, now, nullptr, names, min_move))
        all.push_back(std::move(*difference));
  add_joints(then, now, all);
  std::stable_sort(all.begin(), all.end(), [](const Difference& a, const Difference& b) {
    return std::pair(a.kind, a.object) < std::pair(b.kind, b.object);
  });
  return all;
}

Belief renumbered(Belief other, const Belief& here, double within) {
  struct Pair {
    double distance;
    size_t there;
    int64_t here;
  };
  std::vector<Pair> pairs;
  for (size_t i = 0; i < other.objects.size(); ++i)
    for (const BelievedObject& object : here.objects) {
      const BelievedObject& candidate = other.objects[i];
      if (!candidate.position || !object.position || candidate.color != object.color) continue;
      const double distance = (*candidate.position - *object.position).norm();
      if (distance <= within) pairs.push_back({distance, i, object.object});
    }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.distance, a.there, a.here) < std::tie(b.distance, b.there, b.here);
  });
  for (size_t i = 0; i < other.objects.size(); ++i) other.objects[i].object = -1 - static_cast<int64_t>(i);
  std::set<int64_t> taken;
  for (const Pair& pair : pairs)
    if (other.objects[pair.there].object < 0 && taken.insert(pair.here).second)
      other.objects[pair.there].object = pair.here;
  return other;
}

}  // namespace loci::gui
