#include "perception/annotators/hypotheses/convex_parts.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>

#include "perception/annotators/hypotheses/disjoint_sets.h"

namespace loci {
namespace {

using Eigen::Vector3f;

/// Cell of a regular grid as one sortable number (21 bits an axis).
uint64_t cell_key(const Vector3f& point, float inverse_size) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<int64_t>(std::floor(point[axis] * inverse_size)) + (int64_t{1} << 20);
    key = (key << 21) | (static_cast<uint64_t>(cell) & ((uint64_t{1} << 21) - 1));
  }
  return key;
}

uint64_t key_step(int dx, int dy, int dz) {
  return static_cast<uint64_t>((static_cast<int64_t>(dx) << 42) + (static_cast<int64_t>(dy) << 21) + dz);
}

/// The 13 of the 26 neighbours that come later in order of keys.
std::vector<uint64_t> forward_steps() {
  std::vector<uint64_t> steps;
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dz = -1; dz <= 1; ++dz)
        if (dx > 0 || (dx == 0 && (dy > 0 || (dy == 0 && dz > 0)))) steps.push_back(key_step(dx, dy, dz));
  return steps;
}

struct VoxelGrid {
  std::vector<uint64_t> keys;  ///< sorted
  std::vector<int> voxel_of_point;
  std::vector<std::vector<int>> neighbours;
};

VoxelGrid voxel_grid(const std::vector<Vector3f>& points, float size) {
  VoxelGrid grid;
  std::vector<uint64_t> point_keys(points.size());
  for (size_t i = 0; i < points.size(); ++i) point_keys[i] = cell_key(points[i], 1.0f / size);
  grid.keys = point_keys;
  std::sort(grid.keys.begin(), grid.keys.end());
  grid.keys.erase(std::unique(grid.keys.begin(), grid.keys.end()), grid.keys.end());
  const auto find = [&](uint64_t key) {
    const auto it = std::lower_bound(grid.keys.begin(), grid.keys.end(), key);
    return it != grid.keys.end() && *it == key ? static_cast<int>(it - grid.keys.begin()) : -1;
  };
  grid.voxel_of_point.resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) grid.voxel_of_point[i] = find(point_keys[i]);
  grid.neighbours.resize(grid.keys.size());
  for (const uint64_t step : forward_steps())
    for (size_t v = 0; v < grid.keys.size(); ++v)
      if (const int other = find(grid.keys[v] + step); other >= 0) {
        grid.neighbours[v].push_back(other);
        grid.neighbours[static_cast<size_t>(other)].push_back(static_cast<int>(v));
      }
  return grid;
}

struct Element {
  Vector3f position = Vector3f::Zero();
  Vector3f normal = Vector3f::Zero();
  int count = 0;

  void add(const Vector3f& p, const Vector3f& n) {
    position += p;
    if (n.allFinite()) normal += n;
    ++count;
  }
  void finish() {
    if (count > 0) position /= static_cast<float>(count);
    if (normal.norm() > 1e-6f) normal.normalize();
  }
};

class Patches {
 public:
  Patches(const std::vector<Element>& voxels, const VoxelGrid& grid, float size, float normal_weight)
      : voxels_(voxels), grid_(grid), size_(size), normal_weight_(normal_weight) {
    seed();
    for (int round = 0; round < 3; ++round) {
      grow();
      centre();
    }
  }

  std::vector<int> patch_of_voxel;
  std::vector<Element> patches;

 private:
  /// One voxel per coarse cell, nearest to the mean of what the cell holds.
  void seed() {
    std::map<uint64_t, Element> cells;
    for (const Element& v : voxels_) cells[cell_key(v.position, 1 / size_)].add(v.position, v.normal);
    std::map<uint64_t, std::pair<float, int>> nearest;
    for (auto& [key, cell] : cells) cell.finish();
    for (size_t i = 0; i < voxels_.size(); ++i) {
      const uint64_t key = cell_key(voxels_[i].position, 1 / size_);
      const float distance = (voxels_[i].position - cells[key].position).squaredNorm();
      const auto [it, fresh] = nearest.try_emplace(key, distance, static_cast<int>(i));
      if (!fresh && distance < it->second.first) it->second = {distance, static_cast<int>(i)};
    }
    for (const auto& [key, best] : nearest)
      if (cells[key].count >= 4) patches.push_back(voxels_[static_cast<size_t>(best.second)]);
    seeds_.clear();
    for (const auto& [key, best] : nearest)
      if (cells[key].count >= 4) seeds_.push_back(best.second);
  }

