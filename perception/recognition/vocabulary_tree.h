#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "perception/recognition/image_features.h"

namespace loci::perception {

/// A vocabulary tree (Nistér and Stewénius, CVPR 2006): descriptors clustered by k-means, each cluster again,
/// until few are left, which are the words. Its leaves hold the numbers of their descriptors, so that it also
/// finds nearest neighbours: the branches whose centres are nearest are looked into first (Muja and Lowe,
/// 2009).
class VocabularyTree {
 public:
  struct Neighbour {
    int distance = 0;  ///< squared
    uint32_t number = 0;
  };

  /// Same descriptors, same tree. `threads` = 0: all cores.
  static VocabularyTree build(std::span<const Descriptor> descriptors, int threads);

  /// The `count` nearest of about `checks` compared descriptors, nearest first; `descriptors` as given to
  /// build().
  std::vector<Neighbour> nearest(const Descriptor& query, std::span<const Descriptor> descriptors,
                                 size_t count, size_t checks) const;

  /// Number of leaves that hold descriptors.
  size_t words() const;

  struct Node {
    Descriptor centre{};
    uint32_t first = 0;  ///< of its children in nodes, or of its descriptors in numbers
    uint32_t count = 0;
    uint32_t is_leaf = 0;
  };
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<uint32_t>& numbers() const { return numbers_; }
  /// The descriptors of each leaf one after the other: what is looked at together then lies together in
  /// memory. Gives for each new number the old one, by which the caller orders the descriptors.
  std::vector<uint32_t> order_by_leaves();
  /// From what a file kept; Error when it contradicts itself.
  static VocabularyTree restore(std::vector<Node> nodes, std::vector<uint32_t> numbers);

 private:
  std::vector<Node> nodes_;  ///< the root first
  std::vector<uint32_t> numbers_;
};

}  // namespace loci::perception
