#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/base/json_fwd.h"

namespace loci {

/// Multinomial logistic regression: probabilities of classes from a vector of inputs.
class SoftmaxRegression {
 public:
  /// The weights W (classes × (inputs + 1), the last column without input) that maximise the mean log
  /// probability of the labels minus ridge/2 · |W|², by Newton's method. Rows of `inputs` are examples;
  /// labels are below `classes`. `ridge` > 0.
  static SoftmaxRegression fit(const Eigen::MatrixXd& inputs, const std::vector<size_t>& labels,
                               size_t classes, double ridge);

  std::vector<double> probabilities(const Eigen::VectorXd& inputs) const;

  Json to_json() const;
  static SoftmaxRegression from_json(const Json& json);

 private:
  Eigen::MatrixXd weights_;
};

}  // namespace loci
