#include "mapping/occupancy/scan_tree.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "mapping/base/parallel.h"

namespace loci::mapping::occupancy {

using octomap::OcTreeNode;

namespace {

constexpr int kBrickLevel = 3;  ///< a brick is a node three levels above the cells
constexpr int kWorkLevel = 5;   ///< subtrees of 32 cells are written by one thread each
constexpr int kBrickCells = kBrick * kBrick * kBrick;

using Marks = std::array<uint8_t, kBrickCells>;  ///< of a brick in Morton order

/// Bits of a number with two zeros between them.
constexpr uint64_t spread(uint64_t value) {
  uint64_t result = 0;
  for (int bit = 0; bit < 16; ++bit) result |= (value >> bit & 1) << (3 * bit);
  return result;
}

uint64_t load(const uint8_t* bytes) {
  uint64_t value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

}  // namespace

/// A brick with marks. Its code is the path through the tree, three bits per level, root first.
struct ScanTree::Brick {
  uint64_t code = 0;
  size_t address = 0;  ///< of its first cell in the grids

  unsigned child(int level) const { return code >> (3 * (level - 1 - kBrickLevel)) & 7; }
};

/// A subtree to write.
struct ScanTree::Work {
  OcTreeNode* node = nullptr;
  bool fresh = false;  ///< just created: it says nothing yet (otherwise a node without children is a leaf)
  const Brick* begin = nullptr;
  const Brick* end = nullptr;
};

namespace {

/// Bricks below each child of a node: they are sorted by code, so that each child's are together.
template <class Brick, class Task>
void for_children(const Brick* begin, const Brick* end, int level, const Task& task) {
  while (begin != end) {
    const unsigned child = begin->child(level);
    const Brick* next = std::find_if(begin, end, [&](const Brick& b) { return b.child(level) != child; });
    task(child, begin, next);
    begin = next;
  }
}

}  // namespace

/// Writes subtrees. Its base is a tree of its own that lends createNodeChild and its like, and counts the
/// nodes that come and go, so that several can work on one tree.
class ScanTree::Writer : public octomap::OcTree {
 public:
  Writer(const ScanTree& tree, const KeyBox& box, const std::vector<uint8_t*>& grids)
      : OcTree(tree.getResolution()), tree_(tree), box_(box), grids_(grids) {}

  long grown() const { return static_cast<long>(tree_size); }

  void write(OcTreeNode* node, bool fresh, int level, const Brick* begin, const Brick* end) {
    if (level == kBrickLevel) {
      take_marks(begin->address);
      write_cells(node, fresh, kBrickLevel, 0);
      return;
    }
    for_children(begin, end, level, [&](unsigned child, const Brick* from, const Brick* to) {
      const bool created = provide_child(*this, node, fresh, child);
      write(getNodeChild(node, child), created, level - 1, from, to);
    });
    if (!pruneNode(node)) node->updateOccupancyChildren();
  }

  /// Makes sure that a child exists: creates it, or expands the leaf that it is part of. True: it is new.
  static bool provide_child(OcTree& tree, OcTreeNode* node, bool& fresh, unsigned child) {
    if (tree.nodeChildExists(node, child)) return false;
    const bool leaf = !fresh && !tree.nodeHasChildren(node);
    fresh = false;
    if (leaf)
      tree.expandNode(node);
    else
      tree.createNodeChild(node, child);
    return !leaf;
  }

