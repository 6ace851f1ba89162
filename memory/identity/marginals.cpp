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
  for (size_t base = 0; base < block; base += size_t{2} * bit)
    Part<bit>(out + base + bit) += w * ConstPart<bit>(in + base);
}

/// out[s] += w · in[s + bit], and the sum of f[s] · in[s + bit].
template <int bit>
double add_backward(double* out, const double* in, const double* f, double w, size_t block) {
  double sum = 0;
  for (size_t base = 0; base < block; base += size_t{2} * bit) {
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

/// A weight per subset of the open rows, divided by their maximum.
struct Layer {
  std::vector<double> weight;
  double log_scale = 0;

  void normalise() {
    Eigen::Map<Eigen::ArrayXd> all(weight.data(), static_cast<Eigen::Index>(weight.size()));
    const double largest = all.maxCoeff();
    if (!(largest > 0)) throw Error("invalid_value: no matching is possible");
    all *= 1 / largest;
    log_scale += std::log(largest);
  }
};

/// One column is summed out. Bit b of a subset says that row `open[b]` is taken.
struct Step {
  struct Pair {
    size_t bit;
    double odds;
  };
  size_t column = 0;
  std::vector<size_t> open;     ///< rows, those that this column opens last
  std::vector<Pair> pairs;      ///< of this column
  std::vector<size_t> closing;  ///< bits of rows without further columns, descending
};

size_t subsets(size_t rows) {
  return size_t{1} << rows;
}

/// Subset of one row less, with the row's bit inserted as 0.
size_t with_gap(size_t subset, size_t bit) {
  const size_t low = subset & (subsets(bit) - 1);
  return ((subset - low) << 1) + low;
}

class SubsetSum {
 public:
  explicit SubsetSum(const IdentityComponent& component) : component_(component) {
    const std::vector<std::vector<size_t>> rows_of = rows_of_columns(component);
    std::vector<size_t> left(component.rows.size(), 0);
    for (const std::vector<size_t>& rows : rows_of)
      for (const size_t row : rows) ++left[row];
    for (size_t row = 0; row < left.size(); ++row)
      if (left[row] == 0 && !component.row_free[row]) throw Error("invalid_value: no matching is possible");
    std::vector<size_t> open;
    for (const size_t column : component.order.columns)
      steps_.push_back(step_of(column, rows_of[column], open, left));
  }

  ComponentMarginals run() {
    ComponentMarginals result;
    result.matched.setZero(static_cast<Eigen::Index>(component_.rows.size()),
                           static_cast<Eigen::Index>(component_.columns.size()));
    result.row_alone.assign(component_.rows.size(), 1);
    result.column_alone.assign(component_.columns.size(), 0);
    forward_checkpoints();
    Layer backward{{1.0}, 0};
    for (size_t t = steps_.size(); t-- > 0;) backward = back_step(t, forward_layer(t), backward, result);
    result.log_z = log_z_ + component_.log_scale;
    return result;
  }

 private:
  /// Opens and closes rows in `open`, and counts the columns that are left of each.
  Step step_of(size_t column, const std::vector<size_t>& rows, std::vector<size_t>& open,
               std::vector<size_t>& left) const {
    Step step;
    step.column = column;
    for (const size_t row : rows) {
      const auto bit = static_cast<size_t>(std::find(open.begin(), open.end(), row) - open.begin());
      if (bit == open.size()) open.push_back(row);
      step.pairs.push_back({bit, std::exp(component_.log_ratio(static_cast<Eigen::Index>(row),
                                                               static_cast<Eigen::Index>(column)))});
      --left[row];
    }
    step.open = open;
    for (size_t bit = open.size(); bit-- > 0;)
      if (left[open[bit]] == 0) {
        step.closing.push_back(bit);
        open.erase(open.begin() + static_cast<std::ptrdiff_t>(bit));
      }
    return step;
  }

  double alone(const Step& step) const { return component_.column_free[step.column] ? 1 : 0; }
  double alone(const Step& step, size_t bit) const { return component_.row_free[step.open[bit]] ? 1 : 0; }

  /// The layer with the rows that a step opens, none of which is taken.
  Layer open_rows(const Step& step, Layer layer) const {
    layer.weight.resize(subsets(step.open.size()), 0.0);
    return layer;
  }

  /// Sums over the column's partner: out[s] = alone · in[s] + the sum of odds · in[s without the row].
  /// `opened`: number of subsets of the rows that were open before; of the others one is taken at most.
  Layer match(size_t t, const Layer& in, size_t opened) const {
    const Step& step = steps_[t];
    const size_t states = in.weight.size(), block = std::min(states, subsets(kBlockBits));
    Layer out{std::vector<double>(states, 0.0), in.log_scale};
    for (size_t high = 0; high < states; high += block) {
      if (static_cast<size_t>(std::popcount(high)) > t + 1 || std::popcount(high / opened) > 1) continue;
      double* to = out.weight.data() + high;
      const double* from = in.weight.data() + high;
      for (size_t s = 0; s < block; ++s) to[s] = alone(step) * from[s];
      for (const auto& [bit, odds] : step.pairs) {
        if (bit < kBlockBits)
          kAddForward[bit](to, from, odds, block);
        else if ((high & subsets(bit)) != 0)
          Part<kBlock>(to) += odds * ConstPart<kBlock>(from - subsets(bit));
      }
    }
    return out;
  }

  Layer forward_step(size_t t, const Layer& from) const {
    Layer layer = match(t, open_rows(steps_[t], from), from.weight.size());
    for (const size_t bit : steps_[t].closing) {
      const double free = alone(steps_[t], bit);
      std::vector<double> rest(layer.weight.size() / 2);
      for (size_t s = 0; s < rest.size(); ++s)
        rest[s] = free * layer.weight[with_gap(s, bit)] + layer.weight[with_gap(s, bit) + subsets(bit)];
      layer.weight = std::move(rest);
    }
    layer.normalise();
    return layer;
  }

  /// Sums out all columns. Keeps every stride-th layer when all of them would take too much memory.
  void forward_checkpoints() {
    constexpr size_t kMaxDoubles = size_t{1} << 25;
    size_t widest = 0;
    for (const Step& step : steps_) widest = std::max(widest, step.open.size());
    stride_ = 1;
    while ((steps_.size() / stride_ + stride_) * subsets(widest) > kMaxDoubles &&
           stride_ * stride_ < steps_.size())
      ++stride_;
    Layer layer{{1.0}, 0};
    for (size_t t = 0; t < steps_.size(); ++t) {
      Layer next = forward_step(t, layer);
      if (t % stride_ == 0) checkpoints_.push_back(std::move(layer));
      layer = std::move(next);
    }
    log_z_ = layer.log_scale + std::log(layer.weight[0]);  // all rows are closed
  }

  const Layer& forward_layer(size_t t) {
    const size_t first = t / stride_ * stride_;
    if (segment_first_ != first || segment_.empty()) {
      segment_first_ = first;
      segment_.clear();
      segment_.push_back(std::move(checkpoints_[first / stride_]));
    }
    while (segment_.size() <= t - first)
      segment_.push_back(forward_step(first + segment_.size() - 1, segment_.back()));
    return segment_[t - first];
  }

  /// B before the rows of a step are closed from B after it.
  Layer reopen_rows(const Step& step, Layer layer) const {
    for (size_t i = step.closing.size(); i-- > 0;) {
      const size_t bit = step.closing[i];
      const double free = alone(step, bit);
      std::vector<double> all(2 * layer.weight.size());
      for (size_t s = 0; s < layer.weight.size(); ++s) {
        all[with_gap(s, bit)] = free * layer.weight[s];
        all[with_gap(s, bit) + subsets(bit)] = layer.weight[s];
      }
      layer.weight = std::move(all);
    }
    return layer;
  }

  /// What is left of the weight where the rows that a step closes are alone.
  void finish_rows(size_t t, const Layer& before, const Layer& backward, ComponentMarginals& result) const {
    const Step& step = steps_[t];
    if (step.closing.empty()) return;
    const Layer matched = match(t, open_rows(step, before), before.weight.size());
    const double factor = std::exp(matched.log_scale + backward.log_scale - log_z_);
    for (const size_t bit : step.closing) {
      double sum = 0;
      for (size_t s = 0; s < matched.weight.size() / 2; ++s)
        sum += matched.weight[with_gap(s, bit)] * backward.weight[with_gap(s, bit)];
      result.row_alone[step.open[bit]] = sum * factor;
    }
  }

  /// B before a step from B after it, and the marginals of its column and of the rows that it closes.
  Layer back_step(size_t t, const Layer& before, const Layer& after, ComponentMarginals& result) const {
    const Step& step = steps_[t];
    const Layer backward = reopen_rows(step, after);
    finish_rows(t, before, backward, result);
    // Before the step no row that it opens is taken; blocks are as large as after it.
    const size_t block = std::min(backward.weight.size(), subsets(kBlockBits));
    const size_t states = std::max(before.weight.size(), block);
    Layer forward = before;
    forward.weight.resize(states, 0.0);
    Layer to{std::vector<double>(states, 0.0), backward.log_scale};
    std::vector<double> pair(step.pairs.size(), 0.0);
    double column_alone = 0;
    for (size_t high = 0; high < states; high += block) {
      if (static_cast<size_t>(std::popcount(high)) > t) continue;
      double* out = to.weight.data() + high;
      const double* in = backward.weight.data() + high;
      const double* f = forward.weight.data() + high;
      const auto size = static_cast<Eigen::Index>(block);
      Eigen::Map<Eigen::ArrayXd> here(out, size);
      here = alone(step) * Eigen::Map<const Eigen::ArrayXd>(in, size);
      column_alone += (Eigen::Map<const Eigen::ArrayXd>(f, size) * here).sum();
      for (size_t i = 0; i < step.pairs.size(); ++i) {
        const auto [bit, odds] = step.pairs[i];
        if (bit < kBlockBits) {
          pair[i] += kAddBackward[bit](out, in, f, odds, block);
        } else if ((high & subsets(bit)) == 0) {
          const ConstPart<kBlock> with(in + subsets(bit));
          Part<kBlock>(out) += odds * with;
          pair[i] += (ConstPart<kBlock>(f) * with).sum();
        }
      }
    }
    const double factor = std::exp(forward.log_scale + backward.log_scale - log_z_);
    const auto column = static_cast<Eigen::Index>(step.column);
    for (size_t i = 0; i < step.pairs.size(); ++i)
      result.matched(static_cast<Eigen::Index>(step.open[step.pairs[i].bit]), column) =
          step.pairs[i].odds * pair[i] * factor;
    result.column_alone[step.column] = column_alone * factor;
    to.weight.resize(before.weight.size());
    to.normalise();
    return to;
  }

  const IdentityComponent& component_;
  std::vector<Step> steps_;
  size_t stride_ = 1;
  std::vector<Layer> checkpoints_;
  std::vector<Layer> segment_;
  size_t segment_first_ = 0;
  double log_z_ = 0;
};

}  // namespace

ComponentMarginals marginals(const IdentityComponent& component) {
  return SubsetSum(component).run();
}

}  // namespace loci::memory
