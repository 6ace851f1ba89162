#include "perception/classification/classifier.h"

#include <Eigen/Core>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "mapping/base/base64.h"
#include "mapping/base/json.h"
#include "perception/classification/classifier_kinds.h"

namespace loci {
namespace {

constexpr const char* kDistances[] = {"L1", "L2", "chi-squared", "intersection"};

FeatureVector scaled(FeatureVector vector) {
  const float sum = std::accumulate(vector.begin(), vector.end(), 0.0f,
                                    [](float total, float value) { return total + std::abs(value); });
  if (sum > 0)
    for (float& value : vector) value /= sum;
  return vector;
}

void check(const LabelledVectors& data) {
  if (data.vectors.empty() || data.vectors.size() != data.labels.size())
    throw Error("there is nothing to learn from");
  std::vector<size_t> count(data.classes, 0);
  for (const size_t label : data.labels) ++count.at(label);
  for (const size_t each : count)
    if (each == 0) throw Error("a class has no example");
  for (const FeatureVector& vector : data.vectors)
    if (vector.size() != data.vectors.front().size()) throw Error("feature vectors have different lengths");
}

}  // namespace

FeatureDistance feature_distance(const std::string& name) {
  for (int i = 0; i < 4; ++i)
    if (name == kDistances[i]) return static_cast<FeatureDistance>(i);
  throw Error("there is no distance " + name, {}, "there are L1, L2, chi-squared and intersection");
}

std::string name_of(FeatureDistance distance) {
  return kDistances[static_cast<int>(distance)];
}

float distance_between(std::span<const float> a, std::span<const float> b, FeatureDistance distance) {
  const Eigen::Map<const Eigen::ArrayXf> x(a.data(), static_cast<Eigen::Index>(a.size()));
  const Eigen::Map<const Eigen::ArrayXf> y(b.data(), static_cast<Eigen::Index>(b.size()));
  switch (distance) {
    case FeatureDistance::l1:
      return (x - y).abs().sum();
    case FeatureDistance::l2:
      return (x - y).square().sum();
    case FeatureDistance::chi_squared:
      return ((x - y).square() / (x + y).abs().max(std::numeric_limits<float>::min())).sum();
    case FeatureDistance::intersection:
      return 1 - x.min(y).sum();
  }
  return 0;
}

void ClassifierOptions::declare(OptionTable& table) {
  table.text("method", method, "Kind of classifier.", {"knn", "svm", "forest"});
  table.text("distance", distance, "Between feature vectors, of knn and the kernel of svm.",
             {"L1", "L2", "chi-squared", "intersection"});
  table.integer("k", k, "", "Neighbours that vote.", 1, 1000);
  table.number("c", c, "", "Cost of an example on the wrong side of a support vector machine.", 1e-3, 1e6);
  table.integer("trees", trees, "", "Trees of a forest.", 1, 10000);
  table.integer("least_split", least_split, "", "Leaves with fewer examples are not split.", 2, 1000);
}

std::vector<double> Classifier::scores(const FeatureVector& vector) const {
  return scores_of_scaled(scaled(vector));
}

std::unique_ptr<Classifier> train_classifier(const LabelledVectors& data, const ClassifierOptions& options,
                                             const Random& random) {
  check(data);
  LabelledVectors ready{{}, data.labels, data.classes};
  for (const FeatureVector& vector : data.vectors) ready.vectors.push_back(scaled(vector));
  if (options.method == "knn") return classifier_kinds::train_neighbours(ready, options);
  if (options.method == "svm") return classifier_kinds::train_machine(ready, options);
  if (options.method == "forest") return classifier_kinds::train_forest(ready, options, random);
  throw Error("there is no classifier " + options.method, {}, "there are knn, svm and forest");
}

std::unique_ptr<Classifier> classifier_from_json(const Json& json) {
  const std::string method = json.at("method");
  if (method == "knn") return classifier_kinds::neighbours_from_json(json);
  if (method == "svm") return classifier_kinds::machine_from_json(json);
  if (method == "forest") return classifier_kinds::forest_from_json(json);
  throw Error("there is no classifier " + method);
}

namespace classifier_kinds {

Json vectors_to_json(const std::vector<FeatureVector>& vectors) {
  std::string bytes;
  for (const FeatureVector& vector : vectors)
    bytes.append(reinterpret_cast<const char*>(vector.data()), vector.size() * sizeof(float));
  return {{"length", vectors.empty() ? 0 : vectors.front().size()},
          {"count", vectors.size()},
          {"float32", base64_from_bytes(bytes)}};
}

std::vector<FeatureVector> vectors_from_json(const Json& json) {
  const size_t length = json.at("length");
  const size_t count = json.at("count");
  const std::string bytes = bytes_from_base64(json.at("float32").get<std::string>());
  if (length == 0 || bytes.size() / sizeof(float) / length != count ||
      bytes.size() % (length * sizeof(float)) != 0)
    throw Error("feature vectors of a model are not as long as it says");
  std::vector<FeatureVector> vectors(count, FeatureVector(length));
  for (size_t i = 0; i < count; ++i)
    std::memcpy(vectors[i].data(), bytes.data() + i * length * sizeof(float), length * sizeof(float));
  return vectors;
}

}  // namespace classifier_kinds
}  // namespace loci
