#include "perception/annotators/segmentation/clustering/convex_parts.h"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <span>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "perception/annotators/segmentation/clustering/color_contrast.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {
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

/// From cells to small numbers: open addressing in a table that is at most half full.
class CellTable {
 public:
  explicit CellTable(size_t most) : slots_(std::bit_ceil(2 * most + 1), {kNone, 0}) {}

  /// The number of a cell; -1 when it has none.
  int find(uint64_t key) const {
    const Slot& slot = slots_[slot_of(key)];
    return slot.key == key ? slot.number : -1;
  }
  /// Gives a cell the number unless it has one. True when it had none.
  bool insert(uint64_t key, int number) {
    Slot& slot = slots_[slot_of(key)];
    if (slot.key == key) return false;
    slot = {key, number};
    return true;
  }

 private:
  static constexpr uint64_t kNone = ~uint64_t{0};  ///< keys have 63 bits
  struct Slot {
    uint64_t key;
    int number;
  };
  size_t slot_of(uint64_t key) const {
    uint64_t hash = key * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
    size_t slot = hash & (slots_.size() - 1);
    while (slots_[slot].key != key && slots_[slot].key != kNone) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }
  std::vector<Slot> slots_;
};

/// The cells that some positions lie in, numbered in order of their keys.
struct Cells {
  std::vector<uint64_t> keys;  ///< sorted
  std::vector<int> cell_of;    ///< by position

  Cells(const std::vector<Vector3f>& points, float size) {
    cell_of.resize(points.size());
    CellTable first(points.size());
    uint64_t last_key = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const uint64_t key = cell_key(points[i], 1.0f / size);
      // Neighbours in the image mostly share a cell.
      if (i > 0 && key == last_key) {
        cell_of[i] = cell_of[i - 1];
        continue;
      }
      if (first.insert(key, static_cast<int>(keys.size()))) keys.push_back(key);
      cell_of[i] = first.find(key);
      last_key = key;
    }
    std::vector<int> order(keys.size()), number(keys.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return keys[static_cast<size_t>(a)] < keys[static_cast<size_t>(b)]; });
    for (size_t i = 0; i < order.size(); ++i) number[static_cast<size_t>(order[i])] = static_cast<int>(i);
    for (int& cell : cell_of) cell = number[static_cast<size_t>(cell)];
    std::sort(keys.begin(), keys.end());
  }
};

struct VoxelGrid {
  Cells cells;
  std::vector<std::array<int, 2>> pairs;  ///< of neighbours (26 around each)
  std::vector<int> neighbours;            ///< of voxel v those from begin[v] to begin[v + 1]
  std::vector<size_t> begin;

  VoxelGrid(const std::vector<Vector3f>& points, float size) : cells(points, size) {
    CellTable table(cells.keys.size());
    for (size_t v = 0; v < cells.keys.size(); ++v) table.insert(cells.keys[v], static_cast<int>(v));
    const std::vector<uint64_t> steps = forward_steps();
    begin.assign(cells.keys.size() + 1, 0);
    for (size_t v = 0; v < cells.keys.size(); ++v)
      for (const uint64_t step : steps)
        if (const int other = table.find(cells.keys[v] + step); other >= 0) {
          pairs.push_back({static_cast<int>(v), other});
          ++begin[v + 1];
          ++begin[static_cast<size_t>(other) + 1];
        }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    neighbours.resize(begin.back());
    std::vector<size_t> next(begin.begin(), begin.end() - 1);
    for (const auto& [a, b] : pairs) {
      neighbours[next[static_cast<size_t>(a)]++] = b;
      neighbours[next[static_cast<size_t>(b)]++] = a;
    }
  }

  std::span<const int> neighbours_of(int voxel) const {
    const auto v = static_cast<size_t>(voxel);
    return std::span(neighbours).subspan(begin[v], begin[v + 1] - begin[v]);
  }
};

struct Element {
  Vector3f position = Vector3f::Zero();
  Vector3f normal = Vector3f::Zero();
  Vector3f lab = Vector3f::Zero();
  int count = 0;

  void add(const Vector3f& p, const Vector3f& n, const Vector3f& color) {
    position += p;
    if (n.allFinite()) normal += n;
    lab += color;
    ++count;
  }
  void finish() {
    if (count > 0) {
      position /= static_cast<float>(count);
      lab /= static_cast<float>(count);
    }
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
    std::vector<Vector3f> positions;
    positions.reserve(voxels_.size());
    for (const Element& v : voxels_) positions.push_back(v.position);
    const Cells coarse(positions, size_);
    std::vector<Element> cells(coarse.keys.size());
    for (size_t i = 0; i < voxels_.size(); ++i)
      cells[static_cast<size_t>(coarse.cell_of[i])].add(voxels_[i].position, voxels_[i].normal,
                                                        voxels_[i].lab);
    for (Element& cell : cells) cell.finish();
    std::vector<std::pair<float, int>> nearest(cells.size(), {std::numeric_limits<float>::max(), -1});
    for (size_t i = 0; i < voxels_.size(); ++i) {
      const auto c = static_cast<size_t>(coarse.cell_of[i]);
      const float distance = (voxels_[i].position - cells[c].position).squaredNorm();
      if (distance < nearest[c].first) nearest[c] = {distance, static_cast<int>(i)};
    }
    for (size_t c = 0; c < cells.size(); ++c) {
      if (cells[c].count < 4) continue;
      patches.push_back(voxels_[static_cast<size_t>(nearest[c].second)]);
      seeds_.push_back(nearest[c].second);
    }
  }

