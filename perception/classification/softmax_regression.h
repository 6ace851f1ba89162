#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/base/json_fwd.h"

namespace loci::perception {

/// Conditional logistic regression: the probability of a class is proportional to exp(x · w), x being what
/// is said for that class (a row of an example) and w weights that all classes share, so that few examples
/// are enough.
class SoftmaxRegression {
 public:
  /// The weights that maximise the mean log probability of the labels minus ridge/2 · |w|², by Newton's
  /// method. Each example is a matrix of classes × inputs; `ridge` > 0.
  static SoftmaxRegression fit(const std::vector<Eigen::MatrixXd>& examples,
                               const std::vector<size_t>& labels, double ridge);

  std::vector<double> probabilities(const Eigen::MatrixXd& example) const;

  Json to_json() const;
  static SoftmaxRegression from_json(const Json& json);

 private:
  Eigen::VectorXd weights_;
};

}  // namespace loci::perception
