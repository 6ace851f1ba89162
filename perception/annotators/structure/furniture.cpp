#include "perception/annotators/structure/furniture.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/math/cell_index.h"
#include "mapping/world/free_standing.h"
#include "mapping/world/furniture_classes.h"
#include "perception/annotators/segmentation/clustering/convex_parts.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {
namespace {

using mapping::kFreeStanding;

constexpr double kFurnitureSpacing = 0.04;      ///< metres between samples
constexpr size_t kFurnitureMinSamples = 40;     ///< fewer are no furniture
constexpr size_t kFurnitureInterleave = 13;     ///< any prefix of the samples covers the piece
constexpr double kFurnitureReachesTop = 0.15;   ///< metres: what carries a support reaches up to it
constexpr double kFurnitureMaxWallDepth = 0.5;  ///< metres: a box of class "wall" that is thicker is none

/// A topmost link that is seen, with all below it.
struct Branch {
  std::string link, class_name;
  std::vector<std::string> links;
  std::vector<SurfaceSample> samples;  ///< map frame
  std::vector<char> rigid;             ///< of each sample: no joint moves it
};

/// "wall" or "wall_north": maps without a sidecar have names only.
bool is_wall(const std::string& class_name) {
  return class_name.starts_with("wall");
}

/// One can walk around tables and islands; a counter belongs to its row, whether or not the wall behind it is
/// in the map.
bool is_counter(const std::string& class_name) {
  return class_name.starts_with("counter");
}

bool is_of_room(const std::string& class_name) {
  return is_wall(class_name) || class_name.starts_with("floor") || class_name.starts_with("ceiling");
}

/// Both faces of the boxes of a wall.
void add_walls(const mapping::Link& link, const Isometry3d& map_from_link,
               std::vector<mapping::WallRectangle>& walls) {
  for (const mapping::Visual& visual : link.visuals) {
    const auto* box = std::get_if<mapping::Box>(&visual.geometry);
    if (box == nullptr) continue;
    const Isometry3d map_from_box = map_from_link * visual.link_from_visual;
    const int thin = box->size.x() < box->size.y() ? 0 : 1;
    const Vector3d axis = map_from_box.linear().col(thin);
    if (std::abs(axis.z()) > 0.1 || box->size[thin] > kFurnitureMaxWallDepth) continue;
    mapping::WallRectangle wall;
    wall.normal = axis.head<2>().normalized();
    const Vector2d middle = map_from_box.translation().head<2>();
    const double along = middle.dot(Vector2d(-wall.normal.y(), wall.normal.x()));
    wall.along_min = along - box->size[1 - thin] / 2;
    wall.along_max = along + box->size[1 - thin] / 2;
    wall.bottom = map_from_box.translation().z() - box->size.z() / 2;
    wall.top = wall.bottom + box->size.z();
    for (const double side : {-0.5, 0.5}) {
      wall.offset = wall.normal.dot(middle) + side * box->size[thin];
      walls.push_back(wall);
    }
  }
}

/// The topmost link with geometry above a link.
std::string branch_of(const mapping::World& world, std::string link) {
  std::string topmost = link;
  for (const mapping::Joint* joint = world.parent_joint(link); joint != nullptr;
       joint = world.parent_joint(link)) {
    link = joint->parent;
    if (!world.find_link(link)->visuals.empty()) topmost = link;
  }
  return topmost;
}

std::vector<Branch> branches_of(const KnownMap& map, std::vector<mapping::WallRectangle>& walls) {
  const std::vector<Isometry3d> map_from_links = root_from_links(map.world, {});
  const std::vector<bool> moving = moving_links(map.world);
  std::map<std::string, size_t> number;
  std::vector<Branch> branches;
  for (size_t i = 0; i < map.world.links.size(); ++i) {
    const mapping::Link& link = map.world.links[i];
    if (link.visuals.empty()) continue;
    const std::string top = branch_of(map.world, link.name);
    if (is_wall(map.class_of(link.name))) add_walls(link, map_from_links[i], walls);
    if (is_of_room(map.class_of(top))) continue;
    const auto [slot, is_new] = number.try_emplace(top, branches.size());
    if (is_new) branches.push_back({top, map.class_of(top), {}, {}, {}});
    Branch& branch = branches[slot->second];
    branch.links.push_back(link.name);
    std::vector<SurfaceSample> samples;
    for (const mapping::Visual& visual : link.visuals)
      add_surface_samples(visual, map.meshes, kFurnitureSpacing, samples);
    for (const SurfaceSample& sample : samples)
      branch.samples.push_back(
          {map_from_links[i] * sample.point, map_from_links[i].linear() * sample.normal});
    branch.rigid.resize(branch.samples.size(), moving[i] ? 0 : 1);
  }
  return branches;
}

/// Which of some branches touch, as sets.
DisjointSets touching(const std::vector<Branch>& branches, const std::vector<size_t>& chosen) {
  CellIndex cells;
  std::vector<std::vector<size_t>> in_cell;
  for (const size_t b : chosen)
    for (const SurfaceSample& sample : branches[b].samples) {
      const uint32_t cell = cells.insert(cell_of(sample.point, kFreeStanding.link_m));
      in_cell.resize(cells.size());
      if (in_cell[cell].empty() || in_cell[cell].back() != b) in_cell[cell].push_back(b);
    }
  DisjointSets sets(branches.size());
  for (uint32_t c = 0; c < cells.size(); ++c)
    for (int n = 0; n < 27; ++n) {
      const uint32_t other =
          cells.find(cells.cells()[c] + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
      if (other == CellIndex::kNone) continue;
      for (const size_t b : in_cell[other]) sets.join(in_cell[c].front(), b);
    }
  return sets;
}

/// A support of the map and its outline, map frame.
struct Host {
  size_t branch = 0;
  double height = 0;
  Isometry3d top_from_map = Isometry3d::Identity();
  PolygonOutline outline;

  /// Whether a component carries it, or stands on it.
  bool has(const std::vector<const Branch*>& component) const {
    double low = 1e9, high = -1e9;
    size_t within = 0, all = 0;
    for (const Branch* part : component)
      for (const SurfaceSample& sample : part->samples) {
        low = std::min(low, sample.point.z());
        high = std::max(high, sample.point.z());
        ++all;
        const Vector2d at = (top_from_map * sample.point).head<2>();
        within += outline.inside(at) > -kFreeStanding.below_margin_m ? 1 : 0;
      }
    const bool reaches_down = low < height + 2 * kFreeStanding.below_margin_m;
    const bool reaches_up = high > height - kFurnitureReachesTop && height + kFreeStanding.on_top_m > high;
    const double needed = kFreeStanding.below_share * static_cast<double>(all);
    return reaches_down && reaches_up && static_cast<double>(within) > needed;
  }
};

std::vector<Host> hosts_of(const KnownMap& map, const std::vector<Branch>& branches) {
  std::vector<Host> hosts;
  for (size_t b = 0; b < branches.size(); ++b) {
    const std::string& class_name = branches[b].class_name;
    if (!mapping::is_support_class(class_name) || class_name == "cabinet") continue;
    for (const SupportSurface& surface : map.support_surfaces({branches[b].link})) {
      if (surface.link != branches[b].link) continue;
      const Isometry3d map_from_top = map.scene.map_from_link(surface.link_id) * surface.link_from_top;
      hosts.push_back(
          {b, map_from_top.translation().z(), map_from_top.inverse(), PolygonOutline(surface.outline)});
      break;
    }
  }
  return hosts;
}

/// The height at which most of the surface that looks up lies.
double level_of(const std::vector<SurfaceSample>& samples) {
  std::map<long, size_t> counts;
  for (const SurfaceSample& sample : samples)
    if (sample.normal.z() > 0.95) ++counts[std::lround(sample.point.z() * 100)];
  if (counts.empty()) return 0;
  const auto best = std::ranges::max_element(counts, {}, [](const auto& count) { return count.second; });
  return static_cast<double>(best->first) / 100;
}

/// Reordered so that any prefix covers the piece.
std::vector<SurfaceSample> interleaved(const std::vector<SurfaceSample>& samples) {
  std::vector<SurfaceSample> mixed;
  for (size_t first = 0; first < kFurnitureInterleave; ++first)
    for (size_t i = first; i < samples.size(); i += kFurnitureInterleave) mixed.push_back(samples[i]);
  return mixed;
}

/// The piece that some branches are; no samples where it does not stand free.
Furniture piece_of(const std::vector<const Branch*>& parts,
                   const std::vector<mapping::WallRectangle>& walls) {
  Furniture piece;
  std::vector<Eigen::Vector3f> points;
  std::vector<SurfaceSample> rigid, all;
  Eigen::AlignedBox3d box;
  for (const Branch* part : parts) {
    piece.branches.push_back(part->link);
    piece.links.insert(piece.links.end(), part->links.begin(), part->links.end());
    for (size_t i = 0; i < part->samples.size(); ++i) {
      const SurfaceSample& sample = part->samples[i];
      points.push_back(sample.point.cast<float>());
      if (sample.normal.z() < -0.5) continue;  // Nobody looks up at a table from below.
      all.push_back(sample);
      if (part->rigid[i] == 0) continue;
      rigid.push_back(sample);
      box.extend(sample.point);
    }
  }
  piece.name = parts.front()->link;
  if (rigid.size() < kFurnitureMinSamples || !mapping::stands_free(points, walls, true)) return piece;
  piece.middle = box.center();
  piece.radius = box.diagonal().norm() / 2;
  piece.top = level_of(rigid);
  piece.samples = interleaved(rigid);
  piece.closed = interleaved(all);
  return piece;
}

}  // namespace

std::vector<Furniture> movable_furniture(const KnownMap& map) {
  std::vector<mapping::WallRectangle> walls;
  const std::vector<Branch> branches = branches_of(map, walls);
  const std::vector<Host> hosts = hosts_of(map, branches);
  std::vector<std::vector<const Branch*>> parts;  // Of supports first, as they bound what stands below them.
  std::vector<size_t> others;
  for (const Host& host : hosts) parts.push_back({&branches[host.branch]});
  for (size_t b = 0; b < branches.size(); ++b)
    if (std::ranges::none_of(hosts, [&](const Host& host) { return host.branch == b; })) others.push_back(b);
  DisjointSets sets = touching(branches, others);
  std::map<size_t, std::vector<const Branch*>> components;
  for (const size_t b : others) components[sets.find(b)].push_back(&branches[b]);
  for (auto& entry : components) {
    auto& component = entry.second;
    const auto host = std::ranges::find_if(hosts, [&](const Host& one) { return one.has(component); });
    if (host != hosts.end()) {
      auto& piece = parts[static_cast<size_t>(host - hosts.begin())];
      piece.insert(piece.end(), component.begin(), component.end());
    } else {
      // Named by its largest link.
      std::ranges::stable_sort(component, std::greater<>(),
                               [](const Branch* b) { return b->samples.size(); });
      parts.push_back(component);
    }
  }
  std::vector<Furniture> pieces;
  for (const auto& part : parts) {
    if (std::ranges::any_of(part, [](const Branch* branch) { return is_counter(branch->class_name); }))
      continue;
    if (Furniture piece = piece_of(part, walls); !piece.samples.empty()) pieces.push_back(std::move(piece));
  }
  return pieces;
}

mapping::World with_moved(mapping::World world, const std::vector<MovedBranch>& branches) {
  const std::vector<Isometry3d> map_from_links = root_from_links(world, {});
  for (const MovedBranch& branch : branches)
    for (mapping::Joint& joint : world.joints) {
      if (joint.child != branch.link) continue;
      const Isometry3d& map_from_parent = map_from_links[world.link_index(joint.parent)];
      joint.parent_from_joint =
          map_from_parent.inverse() * branch.now_from_before * map_from_parent * joint.parent_from_joint;
    }
  return world;
}

}  // namespace loci::perception
