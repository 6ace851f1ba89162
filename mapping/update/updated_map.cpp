#include "mapping/update/updated_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/vector_json.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/names.h"
#include "mapping/update/parameters.h"
#include "mapping/update/pieces.h"

namespace loci::mapping {
namespace {

using registration::CellGrid;
using registration::Surfels;

/// Whether a ray crosses the space of furniture that stands there now.
class NewFurniture {
 public:
  explicit NewFurniture(const std::vector<MapChange>& changes) {
    for (const MapChange& change : changes)
      if (change.kind == MapChange::Kind::moved || change.kind == MapChange::Kind::came)
        columns_.push_back({change.outline_now, change.height});
  }

  bool crossed(const Vector3d& from, const Vector3d& to) const {
    return std::ranges::any_of(columns_, [&](const Column& column) { return crosses(column, from, to); });
  }

 private:
  struct Column {
    std::vector<Vector2d> outline;
    double height = 0;
  };

  /// Steps along the ray: outlines are large against them.
  static bool crosses(const Column& column, const Vector3d& from, const Vector3d& to) {
    Eigen::AlignedBox2d box;
    for (const Vector2d& corner : column.outline) box.extend(corner);
    const Eigen::AlignedBox2d way(from.head<2>().cwiseMin(to.head<2>()),
                                  from.head<2>().cwiseMax(to.head<2>()));
    if (!box.intersects(way) || std::min(from.z(), to.z()) > column.height) return false;
    const int steps = std::max(1, static_cast<int>((to - from).norm() / 0.1));
    for (int i = 0; i <= steps; ++i) {
      const Vector3d p = from + (to - from) * (static_cast<double>(i) / steps);
      if (p.z() < column.height && box.contains(Vector2d(p.head<2>())) &&
          inside(column.outline, p.head<2>(), 0))
        return true;
    }
    return false;
  }

  std::vector<Column> columns_;
};

void append(const EpochScans& epoch, const std::string& prefix, const NewFurniture* furniture, ScanSet& all) {
  for (const Scan& scan : epoch.scans.scans) {
    Scan kept = scan;
    kept.name = prefix + scan.name;
    std::erase_if(kept.points, [&](const ScanPoint& point) {
      const Vector3d p = scan.map_from_scan * point.position.cast<double>();
      if (point.returned) {
        const uint32_t i = epoch.surface.grid.find(cell_of(p, epoch.surface.cell));
        if (i != CellGrid::kNone && epoch.dropped[i] != 0) return true;
      }
      if (furniture == nullptr || scan.origins.empty()) return false;
      const size_t origin = std::min<size_t>(point.origin_index, scan.origins.size() - 1);
      return furniture->crossed(scan.map_from_scan * scan.origins[origin].cast<double>(), p);
    });
    all.scans.push_back(std::move(kept));
  }
}

Vector3d point_of(const Json& json, double z) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.size() > 2 ? json.at(2).get<double>() : z};
}

/// Moves the geometry of a sidecar entry in the map frame.
void move_geometry(Json& geometry, const Isometry3d& now_from_before) {
  if (!geometry.is_object()) return;
  for (const char* key : {"normal", "up", "axis"})
    if (geometry.contains(key))
      geometry[key] = json_from_vector(now_from_before.linear() * point_of(geometry[key], 0));
  if (geometry.contains("centre"))
    geometry["centre"] = json_from_vector(now_from_before * point_of(geometry["centre"], 0));
  if (!geometry.contains("outline")) return;
  for (Json& corner : geometry["outline"]) {
    const Vector3d moved = now_from_before * point_of(corner, 0);
    for (size_t i = 0; i < corner.size(); ++i) corner[i] = moved[static_cast<int>(i)];
  }
}

/// A link and all below it.
std::set<std::string> subtree(const World& world, const std::string& link) {
  std::set<std::string> names = {link};
  for (bool grown = true; grown;) {
    grown = false;
    for (const Joint& joint : world.joints)
      if (names.contains(joint.parent) && names.insert(joint.child).second) grown = true;
  }
  return names;
}

/// The link of a branch that hangs on the root.
std::string branch_of(const World& world, std::string link) {
  for (const Joint* joint = world.parent_joint(link); joint != nullptr && joint->parent != world.root;
       joint = world.parent_joint(link))
    link = joint->parent;
  return link;
}

/// A map that changes link by link.
class MapEditor {
 public:
  MapEditor(const World& world, const SemanticMap& semantics) : world_(world), semantics_(semantics) {}

  /// Moves or removes the branches of a piece's links.
  void apply(const MapChange& change) {
    std::set<std::string> branches;
    for (const std::string& link : change.links)
      if (world_.find_link(link) != nullptr) branches.insert(branch_of(world_, link));
    for (const std::string& branch : branches) {
      const std::set<std::string> names = subtree(world_, branch);
      if (change.kind == MapChange::Kind::gone) {
        remove(names);
        continue;
      }
      for (Joint& joint : world_.joints)
        if (joint.child == branch) joint.parent_from_joint = change.now_from_before * joint.parent_from_joint;
      for (const std::string& name : names) {
        const auto link = semantics_.links.find(name);
        if (link == semantics_.links.end()) continue;
        move_geometry(link->second.geometry, change.now_from_before);
        if (name == branch) link->second.evidence["moved"] = change.text();
      }
    }
  }

