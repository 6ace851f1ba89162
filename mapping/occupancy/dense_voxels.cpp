#include "mapping/occupancy/dense_voxels.h"

#include <algorithm>

#include "mapping/base/parallel.h"

namespace loci::mapping::occupancy {
namespace {

using octomap::OcTreeNode;

constexpr float kSurely = 0.99F;  ///< of a single hit's log-odds, less than that is a doubtful voxel
constexpr int kWorkEdge = 64;  ///< subtrees of so many cells along an edge are worked on by one thread each

/// A node with the cells that it stands for.
struct Cube {
  const OcTreeNode* node = nullptr;
  Eigen::Vector3i low = Eigen::Vector3i::Zero();  ///< key of its first cell
  int edge = 0;                                   ///< cells
};

/// Calls task(cube) for the nodes below that are leaves, or no larger than `edge`. OctoMap's own iterators
/// keep a stack on the heap, which takes most of the time when there are a million leaves.
template <class Task>
void descend(const octomap::OcTree& tree, const Cube& cube, int edge, const Task& task) {
  if (cube.edge <= edge || !tree.nodeHasChildren(cube.node)) {
    task(cube);
    return;
  }
  const int half = cube.edge / 2;
  for (unsigned i = 0; i < 8; ++i) {
    if (!tree.nodeChildExists(cube.node, i)) continue;
    const Eigen::Vector3i side(i & 1, i >> 1 & 1, i >> 2 & 1);
    descend(tree, {tree.getNodeChild(cube.node, i), cube.low + half * side, half}, edge, task);
  }
}

template <class Task>
void for_leaves(const octomap::OcTree& tree, const Cube& cube, const Task& task) {
  descend(tree, cube, 1, task);
}

struct KeyBounds {
  Eigen::Array3i low = Eigen::Array3i::Constant(1 << 16), high = Eigen::Array3i::Zero();

  void add(const Cube& cube) {
    low = low.min(cube.low.array());
    high = high.max(cube.low.array() + cube.edge);
  }
  void add(const KeyBounds& other) {
    low = low.min(other.low);
    high = high.max(other.high);
  }
};

}  // namespace

Voxels dense_voxels(const octomap::OcTree& tree, int threads) {
  Voxels voxels;
  voxels.resolution = tree.getResolution();
  if (tree.getRoot() == nullptr) return voxels;
  const int depth = static_cast<int>(tree.getTreeDepth());
  std::vector<Cube> work;
  descend(tree, {tree.getRoot(), Eigen::Vector3i::Zero(), 1 << depth}, kWorkEdge,
          [&](const Cube& cube) { work.push_back(cube); });

  std::vector<KeyBounds> parts(work.size());
  parallel_for(work.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for_leaves(tree, work[i], [&](const Cube& leaf) { parts[i].add(leaf); });
  });
  KeyBounds bounds;
  for (const KeyBounds& part : parts) bounds.add(part);

  voxels.size = bounds.high - bounds.low;
  voxels.low = (bounds.low - (1 << (depth - 1))).cast<double>() * voxels.resolution;
  voxels.states.assign(static_cast<size_t>(voxels.size.x()) * static_cast<size_t>(voxels.size.y()) *
                           static_cast<size_t>(voxels.size.z()),
                       Occupancy::unknown);
  const float doubt = tree.getProbHitLog() * kSurely;
  std::vector<std::vector<size_t>> doubtful(work.size());
  parallel_for(work.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for_leaves(tree, work[i], [&](const Cube& leaf) {
        const Occupancy state = tree.isNodeOccupied(leaf.node) ? Occupancy::occupied : Occupancy::free;
        const Eigen::Vector3i first = leaf.low - bounds.low.matrix();
        const bool is_doubtful = state == Occupancy::occupied && leaf.node->getLogOdds() < doubt;
        for (int z = 0; z < leaf.edge; ++z)
          for (int y = 0; y < leaf.edge; ++y) {
            const size_t row = voxels.index(first + Eigen::Vector3i(0, y, z));
            std::fill_n(voxels.states.begin() + static_cast<long>(row), leaf.edge, state);
            for (int x = 0; is_doubtful && x < leaf.edge; ++x)
              doubtful[i].push_back(row + static_cast<size_t>(x));
          }
      });
  });
  for (const auto& part : doubtful) voxels.doubtful.insert(voxels.doubtful.end(), part.begin(), part.end());
  std::sort(voxels.doubtful.begin(), voxels.doubtful.end());
  return voxels;
}

}  // namespace loci::mapping::occupancy
