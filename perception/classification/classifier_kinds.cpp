#include "perception/classification/classifier_kinds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/ml.hpp>

#include "mapping/base/math/log_odds.h"
#include "mapping/base/text/json.h"

namespace loci::perception::classifier_kinds {
namespace {

class Neighbours : public Classifier {
 public:
  Neighbours(LabelledVectors data, size_t k, FeatureDistance distance)
      : data_(std::move(data)), k_(std::min(k, data_.vectors.size())), distance_(distance) {}

  Json kind_to_json() const override {
    return {{"method", "knn"},
            {"distance", name_of(distance_)},
            {"k", k_},
            {"labels", data_.labels},
            {"classes", data_.classes},
            {"vectors", vectors_to_json(data_.vectors)}};
  }

 protected:
  std::vector<double> scores_of_scaled(const FeatureVector& vector) const override {
    std::vector<std::pair<float, size_t>> near;
    for (size_t i = 0; i < data_.vectors.size(); ++i)
      near.emplace_back(distance_between(vector, data_.vectors[i], distance_), i);
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(k_), near.end());
    std::vector<double> votes(data_.classes, 0.0);
    for (size_t i = 0; i < k_; ++i) votes[data_.labels[near[i].second]] += 1.0 / static_cast<double>(k_);
    return votes;
  }

 private:
  LabelledVectors data_;
  size_t k_;
  FeatureDistance distance_;
};

/// One class against the rest: positive on the side of the class.
struct Machine {
  std::vector<size_t> support;  ///< numbers of vectors
  std::vector<double> weights;
  double offset = 0;
};

class SupportVectors : public Classifier {
 public:
  SupportVectors(std::vector<FeatureVector> vectors, std::vector<Machine> machines, double scale,
                 FeatureDistance distance)
      : vectors_(std::move(vectors)), machines_(std::move(machines)), scale_(scale), distance_(distance) {}

  Json kind_to_json() const override {
    Json json = {{"method", "svm"},
                 {"distance", name_of(distance_)},
                 {"scale", scale_},
                 {"vectors", vectors_to_json(vectors_)},
                 {"machines", Json::array()}};
    for (const Machine& machine : machines_)
      json["machines"].push_back(
          {{"support", machine.support}, {"weights", machine.weights}, {"offset", machine.offset}});
    return json;
  }

 protected:
  std::vector<double> scores_of_scaled(const FeatureVector& vector) const override {
    std::vector<double> kernel;
    for (const FeatureVector& each : vectors_)
      kernel.push_back(std::exp(-static_cast<double>(distance_between(vector, each, distance_)) / scale_));
    std::vector<double> scores;
    for (const Machine& machine : machines_) {
      double side = machine.offset;
      for (size_t i = 0; i < machine.support.size(); ++i)
        side += machine.weights[i] * kernel[machine.support[i]];
      constexpr double kSteepness = 3;  // At the margin, 1 from the boundary, 95 %.
      scores.push_back(probability_from_log_odds(kSteepness * side));
    }
    const double sum = std::accumulate(scores.begin(), scores.end(), 0.0);
    for (double& score : scores) score /= sum;
    return scores;
  }

 private:
  std::vector<FeatureVector> vectors_;
  std::vector<Machine> machines_;
  double scale_;
  FeatureDistance distance_;
};

double mean_distance(const std::vector<FeatureVector>& vectors, FeatureDistance distance) {
  double sum = 0;
  size_t count = 0;
  const size_t step = std::max<size_t>(1, vectors.size() / 200);
  for (size_t i = 0; i < vectors.size(); i += step)
    for (size_t j = i + 1; j < vectors.size(); j += step, ++count)
      sum += static_cast<double>(distance_between(vectors[i], vectors[j], distance));
  return count > 0 && sum > 0 ? sum / static_cast<double>(count) : 1;
}

/// The kernels of all pairs, computed once for all classes. OpenCV sees vectors of one number, which says
/// which vector is meant.
class KnownKernel : public cv::ml::SVM::Kernel {
 public:
  KnownKernel(const std::vector<FeatureVector>& vectors, FeatureDistance distance, double scale)
      : values_(static_cast<int>(vectors.size()), static_cast<int>(vectors.size()), CV_32F) {
    for (int i = 0; i < values_.rows; ++i)
      for (int j = 0; j <= i; ++j) {
        const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j);
        values_.at<float>(i, j) = values_.at<float>(j, i) = static_cast<float>(
            std::exp(-static_cast<double>(distance_between(vectors[a], vectors[b], distance)) / scale));
      }
  }
  int getType() const override { return cv::ml::SVM::CUSTOM; }
  void calc(int count, int /*length*/, const float* numbers, const float* other, float* results) override {
    for (int i = 0; i < count; ++i)
      results[i] = values_.at<float>(static_cast<int>(numbers[i]), static_cast<int>(*other));
  }

