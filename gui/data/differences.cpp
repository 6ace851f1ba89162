#include "gui/data/differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

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

std::optional<Difference> difference_of(const Belief& belief_then, const BelievedObject* then,
                                        const Belief& belief_now, const BelievedObject* now,
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
  if (then->map_from_object && now->map_from_object)
    difference.distance = (now->map_from_object->translation() - then->map_from_object->translation()).norm();
  if (difference.distance < min_move && difference.then == difference.now) return std::nullopt;
  return difference;
}

std::string joint_text(const JointState& joints, const std::string& name) {
  const auto found = joints.find(name);
  return found == joints.end() ? "" : fmt::format("{:.2f}", found->second);
}

void add_joints(const Belief& then, const Belief& now, std::vector<Difference>& all) {
  for (const auto& [name, position] : now.joints) {
    const auto before = then.joints.find(name);
    const double moved = std::abs(position - (before == then.joints.end() ? 0 : before->second));
    if (moved >= kMinJointMove)
      all.push_back({memory::EventKind::joint_changed, 0, name, joint_text(then.joints, name),
                     joint_text(now.joints, name), moved});
  }
  for (const auto& [name, position] : then.joints)
    if (!now.joints.contains(name) && std::abs(position) >= kMinJointMove)
      all.push_back(
          {memory::EventKind::joint_changed, 0, name, joint_text(then.joints, name), "", std::abs(position)});
}

}  // namespace

std::vector<Difference> differences(const Belief& then, const Belief& now, double min_move) {
  std::vector<Difference> all;
  for (const BelievedObject& object : now.objects)
    if (auto difference = difference_of(then, then.find(object.object), now, &object, min_move))
      all.push_back(std::move(*difference));
  for (const BelievedObject& object : then.objects)
    if (now.find(object.object) == nullptr)
      if (auto difference = difference_of(then, &object, now, nullptr, min_move))
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
      if (!candidate.map_from_object || !object.map_from_object || candidate.color != object.color) continue;
      const double distance =
          (candidate.map_from_object->translation() - object.map_from_object->translation()).norm();
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
