#include "mapping/interpretation/take_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/convex.h"
#include "mapping/base/json.h"

namespace loci::mapping {
namespace {

enum class Family { none, wall, level, support, front };

Family family_of(const std::string& class_name) {
  if (class_name == "wall") return Family::wall;
  if (class_name == "floor" || class_name == "ceiling") return Family::level;
  for (const char* name : {"counter", "island", "table", "shelf", "cabinet"})
    if (class_name == name) return Family::support;
  for (const char* name : {"front", "drawer", "door", "flap"})
    if (class_name == name) return Family::front;
  return Family::none;
}

/// Something with a name of its own; what belongs to it (handles, sides) is named after it.
struct Thing {
  std::string name;  ///< base name
  const SemanticLink* link = nullptr;
  Family family = Family::none;
};

/// The name without what says which part of a front a link is.
std::string base_of(const std::string& name) {
  for (const char* part : {"_front", "_handle", "_knob", "_left", "_right", "_back", "_bottom"})
    if (name.ends_with(part)) return name.substr(0, name.size() - std::string(part).size());
  return name;
}

std::string base_of(const std::string& name, const SemanticMap& semantics) {
  const auto link = semantics.links.find(name);
  if (link != semantics.links.end()) {
    const Family family = family_of(link->second.class_name);
    if (family != Family::none && family != Family::front) return name;
  }
  return base_of(name);
}

std::vector<Thing> things_of(const SemanticMap& semantics) {
  std::vector<Thing> things;
  for (const auto& [name, link] : semantics.links) {
    const Family family = family_of(link.class_name);
    if (family == Family::none) continue;
    const std::string base = base_of(name, semantics);
    const bool known =
        std::any_of(things.begin(), things.end(), [&](const Thing& t) { return t.name == base; });
    if (!known) things.push_back({base, &link, family});
  }
  return things;
}

Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// 1 for equal planes that share all of the shorter one's length.
double alike_walls(const Json& a, const Json& b) {
  const Vector3d normal = vector_of(a.at("normal"));
  if (normal.dot(vector_of(b.at("normal"))) < 0.985) return 0;
  const Vector3d direction(-normal.y(), normal.x(), 0);
  const auto span = [&](const Json& wall, Vector3d& middle) {
    std::pair<double, double> range{1e9, -1e9};
    middle.setZero();
    for (const Json& corner : wall.at("outline")) {
      const Vector3d at = vector_of(corner);
      range = {std::min(range.first, direction.dot(at)), std::max(range.second, direction.dot(at))};
      middle += at / static_cast<double>(wall.at("outline").size());
    }
    return range;
  };
  Vector3d middle_a, middle_b;
  const auto range_a = span(a, middle_a);
  const auto range_b = span(b, middle_b);
  const double shared = std::min(range_a.second, range_b.second) - std::max(range_a.first, range_b.first);
  const double shorter = std::min(range_a.second - range_a.first, range_b.second - range_b.first);
  const double apart = std::abs(normal.dot(middle_b - middle_a));
  return apart > 0.2 || shorter <= 0 ? 0 : std::max(0.0, shared / shorter) * (1 - apart / 0.2);
}

/// The convex hull of an outline.
Polygon hull_of(const Json& outline) {
  std::vector<cv::Point2f> corners, hull;
  for (const Json& corner : outline)
    corners.emplace_back(corner.at(0).get<float>(), corner.at(1).get<float>());
  cv::convexHull(corners, hull);
  Polygon polygon;
  for (const cv::Point2f& corner : hull)
    polygon.emplace_back(static_cast<double>(corner.x), static_cast<double>(corner.y));
  return polygon;
}

/// Shared area over the area of both, of the convex hulls; less where heights differ.
double alike_surfaces(const Json& a, const Json& b) {
  const double apart = std::abs(a.at("height").get<double>() - b.at("height").get<double>());
  if (apart > 0.1) return 0;
  const Polygon hull_a = hull_of(a.at("outline")), hull_b = hull_of(b.at("outline"));
  const double common = shared_area(hull_a, hull_b);
  const double both = area_of(hull_a) + area_of(hull_b) - common;
  const double overlap = both > 0 ? common / both : 0;
  return overlap < 0.2 ? 0 : overlap * (1 - apart / 0.2);
}

/// 1 for fronts in the same place; 0 when they are more than half a front apart.
double alike_fronts(const Json& a, const Json& b) {
  if (vector_of(a.at("normal")).dot(vector_of(b.at("normal"))) < 0.9) return 0;
  const auto smallest = [](const Json& front) {
    return std::min(front.at("width").get<double>(), front.at("height").get<double>());
  };
  const double far = std::clamp((smallest(a) + smallest(b)) / 4, 0.05, 0.3);
  return std::max(0.0, 1 - (vector_of(a.at("centre")) - vector_of(b.at("centre"))).norm() / far);
}

double alike(const Thing& a, const Thing& b) {
  if (a.family != b.family) return 0;
  const Json& first = a.link->geometry;
  const Json& second = b.link->geometry;
  try {
    if (a.family == Family::wall) return alike_walls(first, second);
    if (a.family == Family::front) return alike_fronts(first, second);
    if (a.family == Family::level) return a.link->class_name == b.link->class_name ? 1 : 0;
    return alike_surfaces(first, second);
  } catch (const Json::exception&) {
    return 0;  // a map that people wrote may lack geometry
  }
}

/// A name of the same kind with a number that is free.
std::string free_name(const std::string& name, const std::set<std::string>& used) {
  if (!used.contains(name)) return name;
  const size_t digits = name.find_last_not_of("0123456789");
  const std::string stem = digits + 1 < name.size() ? name.substr(0, digits + 1) : name + "_";
  for (int number = 1;; ++number) {
    const std::string candidate = stem + std::to_string(number);
    if (!used.contains(candidate)) return candidate;
  }
}

void rename(World& world, SemanticMap& semantics, const std::map<std::string, std::string>& new_names) {
  const SemanticMap before = semantics;
  const auto renamed = [&](const std::string& link) {
    const auto base = new_names.find(base_of(link, before));
    return base == new_names.end() ? link : base->second + link.substr(base->first.size());
  };
  std::map<std::string, std::string> joints;
  for (Joint& joint : world.joints) {
    const std::string old = joint.name;
    if (joint.name == joint.child + "_joint") joint.name = renamed(joint.child) + "_joint";
    joints[old] = joint.name;
    joint.parent = renamed(joint.parent);
    joint.child = renamed(joint.child);
  }
  for (Joint& joint : world.joints)
    if (joint.mimic && joints.contains(joint.mimic->joint)) joint.mimic->joint = joints[joint.mimic->joint];
  for (Link& link : world.links) link.name = renamed(link.name);
  world.root = renamed(world.root);
  semantics.links.clear();
  for (const auto& [name, link] : before.links) semantics.links[renamed(name)] = link;
}

/// Pairs of things that are alike, each in one pair at most, the most alike first.
std::map<size_t, size_t> matches(const std::vector<Thing>& now, const std::vector<Thing>& then) {
  struct Pair {
    double score;
    size_t now, then;
  };
  std::vector<Pair> pairs;
  for (size_t i = 0; i < now.size(); ++i)
    for (size_t j = 0; j < then.size(); ++j)
      if (const double score = alike(now[i], then[j]); score > 0) pairs.push_back({score, i, j});
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.score > b.score; });
  std::map<size_t, size_t> result;
  std::set<size_t> taken;
  for (const Pair& pair : pairs) {
    if (result.contains(pair.now) || taken.contains(pair.then)) continue;
    result[pair.now] = pair.then;
    taken.insert(pair.then);
  }
  return result;
}

}  // namespace

