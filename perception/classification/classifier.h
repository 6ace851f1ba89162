#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/options.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::perception {

/// One feature vector.
using FeatureVector = std::vector<float>;

/// How far two feature vectors are apart: "L1", "L2" (squared), "chi-squared" (Σ (a-b)²/(a+b)) or
/// "intersection" (1 - Σ min(a, b)). Error for other names. Vectors have the same length.
enum class FeatureDistance { l1, l2, chi_squared, intersection };
FeatureDistance feature_distance(const std::string& name);
std::string name_of(FeatureDistance distance);
float distance_between(std::span<const float> a, std::span<const float> b, FeatureDistance distance);

struct ClassifierOptions {
  std::string method = "svm";
  std::string distance = "chi-squared";
  int k = 10;
  double c = 10;
  int trees = 100;
  int min_split = 4;

  void declare(OptionTable& table);
};

/// Vectors of one kind, and which class each belongs to: 0 to `classes` - 1.
struct LabelledVectors {
  std::vector<FeatureVector> vectors;
  std::vector<size_t> labels;
  size_t classes = 0;
};

/// Scores one feature vector. Vectors are scaled to sum 1 before they are learned or scored: descriptors are
/// histograms, and the number of points does not count. With the distance "Mahalanobis" they are whitened
/// then: the squared Euclidean distance of what comes out is the Mahalanobis distance by the covariance
/// within the classes, in which correlations count the less, the fewer examples there are for its size.
class Classifier {
 public:
  virtual ~Classifier() = default;
  /// One score per class, from 0 to 1, that sum to 1: shares of votes, not probabilities yet (see Ensemble).
  std::vector<double> scores(const FeatureVector& vector) const;
  Json to_json() const;

 protected:
  virtual std::vector<double> scores_of_scaled(const FeatureVector& vector) const = 0;
  virtual Json kind_to_json() const = 0;

 private:
  friend std::unique_ptr<Classifier> train_classifier(const LabelledVectors& data,
                                                      const ClassifierOptions& options, const Random& random);
  friend std::unique_ptr<Classifier> classifier_from_json(const Json& json);

  Eigen::MatrixXf whitening_;  ///< empty: vectors stay as they are
};

/// Trains one of
///
///   knn     the share of the k nearest neighbours that is of the class
///   svm     one support vector machine per class against the rest (OpenCV trains it) with the kernel
///           exp(-distance / mean distance); the logistic function of how far on the class's side a vector is
///   forest  extremely randomised trees (Geurts et al. 2006): the mean share of the class in the leaves
///   network one hidden layer (96 units), softmax; the smallest files
///
/// Error when a class has no vector or lengths differ.
std::unique_ptr<Classifier> train_classifier(const LabelledVectors& data, const ClassifierOptions& options,
                                             const Random& random);

/// What to_json() wrote.
std::unique_ptr<Classifier> classifier_from_json(const Json& json);

}  // namespace loci::perception