  float distance(const Element& voxel, const Element& patch) const {
    return (voxel.position - patch.position).norm() / size_ +
           normal_weight_ * (voxel.normal - patch.normal).norm();
  }

  void grow() {
    patch_of_voxel.assign(voxels_.size(), -1);
    struct Step {
      float cost;
      int voxel;
      int patch;
      bool operator<(const Step& other) const {
        return std::tie(cost, voxel, patch) > std::tie(other.cost, other.voxel, other.patch);
      }
    };
    std::priority_queue<Step> queue;
    for (size_t p = 0; p < patches.size(); ++p) queue.push({0, seeds_[p], static_cast<int>(p)});
    size_t next_lone = 0;
    while (true) {
      while (!queue.empty()) {
        const Step step = queue.top();
        queue.pop();
        int& owner = patch_of_voxel[static_cast<size_t>(step.voxel)];
        if (owner >= 0) continue;
        owner = step.patch;
        for (const int other : grid_.neighbours[static_cast<size_t>(step.voxel)])
          if (patch_of_voxel[static_cast<size_t>(other)] < 0)
            queue.push(
                {distance(voxels_[static_cast<size_t>(other)], patches[static_cast<size_t>(step.patch)]),
                 other, step.patch});
      }
      // What no seed reaches becomes a patch of its own.
      while (next_lone < voxels_.size() && patch_of_voxel[next_lone] >= 0) ++next_lone;
      if (next_lone == voxels_.size()) return;
      patches.push_back(voxels_[next_lone]);
      seeds_.push_back(static_cast<int>(next_lone));
      queue.push({0, seeds_.back(), static_cast<int>(patches.size()) - 1});
    }
  }

  void centre() {
    std::vector<Element> sums(patches.size());
    for (size_t v = 0; v < voxels_.size(); ++v)
      sums[static_cast<size_t>(patch_of_voxel[v])].add(voxels_[v].position, voxels_[v].normal);
    std::vector<float> best(patches.size(), std::numeric_limits<float>::max());
    for (size_t p = 0; p < patches.size(); ++p) {
      if (sums[p].count == 0) continue;
      sums[p].finish();
      patches[p] = sums[p];
    }
    for (size_t v = 0; v < voxels_.size(); ++v) {
      const auto p = static_cast<size_t>(patch_of_voxel[v]);
      const float d = distance(voxels_[v], patches[p]);
      if (d < best[p]) {
        best[p] = d;
        seeds_[p] = static_cast<int>(v);
      }
    }
  }

  const std::vector<Element>& voxels_;
  const VoxelGrid& grid_;
  float size_;
  float normal_weight_;
  std::vector<int> seeds_;
};

/// Whether the connection of two patches is convex, flat, or only slightly concave, and not merely a touch of
/// two surfaces in a point (the "sanity criterion" of the paper).
bool convex(const Element& a, const Element& b, double concave_deg) {
  const Vector3f apart = (a.position - b.position).normalized();
  const double degrees = 180 / std::numbers::pi;
  const double cosine = std::clamp(static_cast<double>(a.normal.dot(b.normal)), -1.0, 1.0);
  const double angle = std::acos(cosine) * degrees;
  const bool turned_out = a.normal.dot(apart) - b.normal.dot(apart) >= 0;
  if (!turned_out) return angle < concave_deg;
  const Vector3f edge = a.normal.cross(b.normal);
  if (edge.norm() < 1e-3f) return true;
  double skew =
      std::acos(std::clamp(static_cast<double>(std::abs(apart.dot(edge.normalized()))), 0.0, 1.0)) * degrees;
  const double limit = 60.0 / (1.0 + std::exp(-0.25 * (angle - 25.0)));
  return skew >= limit;
}

}  // namespace