 private:
  cv::Mat values_;
};

Machine train_against_rest(const LabelledVectors& data, size_t wanted, double c,
                           const cv::Ptr<KnownKernel>& kernel) {
  const int count = static_cast<int>(data.vectors.size());
  cv::Mat numbers(count, 1, CV_32F), labels(count, 1, CV_32S);
  for (int i = 0; i < count; ++i) {
    numbers.at<float>(i) = static_cast<float>(i);
    labels.at<int>(i) = data.labels[static_cast<size_t>(i)] == wanted ? 0 : 1;
  }
  const auto machine = cv::ml::SVM::create();
  machine->setType(cv::ml::SVM::C_SVC);
  machine->setC(c);
  machine->setCustomKernel(kernel);
  machine->setTermCriteria({cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 20000, 1e-4});
  machine->train(numbers, cv::ml::ROW_SAMPLE, labels);
  Machine trained;
  cv::Mat weights, support;
  trained.offset = -machine->getDecisionFunction(0, weights, support);
  const cv::Mat all = machine->getSupportVectors();
  weights.convertTo(weights, CV_64F);
  for (int i = 0; i < static_cast<int>(support.total()); ++i) {
    trained.support.push_back(static_cast<size_t>(all.at<float>(support.at<int>(i), 0)));
    trained.weights.push_back(weights.at<double>(i));
  }
  return trained;
}

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
  Grower(const LabelledVectors& data, size_t min_split, const Random& random)
      : data_(data), min_split_(min_split), random_(random) {}

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

std::unique_ptr<Classifier> train_neighbours(const LabelledVectors& data, const ClassifierOptions& options) {
  return std::make_unique<Neighbours>(data, static_cast<size_t>(options.k),
                                      feature_distance(options.distance));
}

std::unique_ptr<Classifier> neighbours_from_json(const Json& json) {
  LabelledVectors data{vectors_from_json(json.at("vectors")), json.at("labels"), json.at("classes")};
  if (data.labels.size() != data.vectors.size() ||
      std::any_of(data.labels.begin(), data.labels.end(),
                  [&](size_t label) { return label >= data.classes; }))
    throw Error("labels of a model do not fit its vectors");
  return std::make_unique<Neighbours>(std::move(data), json.at("k"), feature_distance(json.at("distance")));
}

std::unique_ptr<Classifier> train_machine(const LabelledVectors& data, const ClassifierOptions& options) {
  if (data.classes < 2) throw Error("a support vector machine needs two classes");
  const FeatureDistance distance = feature_distance(options.distance);
  const double scale = mean_distance(data.vectors, distance);
  const auto kernel = cv::makePtr<KnownKernel>(data.vectors, distance, scale);
  std::vector<Machine> machines;
  for (size_t wanted = 0; wanted < data.classes; ++wanted)
    machines.push_back(train_against_rest(data, wanted, options.c, kernel));
  // Vectors that support nothing go.
  constexpr size_t kUnused = SIZE_MAX;
  std::vector<size_t> number(data.vectors.size(), kUnused);
  std::vector<FeatureVector> used;
  for (Machine& machine : machines)
    for (size_t& each : machine.support) {
      if (number[each] == kUnused) {
        number[each] = used.size();
        used.push_back(data.vectors[each]);
      }
      each = number[each];
    }
  return std::make_unique<SupportVectors>(std::move(used), std::move(machines), scale, distance);
}

std::unique_ptr<Classifier> machine_from_json(const Json& json) {
  std::vector<FeatureVector> vectors = vectors_from_json(json.at("vectors"));
  std::vector<Machine> machines;
  for (const Json& each : json.at("machines")) {
    machines.push_back({each.at("support"), each.at("weights"), each.at("offset")});
    if (machines.back().support.size() != machines.back().weights.size())
      throw Error("a support vector machine has not as many weights as vectors");
    for (const size_t number : machines.back().support)
      if (number >= vectors.size()) throw Error("a support vector machine lacks a vector");
  }
  return std::make_unique<SupportVectors>(std::move(vectors), std::move(machines), json.at("scale"),
                                          feature_distance(json.at("distance")));
}

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
