// A small neural network: one hidden layer, trained with Adam (Kingma and Ba 2015).

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "perception/classification/classifier_kinds.h"

namespace loci::perception::classifier_kinds {
namespace {

using Eigen::MatrixXf;
using Eigen::VectorXf;

constexpr Eigen::Index kHidden = 96;
constexpr int kEpochs = 60;
constexpr Eigen::Index kBatch = 64;
constexpr float kRate = 3e-3F;
constexpr float kDecay = 2e-4F;
constexpr float kInputNoise = 0.3F;  ///< standard deviations: what real cameras do differently
constexpr float kMaxInput = 4;       ///< standard deviations: what is beyond all examples

struct Layer {
  MatrixXf weights;
  VectorXf offsets;
};

/// Columns are examples.
void soften(MatrixXf& logits) {
  for (Eigen::Index i = 0; i < logits.cols(); ++i) {
    const VectorXf powers = (logits.col(i).array() - logits.col(i).maxCoeff()).exp();
    logits.col(i) = powers / powers.sum();
  }
}

struct Weights {
  VectorXf mean, scale;  ///< of the inputs
  Layer hidden, out;

  MatrixXf inputs(const MatrixXf& raw) const {
    const MatrixXf centred = raw.colwise() - mean;
    return (scale.asDiagonal() * centred).cwiseMax(-kMaxInput).cwiseMin(kMaxInput);
  }
  MatrixXf hidden_of(const MatrixXf& in) const {
    return ((hidden.weights * in).colwise() + hidden.offsets).array().tanh();
  }
  MatrixXf shares(const MatrixXf& inner) const {
    MatrixXf result = (out.weights * inner).colwise() + out.offsets;
    soften(result);
    return result;
  }
};

/// Moving averages of a gradient and its square.
struct Moments {
  Eigen::ArrayXXf first, second;

  template <class Values>
  void step(Values& values, const MatrixXf& gradient, float rate, float decay, int time) {
    if (first.size() == 0) first = second = Eigen::ArrayXXf::Zero(values.rows(), values.cols());
    constexpr float kFirst = 0.9F, kSecond = 0.999F;
    const auto t = static_cast<float>(time);
    first = kFirst * first + (1 - kFirst) * gradient.array();
    second = kSecond * second + (1 - kSecond) * gradient.array().square();
    const float bias = std::sqrt(1 - std::pow(kSecond, t)) / (1 - std::pow(kFirst, t));
    values.array() -= rate * (bias * first / (second.sqrt() + 1e-8F) + decay * values.array());
  }
};

Layer drawn_layer(Eigen::Index rows, Eigen::Index columns, Random& draw) {
  Layer layer{MatrixXf(rows, columns), VectorXf::Zero(rows)};
  const double sigma = 1 / std::sqrt(static_cast<double>(columns));
  for (float& weight : layer.weights.reshaped()) weight = static_cast<float>(draw.normal(sigma));
  return layer;
}

class Trainer {
 public:
  Trainer(const LabelledVectors& data, const Random& draw) : data_(data), draw_(draw) {
    raw_.resize(static_cast<Eigen::Index>(data.vectors.front().size()),
                static_cast<Eigen::Index>(data.vectors.size()));
    for (size_t i = 0; i < data.vectors.size(); ++i)
      raw_.col(static_cast<Eigen::Index>(i)) =
          Eigen::Map<const VectorXf>(data.vectors[i].data(), raw_.rows());
    net_.mean = raw_.rowwise().mean();
    const MatrixXf centred = raw_.colwise() - net_.mean;
    const VectorXf deviation =
        (centred.rowwise().squaredNorm() / static_cast<float>(raw_.cols())).cwiseSqrt();
    net_.scale = deviation.unaryExpr([](float d) { return d > 1e-7F ? 1 / d : 0; });
    net_.hidden = drawn_layer(kHidden, raw_.rows(), draw_);
    net_.out = drawn_layer(static_cast<Eigen::Index>(data.classes), kHidden, draw_);
  }

  Weights train() {
    const MatrixXf in = net_.inputs(raw_);
    std::vector<Eigen::Index> order(static_cast<size_t>(in.cols()));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    for (int epoch = 0; epoch < kEpochs; ++epoch) {
      for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[draw_.index(i)]);
      const auto rate = static_cast<float>(0.5 * (1 + std::cos(kPi * epoch / kEpochs))) * kRate;
      for (size_t begin = 0; begin < order.size(); begin += kBatch) {
        const size_t end = std::min(order.size(), begin + kBatch);
        learn(in,
              {order.begin() + static_cast<std::ptrdiff_t>(begin),
               order.begin() + static_cast<std::ptrdiff_t>(end)},
              rate);
      }
    }
    return std::move(net_);
  }