void ConvexPartsOptions::declare(OptionTable& table) {
  table.number("voxel_m", voxel_m, "m", "Size of the voxels that patches grow from, at 1 m.", 0.001, 0.1);
  table.number("patch_voxels", patch_voxels, "", "Size of a patch in voxels.", 2, 20);
  table.number("concave_deg", concave_deg, "deg", "An edge that is concave by more separates two things.", 0,
               90);
}

std::vector<int> euclidean_groups(const std::vector<Vector3f>& points, float reach, int& count) {
  const VoxelGrid grid = voxel_grid(points, reach);
  DisjointSets sets(grid.keys.size());
  for (size_t v = 0; v < grid.keys.size(); ++v)
    for (const int other : grid.neighbours[v]) sets.join(v, static_cast<size_t>(other));
  std::vector<int> number(grid.keys.size(), -1);
  std::vector<int> groups(points.size());
  count = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    int& n = number[sets.find(static_cast<size_t>(grid.voxel_of_point[i]))];
    if (n < 0) n = count++;
    groups[i] = n;
  }
  return groups;
}

ConvexParts split_at_concave_edges(const std::vector<Vector3f>& points, const std::vector<Vector3f>& normals,
                                   double scale, const ConvexPartsOptions& options) {
  const auto voxel_size = static_cast<float>(options.voxel_m * scale);
  const VoxelGrid grid = voxel_grid(points, voxel_size);
  std::vector<Element> voxels(grid.keys.size());
  for (size_t i = 0; i < points.size(); ++i)
    voxels[static_cast<size_t>(grid.voxel_of_point[i])].add(points[i], normals[i]);
  for (Element& v : voxels) v.finish();
  const Patches patches(voxels, grid, voxel_size * static_cast<float>(options.patch_voxels),
                        static_cast<float>(options.normal_weight));
  std::map<std::array<int, 2>, int> touching;
  for (size_t v = 0; v < voxels.size(); ++v)
    for (const int other : grid.neighbours[v]) {
      const int a = patches.patch_of_voxel[v];
      const int b = patches.patch_of_voxel[static_cast<size_t>(other)];
      if (a < b) ++touching[{a, b}];
    }
  std::map<std::array<int, 2>, bool> is_convex;
  std::vector<std::vector<int>> joined(patches.patches.size());
  for (const auto& [pair, contact] : touching) {
    const bool yes = convex(patches.patches[static_cast<size_t>(pair[0])],
                            patches.patches[static_cast<size_t>(pair[1])], options.concave_deg);
    is_convex[pair] = yes;
    if (!yes) continue;
    joined[static_cast<size_t>(pair[0])].push_back(pair[1]);
    joined[static_cast<size_t>(pair[1])].push_back(pair[0]);
  }
  for (std::vector<int>& list : joined) std::sort(list.begin(), list.end());
  DisjointSets sets(patches.patches.size());
  for (const auto& [pair, yes] : is_convex) {
    if (!yes) continue;
    if (options.common_neighbour) {
      const auto& a = joined[static_cast<size_t>(pair[0])];
      const auto& b = joined[static_cast<size_t>(pair[1])];
      std::vector<int> common;
      std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
      if (common.empty()) continue;
    }
    sets.join(static_cast<size_t>(pair[0]), static_cast<size_t>(pair[1]));
  }
  ConvexParts parts;
  std::vector<int> number(patches.patches.size(), -1);
  parts.part_of_point.resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const int patch = patches.patch_of_voxel[static_cast<size_t>(grid.voxel_of_point[i])];
    int& n = number[sets.find(static_cast<size_t>(patch))];
    if (n < 0) n = parts.count++;
    parts.part_of_point[i] = n;
  }
  std::map<std::array<int, 2>, int> contacts;
  for (const auto& [pair, contact] : touching) {
    int a = number[sets.find(static_cast<size_t>(pair[0]))];
    int b = number[sets.find(static_cast<size_t>(pair[1]))];
    if (a != b) contacts[{std::min(a, b), std::max(a, b)}] += contact;
  }
  parts.contacts.assign(contacts.begin(), contacts.end());
  return parts;
}

}  // namespace loci
