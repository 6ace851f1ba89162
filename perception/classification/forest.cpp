#include <algorithm>
#include <cmath>
#include <numeric>

#include "mapping/base/json.h"
#include "perception/classification/classifier_kinds.h"

namespace loci::perception::classifier_kinds {
namespace {

/// A question "is value `feature` below `threshold`?", or a leaf. The child for yes comes right after.
struct Node {
  int feature = -1;  ///< -1 = leaf
  float threshold = 0;
  size_t no = 0;              ///< child for the answer no; of a leaf nothing
  std::vector<float> shares;  ///< of the classes, of a leaf
};
using Tree = std::vector<Node>;

class Forest : public Classifier {
 public:
  Forest(std::vector<Tree> trees, size_t classes) : trees_(std::move(trees)), classes_(classes) {}

  Json kind_to_json() const override {
    Json json = {{"method", "forest"}, {"classes", classes_}, {"trees", Json::array()}};
    for (const Tree& tree : trees_) {
      Json nodes = Json::array();
      for (const Node& node : tree) nodes.push_back({node.feature, node.threshold, node.no, node.shares});
      json["trees"].push_back(std::move(nodes));
    }
    return json;
  }

 protected:
  std::vector<double> scores_of_scaled(const FeatureVector& vector) const override {
    std::vector<double> scores(classes_, 0.0);
    for (const Tree& tree : trees_) {
      size_t at = 0;
      while (tree[at].feature >= 0)
        at = vector.at(static_cast<size_t>(tree[at].feature)) < tree[at].threshold ? at + 1 : tree[at].no;
      for (size_t c = 0; c < classes_; ++c)
        scores[c] += static_cast<double>(tree[at].shares[c]) / static_cast<double>(trees_.size());
    }
    return scores;
  }

 private:
  std::vector<Tree> trees_;
  size_t classes_;
};

class Grower {
 public:
  Grower(const LabelledVectors& data, size_t min_split, Random random)
      : data_(data), min_split_(min_split), random_(std::move(random)) {}

  Tree grow() {
    std::vector<size_t> all(data_.vectors.size());
    std::iota(all.begin(), all.end(), size_t{0});
    grow(all.begin(), all.end());
    return std::move(tree_);
  }

 private:
  using Iterator = std::vector<size_t>::iterator;
  struct Split {
    int feature = -1;
    float threshold = 0;
    double impurity = std::numeric_limits<double>::infinity();
  };

  void grow(Iterator first, Iterator last) {
    const size_t at = tree_.size();
    tree_.emplace_back();
    const std::vector<double> count = counted(first, last);
    const auto size = static_cast<size_t>(last - first);
    const bool pure = *std::max_element(count.begin(), count.end()) >= static_cast<double>(size);
    const Split split = pure || size < min_split_ ? Split() : best_split(first, last);
    if (split.feature < 0) {
      for (const double each : count)
        tree_[at].shares.push_back(static_cast<float>(each / static_cast<double>(size)));
      return;
    }
    const Iterator middle = std::stable_partition(first, last, [&](size_t i) { return below(i, split); });
    tree_[at].feature = split.feature;
    tree_[at].threshold = split.threshold;
    grow(first, middle);
    tree_[at].no = tree_.size();
    grow(middle, last);
  }

  float value(size_t example, int feature) const {
    return data_.vectors[example][static_cast<size_t>(feature)];
  }
  bool below(size_t example, const Split& split) const {
    return value(example, split.feature) < split.threshold;
  }

  std::vector<double> counted(Iterator first, Iterator last) const {
    std::vector<double> count(data_.classes, 0.0);
    for (; first != last; ++first) count[data_.labels[*first]] += 1;
    return count;
  }

  /// The best of √d random questions; only values that differ are asked for.
  Split best_split(Iterator first, Iterator last) {
    const size_t length = data_.vectors.front().size();
    const auto wanted = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(length))));
    Split best;
    size_t asked = 0;
    for (size_t attempt = 0; attempt < 4 * length && asked < wanted; ++attempt) {
      Split split;
      split.feature = static_cast<int>(random_.index(length));
      float low = value(*first, split.feature), high = low;
      for (Iterator it = first; it != last; ++it) {
        low = std::min(low, value(*it, split.feature));
        high = std::max(high, value(*it, split.feature));
      }
      if (!(low < high)) continue;
      ++asked;
      split.threshold = low + (high - low) * static_cast<float>(1 - random_.uniform());
      if (!(split.threshold > low)) split.threshold = high;
      split.impurity = impurity(first, last, split);
      if (split.impurity < best.impurity) best = split;
    }
    return best;
  }

  /// Gini's, of both sides together.
  double impurity(Iterator first, Iterator last, const Split& split) const {
    std::vector<double> yes(data_.classes, 0.0), no(data_.classes, 0.0);
    for (; first != last; ++first) (below(*first, split) ? yes : no)[data_.labels[*first]] += 1;
    const auto side = [](const std::vector<double>& count) {
      const double size = std::accumulate(count.begin(), count.end(), 0.0);
      double squares = 0;
      for (const double each : count) squares += each * each;
      return size > 0 ? size - squares / size : 0;
    };
    return side(yes) + side(no);
  }

  const LabelledVectors& data_;
  size_t min_split_;
  Random random_;
  Tree tree_;
};

}  // namespace

std::unique_ptr<Classifier> train_forest(const LabelledVectors& data, const ClassifierOptions& options,
                                         const Random& random) {
  std::vector<Tree> trees;
  for (int i = 0; i < options.trees; ++i)
    trees.push_back(
        Grower(data, static_cast<size_t>(options.min_split), random.fork(static_cast<uint64_t>(i))).grow());
  return std::make_unique<Forest>(std::move(trees), data.classes);
}

std::unique_ptr<Classifier> forest_from_json(const Json& json) {
  const size_t classes = json.at("classes");
  std::vector<Tree> trees;
  for (const Json& nodes : json.at("trees")) {
    Tree& tree = trees.emplace_back();
    for (const Json& node : nodes) tree.push_back({node.at(0), node.at(1), node.at(2), node.at(3)});
    for (size_t i = 0; i < tree.size(); ++i) {
      const bool leaf = tree[i].feature < 0;
      if (leaf ? tree[i].shares.size() != classes : tree[i].no <= i + 1 || tree[i].no >= tree.size())
        throw Error("a tree of the forest is damaged");
    }
    if (tree.empty()) throw Error("a tree of the forest is empty");
  }
  return std::make_unique<Forest>(std::move(trees), classes);
}

}  // namespace loci::perception::classifier_kinds