  /// Takes over a link with all below it from another map.
  void add(const std::string& branch, const World& world, const SemanticMap& semantics) {
    const std::set<std::string> names = subtree(world, branch);
    for (const Link& link : world.links)
      if (names.contains(link.name)) world_.links.push_back(link);
    for (const Joint& joint : world.joints) {
      if (!names.contains(joint.child)) continue;
      world_.joints.push_back(joint);
      if (joint.child == branch) world_.joints.back().parent = world_.root;
    }
    for (const std::string& name : names)
      if (const auto link = semantics.links.find(name); link != semantics.links.end())
        semantics_.links[name] = link->second;
  }

  /// Writes a branch anew from another map: what people said of it stays.
  void replace(const std::string& branch, const World& world, const SemanticMap& semantics) {
    const SemanticMap old = semantics_;
    remove(subtree(world_, branch));
    add(branch, world, semantics);
    for (auto& [name, link] : semantics_.links)
      if (const auto before = old.links.find(name); before != old.links.end()) {
        if (link.aliases.empty()) link.aliases = before->second.aliases;
        if (link.appliance.empty()) link.appliance = before->second.appliance;
      }
  }

  void remove(const std::set<std::string>& names) {
    std::erase_if(world_.links, [&](const Link& link) { return names.contains(link.name); });
    std::erase_if(world_.joints, [&](const Joint& joint) { return names.contains(joint.child); });
    for (const std::string& name : names) semantics_.links.erase(name);
  }

  World& world() { return world_; }
  SemanticMap& semantics() { return semantics_; }

 private:
  World world_;
  SemanticMap semantics_;
};

/// Share of the new surface on a link's face that the old map does not explain; 0 where little was seen.
double unexplained_share(const SemanticLink& link, const Surfels& now,
                         const std::vector<uint8_t>& unexplained) {
  const Json& g = link.geometry;
  size_t on = 0, fresh = 0;
  const bool plate = g.contains("outline") && g.contains("height") && !g.contains("normal");
  const bool face = g.contains("centre") && g.contains("normal") && g.contains("width");
  std::vector<Vector2d> outline;
  if (plate)
    for (const Json& corner : g.at("outline")) outline.push_back(point_of(corner, 0).head<2>());
  for (size_t i = 0; i < now.size(); ++i) {
    const Vector3d p = now.position[i].cast<double>();
    bool hit = false;
    if (plate) {
      hit = std::abs(p.z() - g.at("height").get<double>()) < kChanges.front_gap_m &&
            inside(outline, p.head<2>(), 0);
    } else if (face) {
      const Vector3d d = p - point_of(g.at("centre"), 0), normal = point_of(g.at("normal"), 0),
                     up = point_of(g.at("up"), 0);
      hit = std::abs(d.dot(normal)) < kChanges.front_gap_m &&
            std::abs(d.dot(up)) < g.at("height").get<double>() / 2 &&
            std::abs(d.dot(up.cross(normal))) < g.at("width").get<double>() / 2;
    }
    if (!hit) continue;
    ++on;
    fresh += unexplained[i];
  }
  return on < kPieces.min_surfels ? 0 : static_cast<double>(fresh) / static_cast<double>(on);
}

bool is_interacted(const SemanticLink& link) {
  return link.extra.is_object() && link.extra.value("joint_evidence", std::string("prior")) != "prior";
}

}  // namespace

ScanSet current_scans(const EpochScans& before, const EpochScans& now,
                      const std::vector<MapChange>& changes) {
  ScanSet all = before.scans;
  all.scans.clear();
  const NewFurniture furniture(changes);
  append(before, "", &furniture, all);
  int number = 1;
  const auto used = [&](const std::string& prefix) {
    return std::ranges::any_of(before.scans.scans,
                               [&](const Scan& scan) { return scan.name.starts_with(prefix); });
  };
  while (used(fmt::format("update{}_", number))) ++number;
  append(now, fmt::format("update{}_", number), nullptr, all);
  return all;
}

InterpretedMap updated_map(const World& world, const SemanticMap& semantics, const Surfels& now,
                           const std::vector<uint8_t>& unexplained, const UpdateResult& result, int threads,
                           Progress& progress) {
  MapEditor editor(world, semantics);
  Json& pieces = editor.semantics().extra["pieces"];
  if (!pieces.is_object()) pieces = Json::object();
  for (const MapChange& change : result.changes) {
    if (change.kind == MapChange::Kind::opened) continue;
    if (change.kind == MapChange::Kind::moved || change.kind == MapChange::Kind::gone) editor.apply(change);
    if (!change.links.empty()) continue;
    pieces.erase(change.name);
    if (change.kind == MapChange::Kind::gone) continue;
    const Vector3d centre = change.kind == MapChange::Kind::moved
                                ? Vector3d(change.now_from_before * change.centre)
                                : change.centre;
    pieces[change.name] = {
        {"class", change.class_name}, {"centre", json_from_vector(centre)}, {"height", change.height}};
  }
  InterpretationOptions options;
  options.threads = threads;
  InterpretedMap map = interpret(result.scans, options, progress);
  transfer_names(map.world, map.semantics, editor.semantics());
  for (const auto& [name, link] : map.semantics.links) {
    const Joint* joint = map.world.parent_joint(name);
    if (joint == nullptr || joint->parent != map.world.root) continue;
    const auto old = editor.semantics().links.find(name);
    if (old == editor.semantics().links.end()) {
      if (unexplained_share(link, now, unexplained) > kChanges.min_new_share)
        editor.add(name, map.world, map.semantics);
    } else if (link.class_name == old->second.class_name && !is_interacted(old->second) &&
               link.confidence > old->second.confidence + kChanges.refresh_confidence) {
      editor.replace(name, map.world, map.semantics);
    }
  }
  map.world = editor.world();
  map.semantics = editor.semantics();
  map.fronts = fronts_of(map.world, map.semantics);
  return map;
}

}  // namespace loci::mapping
