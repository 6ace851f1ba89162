#include "perception/classification/softmax_regression.h"

#include <Eigen/Cholesky>

#include "mapping/base/error.h"
#include "mapping/base/json.h"

namespace loci::perception {
namespace {

Eigen::VectorXd softmax(const Eigen::VectorXd& logits) {
  const Eigen::VectorXd powers = (logits.array() - logits.maxCoeff()).exp();
  return powers / powers.sum();
}

}  // namespace

SoftmaxRegression SoftmaxRegression::fit(const std::vector<Eigen::MatrixXd>& examples,
                                         const std::vector<size_t>& labels, double ridge) {
  if (labels.empty() || labels.size() != examples.size())
    throw Error("a regression needs one label for each example");
  const Eigen::Index size = examples.front().cols();
  const double share = 1.0 / static_cast<double>(labels.size());
  SoftmaxRegression regression;
  regression.weights_ = Eigen::VectorXd::Zero(size);
  constexpr int kSteps = 30;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::VectorXd gradient = ridge * regression.weights_;
    Eigen::MatrixXd hessian = ridge * Eigen::MatrixXd::Identity(size, size);
    for (size_t i = 0; i < examples.size(); ++i) {
      const Eigen::MatrixXd& x = examples[i];
      const Eigen::VectorXd p = softmax(x * regression.weights_);
      const Eigen::VectorXd mean = x.transpose() * p;
      gradient += share * (mean - x.row(static_cast<Eigen::Index>(labels[i])).transpose());
      hessian += share * (x.transpose() * p.asDiagonal() * x - mean * mean.transpose());
    }
    const Eigen::VectorXd move = hessian.llt().solve(gradient);
    regression.weights_ -= move;
    if (move.norm() < 1e-8) break;
  }
  if (!regression.weights_.allFinite()) throw Error("the regression has no finite weights");
  return regression;
}

std::vector<double> SoftmaxRegression::probabilities(const Eigen::MatrixXd& example) const {
  if (example.cols() != weights_.size()) throw Error("a regression was given inputs of another size");
  const Eigen::VectorXd p = softmax(example * weights_);
  return {p.begin(), p.end()};
}

Json SoftmaxRegression::to_json() const {
  return std::vector<double>(weights_.begin(), weights_.end());
}

SoftmaxRegression SoftmaxRegression::from_json(const Json& json) {
  const std::vector<double> weights = json;
  SoftmaxRegression regression;
  regression.weights_ =
      Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  return regression;
}

}  // namespace loci::perception
