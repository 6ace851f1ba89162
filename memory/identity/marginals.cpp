#include "memory/identity/marginals.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace loci::memory {
namespace {

/// Subsets are processed in blocks that share their high bits, so that the inner loops run over contiguous
/// memory and blocks that cannot be reached are skipped as a whole.
constexpr size_t kBlockBits = 6;
constexpr Eigen::Index kBlock = Eigen::Index{1} << kBlockBits;

// Fixed sizes, so that the compiler unrolls and vectorises; the order of additions is the same everywhere.
template <int size>
using Part = Eigen::Map<Eigen::Array<double, size, 1>>;
template <int size>
using ConstPart = Eigen::Map<const Eigen::Array<double, size, 1>>;

/// out[s + bit] += w · in[s] for all s of a block that lack the bit.
template <int bit>
void add_forward(double* out, const double* in, double w, size_t block) {
  for (size_t base = 0; base < block; base += 2 * bit)
    Part<bit>(out + base + bit) += w * ConstPart<bit>(in + base);
}

/// out[s] += w · in[s + bit], and the sum of f[s] · in[s + bit].
template <int bit>
double add_backward(double* out, const double* in, const double* f, double w, size_t block) {
  double sum = 0;
  for (size_t base = 0; base < block; base += 2 * bit) {
    const ConstPart<bit> with(in + base + bit);
    Part<bit>(out + base) += w * with;
    sum += (ConstPart<bit>(f + base) * with).sum();
  }
  return sum;
}

using AddForward = void (*)(double*, const double*, double, size_t);
using AddBackward = double (*)(double*, const double*, const double*, double, size_t);
constexpr AddForward kAddForward[] = {add_forward<1>, add_forward<2>,  add_forward<4>,
                                      add_forward<8>, add_forward<16>, add_forward<32>};
constexpr AddBackward kAddBackward[] = {add_backward<1>, add_backward<2>,  add_backward<4>,
                                        add_backward<8>, add_backward<16>, add_backward<32>};

/// One layer of the recursion: a weight per subset of the rows, divided by its maximum.
struct Layer {
  std::vector<double> weight;
  double log_scale = 0;
};

class SubsetSum {
 public:
  explicit SubsetSum(const IdentityComponent& component) : component_(component) {
    rows_ = component.rows.size();
    columns_ = component.columns.size();
    states_ = size_t{1} << rows_;
    low_bits_ = std::min(rows_, kBlockBits);
    block_ = size_t{1} << low_bits_;
    weights_.resize(rows_ * columns_);
    for (size_t i = 0; i < rows_; ++i)
      for (size_t j = 0; j < columns_; ++j)
        weights_[j * rows_ + i] =
            std::exp(component.log_ratio(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
  }

  ComponentMarginals run() {
    ComponentMarginals result;
    result.matched.setZero(static_cast<Eigen::Index>(rows_), static_cast<Eigen::Index>(columns_));
    result.row_alone.assign(rows_, 0);
    result.column_alone.assign(columns_, 0);
    forward_checkpoints();
    Layer backward = last_backward();
    finish_rows(backward, result);
    for (size_t j = columns_; j-- > 0;) {
      const Layer& forward = forward_layer(j);
      backward = back_step(j, forward, backward, result);
    }
    result.log_z += component_.log_scale;
    return result;
  }

 private:
  double weight(size_t i, size_t j) const { return weights_[j * rows_ + i]; }

  static void normalise(Layer& layer) {
    Eigen::Map<Eigen::ArrayXd> weight(layer.weight.data(), static_cast<Eigen::Index>(layer.weight.size()));
    const double largest = weight.maxCoeff();
    if (!(largest > 0)) throw Error("invalid_value: no matching is possible");
    weight *= 1 / largest;
    layer.log_scale += std::log(largest);
  }

  /// F of column j + 1 from F of column j.
  Layer forward_step(size_t j, const Layer& from) const {
    Layer to{std::vector<double>(states_, 0.0), from.log_scale};
    const double alone = component_.column_free[j] ? 1 : 0;
    for (size_t high = 0; high < states_; high += block_) {
      if (static_cast<size_t>(std::popcount(high)) > j + 1) continue;
      double* out = to.weight.data() + high;
      const double* in = from.weight.data() + high;
      for (size_t s = 0; s < block_; ++s) out[s] = alone * in[s];
      for (size_t i = 0; i < low_bits_; ++i)
        if (const double w = weight(i, j); w != 0) kAddForward[i](out, in, w, block_);
      for (size_t i = low_bits_; i < rows_; ++i) {
        const size_t bit = size_t{1} << i;
        const double w = weight(i, j);
        if ((high & bit) == 0 || w == 0) continue;
        Part<kBlock>(out) += w * ConstPart<kBlock>(in - bit);
      }
    }
    normalise(to);
    return to;
  }

  /// Keeps every stride-th layer when all of them would take too much memory.
  void forward_checkpoints() {
    constexpr size_t kMaxDoubles = size_t{1} << 25;
    stride_ = 1;
    while ((columns_ / stride_ + stride_) * states_ > kMaxDoubles && stride_ * stride_ < columns_) ++stride_;
    Layer layer{std::vector<double>(states_, 0.0), 0};
    layer.weight[0] = 1;
    for (size_t j = 0; j < columns_; ++j) {
      Layer next = forward_step(j, layer);
      if (j % stride_ == 0) checkpoints_.push_back(std::move(layer));
      layer = std::move(next);
    }
    last_forward_ = std::move(layer);
  }

  const Layer& forward_layer(size_t j) {
    const size_t first = j / stride_ * stride_;
    if (segment_first_ != first || segment_.empty()) {
      segment_first_ = first;
      segment_.clear();
      segment_.push_back(std::move(checkpoints_[first / stride_]));
    }
    while (segment_.size() <= j - first)
      segment_.push_back(forward_step(first + segment_.size() - 1, segment_.back()));
    return segment_[j - first];
  }

  /// B of the last column: 1 where all rows that are not in the subset may stay unmatched.
  Layer last_backward() const {
    size_t must = 0;
    for (size_t i = 0; i < rows_; ++i)
      if (!component_.row_free[i]) must |= size_t{1} << i;
    Layer layer{std::vector<double>(states_, 0.0), 0};
    for (size_t s = 0; s < states_; ++s) layer.weight[s] = (s & must) == must ? 1 : 0;
    return layer;
  }

  void finish_rows(const Layer& backward, ComponentMarginals& result) {
    double z = 0;
    for (size_t s = 0; s < states_; ++s) {
      const double term = last_forward_.weight[s] * backward.weight[s];
      z += term;
      for (size_t i = 0; i < rows_; ++i)
        if ((s >> i & 1) == 0) result.row_alone[i] += term;
    }
    if (!(z > 0)) throw Error("invalid_value: no matching is possible");
    for (double& value : result.row_alone) value /= z;
    result.log_z = std::log(z) + last_forward_.log_scale;
    log_z_ = result.log_z;
  }

  /// B of column j from B of column j + 1, and the marginals of column j.
  Layer back_step(size_t j, const Layer& forward, const Layer& backward, ComponentMarginals& result) const {
    Layer to{std::vector<double>(states_, 0.0), backward.log_scale};
    std::vector<double> pair(rows_, 0.0);
    const double alone = component_.column_free[j] ? 1 : 0;
    double column_alone = 0;
    for (size_t high = 0; high < states_; high += block_) {
      if (static_cast<size_t>(std::popcount(high)) > j) continue;
      double* out = to.weight.data() + high;
      const double* in = backward.weight.data() + high;
      const double* f = forward.weight.data() + high;
      const auto size = static_cast<Eigen::Index>(block_);
      Eigen::Map<Eigen::ArrayXd> here(out, size);
      here = alone * Eigen::Map<const Eigen::ArrayXd>(in, size);
      column_alone += (Eigen::Map<const Eigen::ArrayXd>(f, size) * here).sum();
      for (size_t i = 0; i < low_bits_; ++i) {
        const double w = weight(i, j);
        if (w != 0) pair[i] += kAddBackward[i](out, in, f, w, block_);
      }
      for (size_t i = low_bits_; i < rows_; ++i) {
        const size_t bit = size_t{1} << i;
        const double w = weight(i, j);
        if ((high & bit) != 0 || w == 0) continue;
        const ConstPart<kBlock> with(in + bit);
        Part<kBlock>(out) += w * with;
        pair[i] += (ConstPart<kBlock>(f) * with).sum();
      }
    }
    const double factor = std::exp(forward.log_scale + backward.log_scale - log_z_);
    for (size_t i = 0; i < rows_; ++i)
      result.matched(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          weight(i, j) * pair[i] * factor;
    result.column_alone[j] = column_alone * factor;
    normalise(to);
    return to;
  }

  const IdentityComponent& component_;
  size_t rows_ = 0, columns_ = 0, states_ = 0, low_bits_ = 0, block_ = 0;
  std::vector<double> weights_;  ///< column-major: all rows of a column together
  size_t stride_ = 1;
  std::vector<Layer> checkpoints_;
  std::vector<Layer> segment_;
  size_t segment_first_ = 0;
  Layer last_forward_;
  double log_z_ = 0;
};

}  // namespace

ComponentMarginals marginals(const IdentityComponent& component) {
  return SubsetSum(component).run();
}

}  // namespace loci::memory