std::string TakenNames::summary() const {
  return fmt::format("{} names kept, {} new, {} gone", kept, added.size(), vanished.size());
}

TakenNames take_names(World& world, SemanticMap& semantics, const SemanticMap& older) {
  const std::vector<Thing> now = things_of(semantics);
  const std::vector<Thing> then = things_of(older);
  const std::map<size_t, size_t> pairs = matches(now, then);
  TakenNames result;
  std::set<std::string> used;
  std::set<std::string> vanished;
  for (const Thing& thing : then) {
    used.insert(thing.name);
    vanished.insert(thing.name);
  }
  std::map<std::string, std::string> new_names;
  for (const auto& [i, j] : pairs) {
    new_names[now[i].name] = then[j].name;
    vanished.erase(then[j].name);
    ++result.kept;
  }
  for (size_t i = 0; i < now.size(); ++i) {
    if (pairs.contains(i)) continue;
    const std::string name = free_name(now[i].name, used);
    used.insert(name);
    new_names[now[i].name] = name;
    result.added.push_back(name);
  }
  result.vanished.assign(vanished.begin(), vanished.end());
  rename(world, semantics, new_names);
  for (auto& [name, link] : semantics.links) {
    const auto before = older.links.find(name);
    if (before == older.links.end()) continue;
    if (link.aliases.empty()) link.aliases = before->second.aliases;
    if (link.appliance.empty()) link.appliance = before->second.appliance;
  }
  return result;
}

}  // namespace loci::mapping
