#include "perception/classification/classifier.h"

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "mapping/base/text/base64.h"
#include "mapping/base/text/json.h"
#include "perception/classification/classifier_kinds.h"

namespace loci::perception {
namespace {

constexpr const char* kDistances[] = {"L1", "L2", "chi-squared", "intersection"};

FeatureVector scaled(FeatureVector vector) {
  const float sum = std::accumulate(vector.begin(), vector.end(), 0.0f,
                                    [](float total, float value) { return total + std::abs(value); });
  if (sum > 0)
    for (float& value : vector) value /= sum;
  return vector;
}

FeatureVector product(const Eigen::MatrixXf& matrix, const FeatureVector& vector) {
  if (static_cast<Eigen::Index>(vector.size()) != matrix.cols())
    throw Error("a feature vector is not as long as those that were learned");
  FeatureVector result(static_cast<size_t>(matrix.rows()));
  Eigen::Map<Eigen::VectorXf>(result.data(), matrix.rows()) =
      matrix * Eigen::Map<const Eigen::VectorXf>(vector.data(), matrix.cols());
  return result;
}

/// The inverse of the Cholesky factor of the covariance within the classes.
Eigen::MatrixXf whitening_of(const LabelledVectors& data) {
  const auto size = static_cast<Eigen::Index>(data.vectors.front().size());
  const auto row = [&](size_t i) {
    return Eigen::Map<const Eigen::VectorXf>(data.vectors[i].data(), size).cast<double>();
  };
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(size, static_cast<Eigen::Index>(data.classes));
  std::vector<double> count(data.classes, 0);
  for (size_t i = 0; i < data.vectors.size(); ++i) {
    means.col(static_cast<Eigen::Index>(data.labels[i])) += row(i);
    ++count[data.labels[i]];
  }
  for (size_t c = 0; c < data.classes; ++c) means.col(static_cast<Eigen::Index>(c)) /= count[c];
  Eigen::MatrixXd deviations(size, static_cast<Eigen::Index>(data.vectors.size()));
  for (size_t i = 0; i < data.vectors.size(); ++i)
    deviations.col(static_cast<Eigen::Index>(i)) =
        row(i) - means.col(static_cast<Eigen::Index>(data.labels[i]));
  const auto examples = static_cast<double>(data.vectors.size());
  Eigen::MatrixXd covariance = deviations * deviations.transpose() / examples;
  const double share = static_cast<double>(size) / (static_cast<double>(size) + examples);
  const Eigen::VectorXd variances = covariance.diagonal();
  const double least = 1e-4 * std::max(variances.mean(), 1e-12);  // A value may be the same everywhere.
  covariance *= 1 - share;
  covariance.diagonal() = variances.array() + least;
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  return factor.matrixL().solve(Eigen::MatrixXd::Identity(size, size)).cast<float>();
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
  throw Error("there is no distance " + name, {},
              "there are L1, L2, chi-squared, intersection and Mahalanobis");
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
  table.text("method", method, "Kind of classifier.", {"knn", "svm", "forest", "network"});
  table.text("distance", distance, "Between feature vectors, of knn and the kernel of svm.",
             {"L1", "L2", "chi-squared", "intersection", "Mahalanobis"});
  table.integer("k", k, "", "Neighbours that vote.", 1, 1000);
  table.number("c", c, "", "Cost of an example on the wrong side of a support vector machine.", 1e-3, 1e6);
  table.integer("trees", trees, "", "Trees of a forest.", 1, 10000);
  table.integer("min_split", min_split, "", "Leaves with fewer examples are not split.", 2, 1000);
}

std::vector<double> Classifier::scores(const FeatureVector& vector) const {
  const FeatureVector ready = scaled(vector);
  return scores_of_scaled(whitening_.size() == 0 ? ready : product(whitening_, ready));
}

Json Classifier::to_json() const {
  Json json = kind_to_json();
  if (whitening_.size() == 0) return json;
  std::vector<FeatureVector> rows;
  for (Eigen::Index r = 0; r < whitening_.rows(); ++r) {
    const Eigen::VectorXf row = whitening_.row(r);
    rows.emplace_back(row.data(), row.data() + row.size());
  }
  json["whitening"] = classifier_kinds::vectors_to_json(rows);
  return json;
}

std::unique_ptr<Classifier> train_classifier(const LabelledVectors& data, const ClassifierOptions& options,
                                             const Random& random) {
  check(data);
  LabelledVectors ready{{}, data.labels, data.classes};
  for (const FeatureVector& vector : data.vectors) ready.vectors.push_back(scaled(vector));
  ClassifierOptions kind = options;
  Eigen::MatrixXf whitening;
  if (options.distance == "Mahalanobis" && (options.method == "knn" || options.method == "svm")) {
    kind.distance = name_of(FeatureDistance::l2);
    whitening = whitening_of(ready);
    for (FeatureVector& vector : ready.vectors) vector = product(whitening, vector);
  }
  std::unique_ptr<Classifier> classifier;
  if (options.method == "knn")
    classifier = classifier_kinds::train_neighbours(ready, kind);
  else if (options.method == "svm")
    classifier = classifier_kinds::train_machine(ready, kind);
  else if (options.method == "forest")
    classifier = classifier_kinds::train_forest(ready, kind, random);
  else if (options.method == "network")
    classifier = classifier_kinds::train_network(ready, random);
  else
    throw Error("there is no classifier " + options.method, {}, "there are knn, svm, forest and network");
  classifier->whitening_ = std::move(whitening);
  return classifier;
}

std::unique_ptr<Classifier> classifier_from_json(const Json& json) {
  const std::string method = json.at("method");
  std::unique_ptr<Classifier> classifier;
  if (method == "knn")
    classifier = classifier_kinds::neighbours_from_json(json);
  else if (method == "svm")
    classifier = classifier_kinds::machine_from_json(json);
  else if (method == "forest")
    classifier = classifier_kinds::forest_from_json(json);
  else if (method == "network")
    classifier = classifier_kinds::network_from_json(json);
  else
    throw Error("there is no classifier " + method);
  if (!json.contains("whitening")) return classifier;
  const std::vector<FeatureVector> rows = classifier_kinds::vectors_from_json(json.at("whitening"));
  Eigen::MatrixXf& whitening = classifier->whitening_;
  whitening.resize(static_cast<Eigen::Index>(rows.size()),
                   rows.empty() ? 0 : static_cast<Eigen::Index>(rows[0].size()));
  for (size_t r = 0; r < rows.size(); ++r)
    whitening.row(static_cast<Eigen::Index>(r)) =
        Eigen::Map<const Eigen::RowVectorXf>(rows[r].data(), static_cast<Eigen::Index>(rows[r].size()));
  return classifier;
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
}  // namespace loci::perception
