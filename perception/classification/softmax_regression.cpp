#include "perception/classification/softmax_regression.h"

#include <Eigen/Cholesky>

#include "mapping/base/error.h"
#include "mapping/base/json.h"

namespace loci {
namespace {

/// With a one behind the inputs.
Eigen::VectorXd extended(const Eigen::VectorXd& inputs) {
  Eigen::VectorXd all(inputs.size() + 1);
  all << inputs, 1;
  return all;
}

Eigen::VectorXd softmax(const Eigen::VectorXd& logits) {
  const Eigen::VectorXd powers = (logits.array() - logits.maxCoeff()).exp();
  return powers / powers.sum();
}

}  // namespace

SoftmaxRegression SoftmaxRegression::fit(const Eigen::MatrixXd& inputs, const std::vector<size_t>& labels,
                                         size_t classes, double ridge) {
  if (labels.empty() || static_cast<Eigen::Index>(labels.size()) != inputs.rows())
    throw Error("a regression needs one label for each example");
  const auto rows = static_cast<Eigen::Index>(classes);
  const Eigen::Index columns = inputs.cols() + 1;
  SoftmaxRegression regression;
  regression.weights_ = Eigen::MatrixXd::Zero(rows, columns);
  const double share = 1.0 / static_cast<double>(labels.size());
  constexpr int kSteps = 30;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::MatrixXd gradient = ridge * regression.weights_;
    Eigen::MatrixXd hessian = ridge * Eigen::MatrixXd::Identity(rows * columns, rows * columns);
    for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
      const Eigen::VectorXd x = extended(inputs.row(i));
      const Eigen::VectorXd p = softmax(regression.weights_ * x);
      Eigen::VectorXd off = p;
      off[static_cast<Eigen::Index>(labels[static_cast<size_t>(i)])] -= 1;
      gradient += share * off * x.transpose();
      const Eigen::MatrixXd outer = share * x * x.transpose();
      for (Eigen::Index a = 0; a < rows; ++a)
        for (Eigen::Index b = 0; b < rows; ++b)
          hessian.block(a * columns, b * columns, columns, columns) +=
              p[a] * ((a == b ? 1.0 : 0.0) - p[b]) * outer;
    }
    const Eigen::MatrixXd by_class = gradient.transpose();  // One class's weights after the other's.
    const Eigen::VectorXd move = hessian.llt().solve(by_class.reshaped());
    regression.weights_ -= move.reshaped(columns, rows).transpose();
    if (move.norm() < 1e-8) break;
  }
  if (!regression.weights_.allFinite()) throw Error("the regression has no finite weights");
  return regression;
}

std::vector<double> SoftmaxRegression::probabilities(const Eigen::VectorXd& inputs) const {
  if (inputs.size() + 1 != weights_.cols()) throw Error("a regression was given inputs of another size");
  const Eigen::VectorXd p = softmax(weights_ * extended(inputs));
  return {p.begin(), p.end()};
}

Json SoftmaxRegression::to_json() const {
  Json json = Json::array();
  for (Eigen::Index r = 0; r < weights_.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < weights_.cols(); ++c) row.push_back(weights_(r, c));
    json.push_back(std::move(row));
  }
  return json;
}

SoftmaxRegression SoftmaxRegression::from_json(const Json& json) {
  SoftmaxRegression regression;
  const size_t columns = json.at(0).size();
  regression.weights_.resize(static_cast<Eigen::Index>(json.size()), static_cast<Eigen::Index>(columns));
  for (size_t r = 0; r < json.size(); ++r) {
    if (json.at(r).size() != columns) throw Error("the weights of a regression are no table");
    for (size_t c = 0; c < columns; ++c)
      regression.weights_(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = json.at(r).at(c);
  }
  return regression;
}

}  // namespace loci
