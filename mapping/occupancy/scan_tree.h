#pragma once

#include <octomap/OcTree.h>

#include <cstdint>
#include <vector>

#include "mapping/occupancy/key_box.h"

namespace loci::mapping::occupancy {

/// An OcTree into which the marks of a scan are written at once: the tree that OctoMap's updateNode would
/// leave after one call per marked cell, in any order, each node touched once and none made that would be
/// pruned again.
class ScanTree : public octomap::OcTree {
 public:
  using octomap::OcTree::OcTree;

  /// `grids` hold marks over the same box, made by several threads; they are cleared on the way. A cell that
  /// any of them marks as hit gets one hit, else one that any marks as passed gets one miss.
  void apply(const KeyBox& box, const std::vector<uint8_t*>& grids, int threads);

 private:
  struct Brick;
  struct Work;
  class Writer;

  std::vector<Brick> marked_bricks(const KeyBox& box, const std::vector<uint8_t*>& grids, int threads) const;
  void open(octomap::OcTreeNode* node, bool fresh, int level, const Brick* begin, const Brick* end,
            std::vector<Work>& work);
  void close(octomap::OcTreeNode* node, int level, const Brick* begin, const Brick* end);
};

}  // namespace loci::mapping::occupancy
