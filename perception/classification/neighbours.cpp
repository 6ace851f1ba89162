#include <algorithm>

#include "mapping/base/json.h"
#include "perception/classification/classifier_kinds.h"

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

}  // namespace loci::perception::classifier_kinds