 private:
  void learn(const MatrixXf& in, const std::vector<Eigen::Index>& batch, float rate) {
    const auto count = static_cast<Eigen::Index>(batch.size());
    MatrixXf seen(in.rows(), count);
    for (Eigen::Index i = 0; i < count; ++i) seen.col(i) = in.col(batch[static_cast<size_t>(i)]);
    for (float& value : seen.reshaped()) value += static_cast<float>(draw_.normal(kInputNoise));
    const MatrixXf inner = net_.hidden_of(seen);
    MatrixXf error = net_.shares(inner);
    for (Eigen::Index i = 0; i < count; ++i)
      error(static_cast<Eigen::Index>(data_.labels[static_cast<size_t>(batch[static_cast<size_t>(i)])]), i) -=
          1;
    error /= static_cast<float>(count);
    const MatrixXf back =
        ((net_.out.weights.transpose() * error).array() * (1 - inner.array().square())).matrix();
    ++time_;
    moments_[0].step(net_.out.weights, error * inner.transpose(), rate, kDecay / kRate, time_);
    moments_[1].step(net_.out.offsets, error.rowwise().sum(), rate, 0, time_);
    moments_[2].step(net_.hidden.weights, back * seen.transpose(), rate, kDecay / kRate, time_);
    moments_[3].step(net_.hidden.offsets, back.rowwise().sum(), rate, 0, time_);
  }

  const LabelledVectors& data_;
  Random draw_;
  MatrixXf raw_;  ///< a column per example
  Weights net_;
  Moments moments_[4];
  int time_ = 0;
};

Json to_json(const MatrixXf& values) {
  std::vector<FeatureVector> columns;
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    const VectorXf column = values.col(i);
    columns.emplace_back(column.data(), column.data() + column.size());
  }
  return vectors_to_json(columns);
}

MatrixXf matrix_from_json(const Json& json) {
  const std::vector<FeatureVector> columns = vectors_from_json(json);
  if (columns.empty()) throw Error("a network lacks weights");
  MatrixXf values(static_cast<Eigen::Index>(columns.front().size()),
                  static_cast<Eigen::Index>(columns.size()));
  for (size_t i = 0; i < columns.size(); ++i)
    values.col(static_cast<Eigen::Index>(i)) = Eigen::Map<const VectorXf>(columns[i].data(), values.rows());
  return values;
}

class NetworkClassifier : public Classifier {
 public:
  explicit NetworkClassifier(Weights net) : net_(std::move(net)) {
    const Eigen::Index inner = net_.hidden.weights.rows();
    if (net_.mean.size() != net_.hidden.weights.cols() || net_.scale.size() != net_.mean.size() ||
        net_.hidden.offsets.size() != inner || net_.out.weights.cols() != inner ||
        net_.out.offsets.size() != net_.out.weights.rows())
      throw Error("the layers of a network do not fit together");
  }

  Json kind_to_json() const override {
    return {{"method", "network"},
            {"mean", classifier_kinds::to_json(net_.mean)},
            {"scale", classifier_kinds::to_json(net_.scale)},
            {"hidden", classifier_kinds::to_json(net_.hidden.weights)},
            {"hidden_offsets", classifier_kinds::to_json(net_.hidden.offsets)},
            {"out", classifier_kinds::to_json(net_.out.weights)},
            {"out_offsets", classifier_kinds::to_json(net_.out.offsets)}};
  }

 protected:
  std::vector<double> scores_of_scaled(const FeatureVector& vector) const override {
    if (static_cast<Eigen::Index>(vector.size()) != net_.mean.size())
      throw Error("a network was given inputs of another size");
    const MatrixXf raw = Eigen::Map<const VectorXf>(vector.data(), net_.mean.size());
    const MatrixXf shares = net_.shares(net_.hidden_of(net_.inputs(raw)));
    return {shares.data(), shares.data() + shares.size()};
  }

 private:
  Weights net_;
};

}  // namespace

std::unique_ptr<Classifier> train_network(const LabelledVectors& data, const Random& random) {
  return std::make_unique<NetworkClassifier>(Trainer(data, random).train());
}

std::unique_ptr<Classifier> network_from_json(const Json& json) {
  const auto vector = [&](const char* name) -> VectorXf { return matrix_from_json(json.at(name)).col(0); };
  return std::make_unique<NetworkClassifier>(
      Weights{vector("mean"),
              vector("scale"),
              {matrix_from_json(json.at("hidden")), vector("hidden_offsets")},
              {matrix_from_json(json.at("out")), vector("out_offsets")}});
}

}  // namespace loci::perception::classifier_kinds