 private:
  /// Marks of a brick from all grids, in Morton order; clears them there.
  void take_marks(size_t address) {
    static constexpr std::array<uint16_t, kBrick> kSpread = [] {
      std::array<uint16_t, kBrick> table{};
      for (size_t i = 0; i < kBrick; ++i) table[i] = static_cast<uint16_t>(spread(i));
      return table;
    }();
    const Eigen::Vector3i strides = box_.strides();
    for (int z = 0; z < kBrick; ++z)
      for (int y = 0; y < kBrick; ++y) {
        const size_t row = address + static_cast<size_t>(y * strides.y() + z * strides.z());
        uint64_t marks = 0;
        for (uint8_t* grid : grids_) {
          marks |= load(grid + row);
          std::memset(grid + row, 0, kBrick);
        }
        std::array<uint8_t, kBrick> cells;
        std::memcpy(cells.data(), &marks, sizeof marks);
        const size_t yz = kSpread[static_cast<size_t>(y)] << 1 | kSpread[static_cast<size_t>(z)] << 2;
        for (size_t x = 0; x < kBrick; x += 2) std::memcpy(&marks_[yz | kSpread[x]], &cells[x], 2);
      }
  }

  float updated(float value, uint8_t mark) const {
    const float sum = value + ((mark & kHit) != 0 ? tree_.prob_hit_log : tree_.prob_miss_log);
    return std::min(std::max(sum, tree_.clamping_thres_min), tree_.clamping_thres_max);
  }

  /// A node over the marks [first, first + 8^level) of the brick; at least one of them is set.
  void write_cells(OcTreeNode* node, bool fresh, int level, size_t first) {
    const size_t count = size_t{1} << (3 * level);
    if (!nodeHasChildren(node) && uniform(first, count)) {
      node->setLogOdds(updated(fresh ? 0.F : node->getLogOdds(), marks_[first]));
      return;
    }
    if (level == 1) {
      write_leaves(node, fresh, first);
      return;
    }
    for (unsigned child = 0; child < 8; ++child) {
      const size_t begin = first + child * count / 8;
      if (!any(begin, count / 8)) continue;
      const bool created = provide_child(*this, node, fresh, child);
      write_cells(getNodeChild(node, child), created, level - 1, begin);
    }
    if (!pruneNode(node)) node->updateOccupancyChildren();
  }

  void write_leaves(OcTreeNode* node, bool fresh, size_t first) {
    std::array<float, 8> values;
    std::array<bool, 8> known;
    const bool parent = nodeHasChildren(node);
    bool equal = true;
    for (unsigned i = 0; i < 8; ++i) {
      const bool child = parent && nodeChildExists(node, i);
      known[i] = child || (!parent && !fresh);
      values[i] = child ? getNodeChild(node, i)->getLogOdds() : known[i] ? node->getLogOdds() : 0.F;
      if (const uint8_t mark = marks_[first + i]; mark != 0) {
        values[i] = updated(values[i], mark);
        known[i] = true;
      }
      equal = equal && known[i] && values[i] == values[0];
    }
    if (equal && !parent) {
      node->setLogOdds(values[0]);
      return;
    }
    for (unsigned i = 0; i < 8; ++i)
      if (known[i])
        (parent && nodeChildExists(node, i) ? getNodeChild(node, i) : createNodeChild(node, i))
            ->setLogOdds(values[i]);
    if (!pruneNode(node)) node->updateOccupancyChildren();
  }

  bool any(size_t first, size_t count) const {
    uint64_t bits = 0;
    for (size_t i = 0; i < count; i += 8) bits |= load(&marks_[first + i]);
    return bits != 0;
  }
  /// Whether all cells get the same update (hits count as such whether passed or not).
  bool uniform(size_t first, size_t count) const {
    const uint64_t marks = load(&marks_[first]);
    const bool misses = marks == 0x0101010101010101;
    if (!misses && (marks & 0x0202020202020202) != 0x0202020202020202) return false;
    for (size_t i = 8; i < count; i += 8) {
      const uint64_t others = load(&marks_[first + i]);
      if (misses ? others != marks : (others & 0x0202020202020202) != 0x0202020202020202) return false;
    }
    return true;
  }

