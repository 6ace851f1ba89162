#include "perception/recognition/vocabulary_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <queue>

#include "mapping/base/error.h"
#include "mapping/base/math/random.h"
#include "mapping/base/parallel.h"

namespace loci::perception {
namespace {

constexpr size_t kBranches = 10;  // As Nistér and Stewénius.
constexpr size_t kLeafSize = 24;
constexpr int kRounds = 8;
constexpr uint64_t kSeed = 1;

using Numbers = std::vector<uint32_t>;

size_t nearest_centre(const Descriptor& descriptor, const std::vector<Descriptor>& centres) {
  size_t best = 0;
  int least = std::numeric_limits<int>::max();
  for (size_t i = 0; i < centres.size(); ++i) {
    const int distance = squared_distance(descriptor, centres[i]);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

Descriptor mean_of(std::span<const Descriptor> descriptors, const Numbers& members) {
  std::array<uint64_t, 128> sum{};
  for (const uint32_t number : members)
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += descriptors[number][i];
  Descriptor mean;
  for (size_t i = 0; i < sum.size(); ++i)
    mean[i] = static_cast<uint8_t>((sum[i] + members.size() / 2) / members.size());
  return mean;
}

/// k-means; clusters that stay empty are left out.
std::vector<Numbers> split(std::span<const Descriptor> descriptors, const Numbers& members, Random random,
                           int threads) {
  std::vector<Descriptor> centres;
  for (size_t i = 0; i < kBranches; ++i)
    centres.push_back(descriptors[members[random.index(members.size())]]);
  std::vector<size_t> cluster(members.size());
  std::vector<Numbers> parts;
  for (int round = 0; round < kRounds; ++round) {
    parallel_for(members.size(), threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) cluster[i] = nearest_centre(descriptors[members[i]], centres);
    });
    parts.assign(centres.size(), {});
    for (size_t i = 0; i < members.size(); ++i) parts[cluster[i]].push_back(members[i]);
    std::erase_if(parts, [](const Numbers& part) { return part.empty(); });
    centres.clear();
    for (const Numbers& part : parts) centres.push_back(mean_of(descriptors, part));
  }
  return parts;
}

}  // namespace

int squared_distance(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const auto difference = static_cast<int16_t>(a[i] - b[i]);
    sum += difference * difference;
  }
  return sum;
}

VocabularyTree VocabularyTree::build(std::span<const Descriptor> descriptors, int threads) {
  VocabularyTree tree;
  Numbers all(descriptors.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<uint32_t>(i);
  tree.nodes_.emplace_back();
  std::vector<Numbers> members = {std::move(all)};  // of each node that is still to be looked at
  const Random random(kSeed);
  for (size_t node = 0; node < tree.nodes_.size(); ++node) {
    const Numbers own = std::move(members[node]);
    std::vector<Numbers> parts;
    if (own.size() > kLeafSize) parts = split(descriptors, own, random.fork(node), threads);
    if (parts.size() < 2) {  // Few, or all the same.
      tree.nodes_[node].is_leaf = 1;
      tree.nodes_[node].first = static_cast<uint32_t>(tree.numbers_.size());
      tree.nodes_[node].count = static_cast<uint32_t>(own.size());
      tree.numbers_.insert(tree.numbers_.end(), own.begin(), own.end());
      continue;
    }
    tree.nodes_[node].first = static_cast<uint32_t>(tree.nodes_.size());
    tree.nodes_[node].count = static_cast<uint32_t>(parts.size());
    for (Numbers& part : parts) {
      tree.nodes_.push_back({mean_of(descriptors, part), 0, 0, 0});
      members.push_back(std::move(part));
    }
  }
  return tree;
}

std::vector<uint32_t> VocabularyTree::order_by_leaves() {
  std::vector<uint32_t> old = numbers_;
  std::iota(numbers_.begin(), numbers_.end(), 0u);
  return old;
}

VocabularyTree VocabularyTree::restore(std::vector<Node> nodes, std::vector<uint32_t> numbers) {
  bool sound = !nodes.empty();
  for (size_t i = 0; i < nodes.size(); ++i) {
    const uint64_t end = uint64_t{nodes[i].first} + nodes[i].count;
    // Children come after their parent: no circles.
    sound = sound && (nodes[i].is_leaf ? end <= numbers.size() : nodes[i].first > i && end <= nodes.size());
  }
  for (const uint32_t number : numbers) sound = sound && number < numbers.size();
  if (!sound) throw Error("the vocabulary tree contradicts itself");
  VocabularyTree tree;
  tree.nodes_ = std::move(nodes);
  tree.numbers_ = std::move(numbers);
  return tree;
}

size_t VocabularyTree::words() const {
  return static_cast<size_t>(std::count_if(nodes_.begin(), nodes_.end(),
                                           [](const Node& node) { return node.is_leaf && node.count > 0; }));
}

std::vector<VocabularyTree::Neighbour> VocabularyTree::nearest(const Descriptor& query,
                                                               std::span<const Descriptor> descriptors,
                                                               size_t count, size_t checks) const {
  std::vector<Neighbour> found;
  const auto nearer = [](const Neighbour& a, const Neighbour& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.number < b.number;
  };
  const auto farther = [&](const Neighbour& a, const Neighbour& b) { return nearer(b, a); };
  std::priority_queue<Neighbour, std::vector<Neighbour>, decltype(farther)> branches(farther);
  if (!nodes_.empty()) branches.push({0, 0});
  while (!branches.empty() && found.size() < checks) {
    uint32_t node = branches.top().number;
    branches.pop();
    while (!nodes_[node].is_leaf) {
      Neighbour best{std::numeric_limits<int>::max(), 0};
      for (uint32_t child = nodes_[node].first; child < nodes_[node].first + nodes_[node].count; ++child) {
        Neighbour other{squared_distance(query, nodes_[child].centre), child};
        if (nearer(other, best)) std::swap(other, best);
        if (other.distance != std::numeric_limits<int>::max()) branches.push(other);
      }
      node = best.number;
    }
    for (uint32_t i = nodes_[node].first; i < nodes_[node].first + nodes_[node].count; ++i)
      found.push_back({squared_distance(query, descriptors[numbers_[i]]), numbers_[i]});
  }
  const size_t kept = std::min(count, found.size());
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept), found.end(), nearer);
  found.resize(kept);
  return found;
}

}  // namespace loci::perception