  float distance(const Element& voxel, const Element& patch) const {
    return (voxel.position - patch.position).norm() / size_ +
           normal_weight_ * (voxel.normal - patch.normal).norm();
  }

  struct Step {
    float cost;
    int voxel;
    int patch;
    bool operator<(const Step& other) const {
      if (cost != other.cost) return cost > other.cost;
      return std::pair(voxel, patch) > std::pair(other.voxel, other.patch);
    }
  };

  void grow() {
    patch_of_voxel.assign(voxels_.size(), -1);
    // The cheapest step to a voxel so far: a dearer one would come too late.
    std::vector<std::pair<float, int>> offer(voxels_.size(), {std::numeric_limits<float>::max(), 0});
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
        const Element& patch = patches[static_cast<size_t>(step.patch)];
        for (const int next : grid_.neighbours_of(step.voxel)) {
          const auto other = static_cast<size_t>(next);
          if (patch_of_voxel[other] >= 0) continue;
          const std::pair cost(distance(voxels_[other], patch), step.patch);
          if (cost >= offer[other]) continue;
          offer[other] = cost;
          queue.push({cost.first, next, step.patch});
        }
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
      sums[static_cast<size_t>(patch_of_voxel[v])].add(voxels_[v].position, voxels_[v].normal,
                                                       voxels_[v].lab);
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
bool convex(const Element& a, const Element& b, const ConvexPartsOptions& options) {
  const Vector3f apart = (a.position - b.position).normalized();
  const double degrees = 180 / kPi;
  const double cosine = std::clamp(static_cast<double>(a.normal.dot(b.normal)), -1.0, 1.0);
  const double angle = std::acos(cosine) * degrees;
  const auto turned_out = static_cast<double>(a.normal.dot(apart) - b.normal.dot(apart));
  if (turned_out < 0) return angle < options.concave_deg;
  // Across an edge it is twice the sine of half the angle; where two objects touch they are apart in any
  // direction.
  if (is_other_color(a.lab, b.lab) && turned_out < std::sin(angle / degrees / 2)) return false;
  const Vector3f edge = a.normal.cross(b.normal);
  if (edge.norm() < 1e-3f) return true;
  double skew =
      std::acos(std::clamp(static_cast<double>(std::abs(apart.dot(edge.normalized()))), 0.0, 1.0)) * degrees;
  const double limit = 60.0 / (1.0 + std::exp(-0.25 * (angle - 25.0)));
  return skew >= limit;
}

/// The joined set of each of `members`, numbered in the order in which they come.
std::vector<int> numbered(const std::vector<int>& members, DisjointSets& sets, size_t size, int& count) {
  std::vector<int> number(size, -1), group_of;
  group_of.reserve(members.size());
  count = 0;
  for (const int member : members) {
    int& n = number[sets.find(static_cast<size_t>(member))];
    if (n < 0) n = count++;
    group_of.push_back(n);
  }
  return group_of;
}

}  // namespace

void ConvexPartsOptions::declare(OptionTable& table) {
  table.number("voxel_m", voxel_m, "m", "Voxel size at 1 m.", 0.001, 0.1);
  table.number("patch_voxels", patch_voxels, "", "Size of a patch, in voxels.", 2, 20);
  table.number("concave_deg", concave_deg, "deg", "Minimum concave angle of an edge between two objects.", 0,
               90);
}

std::vector<int> euclidean_groups(const std::vector<Vector3f>& points, float reach, int& count) {
  const VoxelGrid grid(points, reach);
  DisjointSets sets(grid.cells.keys.size());
  for (const auto& [a, b] : grid.pairs) sets.join(static_cast<size_t>(a), static_cast<size_t>(b));
  return numbered(grid.cells.cell_of, sets, grid.cells.keys.size(), count);
}

std::vector<int> join_groups(const std::vector<int>& group_of, const std::vector<int>& pixels,
                             const cv::Size& image, const std::function<bool(int, int)>& goes_on,
                             int& count) {
  constexpr int kMinContact = 3;  // pixels
  cv::Mat shown(image, CV_32S, cv::Scalar(-1));
  for (size_t i = 0; i < pixels.size(); ++i) shown.ptr<int>()[pixels[i]] = group_of[i];
  std::map<std::array<int, 2>, std::array<int, 2>> contacts;  // pairs of pixels: of one surface, of two
  for (size_t i = 0; i < pixels.size(); ++i)
    for (const int other : {pixels[i] + 1, pixels[i] + image.width}) {
      if (other >= image.area() || (other == pixels[i] + 1 && other % image.width == 0)) continue;
      const int group = shown.ptr<int>()[other];
      if (group < 0 || group == group_of[i]) continue;
      ++contacts[{std::min(group, group_of[i]), std::max(group, group_of[i])}]
                [goes_on(pixels[i], other) ? 0 : 1];
    }
  const auto groups = static_cast<size_t>(count);
  DisjointSets sets(groups);
  for (const auto& [pair, contact] : contacts)
    if (contact[0] >= kMinContact && contact[0] > contact[1])
      sets.join(static_cast<size_t>(pair[0]), static_cast<size_t>(pair[1]));
  return numbered(group_of, sets, groups, count);
}

ConvexParts split_at_concave_edges(const std::vector<Vector3f>& points, const std::vector<Vector3f>& normals,
                                   const std::vector<cv::Vec3b>& lab, double scale,
                                   const ConvexPartsOptions& options) {
  const auto voxel_size = static_cast<float>(options.voxel_m * scale);
  const VoxelGrid grid(points, voxel_size);
  const std::vector<int>& voxel_of_point = grid.cells.cell_of;
  std::vector<Element> voxels(grid.cells.keys.size());
  for (size_t i = 0; i < points.size(); ++i)
    voxels[static_cast<size_t>(voxel_of_point[i])].add(points[i], normals[i],
                                                       lab.empty() ? Vector3f::Zero() : lab_vector(lab[i]));
  for (Element& v : voxels) v.finish();
  const Patches patches(voxels, grid, voxel_size * static_cast<float>(options.patch_voxels),
                        static_cast<float>(options.normal_weight));
  std::vector<std::array<int, 2>> borders;
  for (const auto& [v, other] : grid.pairs) {
    const int a = patches.patch_of_voxel[static_cast<size_t>(v)];
    const int b = patches.patch_of_voxel[static_cast<size_t>(other)];
    if (a != b) borders.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(borders.begin(), borders.end());
  std::map<std::array<int, 2>, int> touching;
  for (const auto& pair : borders) ++touching[pair];
  std::map<std::array<int, 2>, bool> is_convex;
  std::vector<std::vector<int>> joined(patches.patches.size());
  for (const auto& [pair, contact] : touching) {
    const bool yes = convex(patches.patches[static_cast<size_t>(pair[0])],
                            patches.patches[static_cast<size_t>(pair[1])], options);
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
    const int patch = patches.patch_of_voxel[static_cast<size_t>(voxel_of_point[i])];
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

std::vector<std::vector<size_t>> members_of(const std::vector<int>& group_of, int count) {
  std::vector<std::vector<size_t>> members(static_cast<size_t>(count));
  for (size_t i = 0; i < group_of.size(); ++i) members[static_cast<size_t>(group_of[i])].push_back(i);
  return members;
}

ConvexParts split_groups(const std::vector<Eigen::Vector3f>& points,
                         const std::vector<Eigen::Vector3f>& normals, const std::vector<cv::Vec3b>& lab,
                         const std::vector<std::vector<size_t>>& groups, const ConvexPartsOptions& options,
                         int threads) {
  std::vector<ConvexParts> of_group(groups.size());
  parallel_each(groups.size(), threads, [&](size_t g) {
    std::vector<Eigen::Vector3f> own_points, own_normals;
    std::vector<cv::Vec3b> own_lab;
    std::vector<float> depths;
    for (const size_t i : groups[g]) {
      own_points.push_back(points[i]);
      own_normals.push_back(normals[i]);
      if (!lab.empty()) own_lab.push_back(lab[i]);
      depths.push_back(points[i].z());
    }
    const auto depth = static_cast<double>(median(std::move(depths)));
    const double scale = std::max(1.0, depth_noise(depth) / depth_noise(1.0));
    of_group[g] = split_at_concave_edges(own_points, own_normals, own_lab, scale, options);
  });
  ConvexParts parts;
  parts.part_of_point.assign(points.size(), -1);
  for (size_t g = 0; g < groups.size(); ++g) {
    const ConvexParts& own = of_group[g];
    for (size_t i = 0; i < groups[g].size(); ++i)
      parts.part_of_point[groups[g][i]] = parts.count + own.part_of_point[i];
    for (const auto& [pair, contact] : own.contacts)
      parts.contacts.push_back({{pair[0] + parts.count, pair[1] + parts.count}, contact});
    parts.count += own.count;
  }
  return parts;
}

}  // namespace loci::perception