  const ScanTree& tree_;
  const KeyBox& box_;
  const std::vector<uint8_t*>& grids_;
  Marks marks_{};
};

std::vector<ScanTree::Brick> ScanTree::marked_bricks(const KeyBox& box, const std::vector<uint8_t*>& grids,
                                                     int threads) const {
  const Eigen::Vector3i count = box.size / kBrick, strides = box.strides();
  std::vector<std::vector<Brick>> layers(static_cast<size_t>(count.z()));
  parallel_for(layers.size(), threads, [&](size_t begin, size_t end) {
    std::vector<uint64_t> row(static_cast<size_t>(count.x()));
    for (size_t z = begin; z < end; ++z)
      for (int y = 0; y < count.y(); ++y) {
        const size_t first =
            (z * static_cast<size_t>(strides.z()) + static_cast<size_t>(y * strides.y())) * kBrick;
        std::fill(row.begin(), row.end(), 0);
        for (const uint8_t* grid : grids)
          for (int inner = 0; inner < kBrick * kBrick; ++inner) {
            const uint8_t* cells =
                grid + first +
                static_cast<size_t>(inner % kBrick * strides.y() + inner / kBrick * strides.z());
            for (size_t x = 0; x < row.size(); ++x) row[x] |= load(cells + x * kBrick);
          }
        for (size_t x = 0; x < row.size(); ++x) {
          if (row[x] == 0) continue;
          const Eigen::Vector3i brick =
              box.low / kBrick + Eigen::Vector3i(static_cast<int>(x), y, static_cast<int>(z));
          layers[z].push_back({spread(static_cast<uint64_t>(brick.x())) |
                                   spread(static_cast<uint64_t>(brick.y())) << 1 |
                                   spread(static_cast<uint64_t>(brick.z())) << 2,
                               first + x * kBrick});
        }
      }
  });
  std::vector<Brick> bricks;
  for (const auto& layer : layers) bricks.insert(bricks.end(), layer.begin(), layer.end());
  std::sort(bricks.begin(), bricks.end(), [](const Brick& a, const Brick& b) { return a.code < b.code; });
  return bricks;
}

/// Goes down to the subtrees that have work, creating the way.
void ScanTree::open(OcTreeNode* node, bool fresh, int level, const Brick* begin, const Brick* end,
                    std::vector<Work>& work) {
  if (level == kWorkLevel) {
    work.push_back({node, fresh, begin, end});
    return;
  }
  for_children(begin, end, level, [&](unsigned child, const Brick* from, const Brick* to) {
    const bool created = Writer::provide_child(*this, node, fresh, child);
    open(getNodeChild(node, child), created, level - 1, from, to, work);
  });
}

/// Prunes and updates the nodes above the subtrees.
void ScanTree::close(OcTreeNode* node, int level, const Brick* begin, const Brick* end) {
  if (level == kWorkLevel) return;
  for_children(begin, end, level, [&](unsigned child, const Brick* from, const Brick* to) {
    close(getNodeChild(node, child), level - 1, from, to);
  });
  if (!pruneNode(node)) node->updateOccupancyChildren();
}

void ScanTree::apply(const KeyBox& box, const std::vector<uint8_t*>& grids, int threads) {
  const std::vector<Brick> bricks = marked_bricks(box, grids, threads);
  if (bricks.empty()) return;
  const bool fresh = root == nullptr;
  if (fresh) {
    root = new OcTreeNode();
    ++tree_size;
  }
  const int height = static_cast<int>(tree_depth);
  const Brick* begin = bricks.data();
  const Brick* end = begin + bricks.size();
  std::vector<Work> work;
  open(root, fresh, height, begin, end, work);
  std::vector<long> grown(work.size(), 0);
  parallel_for(work.size(), threads, [&](size_t first, size_t last) {
    Writer writer(*this, box, grids);
    long before = 0;
    for (size_t i = first; i < last; ++i) {
      writer.write(work[i].node, work[i].fresh, kWorkLevel, work[i].begin, work[i].end);
      grown[i] = writer.grown() - before;
      before = writer.grown();
    }
  });
  for (const long nodes : grown) tree_size = static_cast<size_t>(static_cast<long>(tree_size) + nodes);
  size_changed = true;
  close(root, height, begin, end);
}

}  // namespace loci::mapping::occupancy
