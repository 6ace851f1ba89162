#include "memory/identity/components.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace loci::memory {
namespace {

/// Sets of rows and columns that are joined by pairs.
class Groups {
 public:
  explicit Groups(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), size_t{0}); }
  size_t find(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(size_t a, size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<size_t> parent_;
};

struct Pair {
  double cost;  ///< bound of its probability
  Eigen::Index row, column;
};

/// The weight that a row or column is divided by: that of staying unmatched, or where that is impossible the
/// largest of its pairs.
std::vector<double> scales(const std::vector<double>& log_alone, const std::vector<double>& log_largest) {
  std::vector<double> scale = log_alone;
  for (size_t i = 0; i < scale.size(); ++i)
    if (scale[i] == kNever) scale[i] = log_largest[i];
  return scale;
}

/// The two largest of some odds.
struct Rival {
  Eigen::Index at = -1;
  double largest = 0, second = 0;
  /// The largest that is not at `i`.
  double besides(Eigen::Index i) const { return i == at ? second : largest; }
};

Rival strongest(const Eigen::VectorXd& odds) {
  Rival rival;
  for (Eigen::Index i = 0; i < odds.size(); ++i) {
    if (odds[i] > rival.largest) {
      rival.second = rival.largest;
      rival.largest = odds[i];
      rival.at = i;
    } else {
      rival.second = std::max(rival.second, odds[i]);
    }
  }
  return rival;
}

class Splitter {
 public:
  Splitter(const PairTable& log_pair, const std::vector<double>& log_row,
           const std::vector<double>& log_column)
      : log_row_(log_row), log_column_(log_column), log_ratio_(log_pair) {
    const Eigen::Index m = log_pair.rows(), n = log_pair.cols();
    std::vector<double> largest(log_column.size(), kNever);
    for (Eigen::Index o = 0; o < m; ++o)
      for (Eigen::Index k = 0; k < n; ++k)
        largest[static_cast<size_t>(k)] = std::max(largest[static_cast<size_t>(k)], log_pair(o, k));
    column_scale_ = scales(log_column, largest);
    largest.assign(log_row.size(), kNever);
    for (Eigen::Index o = 0; o < m; ++o)
      for (Eigen::Index k = 0; k < n; ++k) {
        if (log_pair(o, k) == kNever) continue;
        log_ratio_(o, k) -= column_scale_[static_cast<size_t>(k)];
        largest[static_cast<size_t>(o)] = std::max(largest[static_cast<size_t>(o)], log_ratio_(o, k));
      }
    row_scale_ = scales(log_row, largest);
    for (Eigen::Index o = 0; o < m; ++o)
      for (Eigen::Index k = 0; k < n; ++k)
        if (log_ratio_(o, k) != kNever) log_ratio_(o, k) -= row_scale_[static_cast<size_t>(o)];
    for (const auto* scale : {&row_scale_, &column_scale_})
      if (std::find(scale->begin(), scale->end(), kNever) != scale->end())
        throw Error("invalid_value: something must be matched but has no possible partner");
  }

  /// Drops the weakest pairs while the bound stays within the budget.
  void gate(double budget) {
    if (budget <= 0) return;
    if (!sorted_) sort(budget);
    while (dropped_ < order_.size()) {
      const Pair& pair = order_[dropped_];
      if (bound_ + pair.cost > budget) break;
      bound_ += pair.cost;
      log_ratio_(pair.row, pair.column) = kNever;
      ++dropped_;
    }
  }

  IdentityComponents components() {
    const auto m = log_row_.size(), n = log_column_.size();
    const std::vector<size_t> group = groups();
    std::vector<std::vector<size_t>> rows(m + n), columns(m + n);
    for (size_t o = 0; o < m; ++o) rows[group[o]].push_back(o);
    for (size_t k = 0; k < n; ++k) columns[group[m + k]].push_back(k);
    IdentityComponents result;
    result.gate_bound = std::min(1.0, bound_);
    for (size_t g = 0; g < m + n; ++g) {
      if (rows[g].empty() || columns[g].empty()) {
        for (const size_t o : rows[g]) result.log_alone += log_row_[o];
        for (const size_t k : columns[g]) result.log_alone += log_column_[k];
      } else {
        result.parts.push_back(part(rows[g], columns[g]));
      }
    }
    return result;
  }

 private:
  /// Orders the pairs by a bound of their probability. Its odds against both being unmatched bound it, and
  /// more so where another pair (o', k) competes for k: of the matchings without o and k, at least the share
  /// 1 / (1 + sum of the other odds of o') leaves o' free for k. Likewise for another partner of o.
  /// Those that all fit into the budget together, the most by far, need no order.
  void sort(double budget) {
    const Eigen::Index m = log_ratio_.rows(), n = log_ratio_.cols();
    const PairTable odds = log_ratio_.array().exp().min(1e250);
    const Eigen::VectorXd row_sum = odds.rowwise().sum(), column_sum = odds.colwise().sum();
    PairTable for_column(m, n), for_row(m, n);  // least odds of k with o', of o with k'
    for (Eigen::Index o = 0; o < m; ++o)
      for (Eigen::Index k = 0; k < n; ++k) {
        for_column(o, k) = odds(o, k) / (1 + std::max(0.0, row_sum[o] - odds(o, k)));
        for_row(o, k) = odds(o, k) / (1 + std::max(0.0, column_sum[k] - odds(o, k)));
      }
    const auto needs = [](const std::vector<double>& alone) {
      return std::find(alone.begin(), alone.end(), kNever) != alone.end();
    };
    const bool free = !needs(log_row_) && !needs(log_column_);  // otherwise the share has no such bound
    std::vector<Rival> of_column, of_row;
    for (Eigen::Index k = 0; k < n; ++k) of_column.push_back(strongest(for_column.col(k)));
    for (Eigen::Index o = 0; o < m; ++o) of_row.push_back(strongest(for_row.row(o).transpose()));
    for (Eigen::Index o = 0; o < m; ++o)
      for (Eigen::Index k = 0; k < n; ++k) {
        // A pair of something that must be matched cannot be dropped: its odds have no bound.
        const bool needed =
            log_row_[static_cast<size_t>(o)] == kNever || log_column_[static_cast<size_t>(k)] == kNever;
        if (log_ratio_(o, k) == kNever || needed) continue;
        const double rival = !free ? 0
                                   : std::max(of_column[static_cast<size_t>(k)].besides(o),
                                              of_row[static_cast<size_t>(o)].besides(k));
        order_.push_back({odds(o, k) / (1 + odds(o, k) + rival), o, k});
      }
    const double surely = budget / static_cast<double>(std::max<size_t>(1, order_.size()));
    const auto rest = std::stable_partition(order_.begin(), order_.end(),
                                            [&](const Pair& pair) { return pair.cost <= surely; });
    std::stable_sort(rest, order_.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
    sorted_ = true;
  }

  std::vector<size_t> groups() {
    const auto m = log_row_.size(), n = log_column_.size();
    Groups groups(m + n);
    for (size_t o = 0; o < m; ++o)
      for (size_t k = 0; k < n; ++k)
        if (log_ratio_(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(k)) != kNever)
          groups.join(o, m + k);
    std::vector<size_t> result(m + n);
    for (size_t i = 0; i < m + n; ++i) result[i] = groups.find(i);
    return result;
  }

  static constexpr double kRange = 700;  ///< e to this power is nearly the largest double

  IdentityComponent part(const std::vector<size_t>& olds, const std::vector<size_t>& news) const {
    IdentityComponent part;
    part.transposed = news.size() < olds.size();
    part.rows = part.transposed ? news : olds;
    part.columns = part.transposed ? olds : news;
    const auto& row_alone = part.transposed ? log_column_ : log_row_;
    const auto& column_alone = part.transposed ? log_row_ : log_column_;
    for (const size_t row : part.rows) part.row_free.push_back(row_alone[row] != kNever);
    for (const size_t column : part.columns) part.column_free.push_back(column_alone[column] != kNever);
    for (const size_t o : olds) part.log_scale += row_scale_[o];
    for (const size_t k : news) part.log_scale += column_scale_[k];
    part.log_ratio.resize(static_cast<Eigen::Index>(part.rows.size()),
                          static_cast<Eigen::Index>(part.columns.size()));
    for (Eigen::Index i = 0; i < part.log_ratio.rows(); ++i)
      for (Eigen::Index j = 0; j < part.log_ratio.cols(); ++j) {
        const auto row = static_cast<Eigen::Index>(part.rows[static_cast<size_t>(i)]);
        const auto column = static_cast<Eigen::Index>(part.columns[static_cast<size_t>(j)]);
        const double ratio = part.transposed ? log_ratio_(column, row) : log_ratio_(row, column);
        part.log_ratio(i, j) = ratio < -kRange ? kNever : ratio;
      }
    part.order = elimination_order(rows_of_columns(part), part.rows.size());
    // With larger odds the weights of the subsets of the open rows would leave the range of a double.
    part.log_ratio = part.log_ratio.cwiseMin(kRange / static_cast<double>(part.order.width));
    return part;
  }

  const std::vector<double>& log_row_;
  const std::vector<double>& log_column_;
  PairTable log_ratio_;
  std::vector<double> row_scale_, column_scale_;
  std::vector<Pair> order_;
  bool sorted_ = false;
  size_t dropped_ = 0;
  double bound_ = 0;
};

}  // namespace

std::vector<std::vector<size_t>> rows_of_columns(const IdentityComponent& component) {
  std::vector<std::vector<size_t>> rows_of(component.columns.size());
  for (size_t j = 0; j < rows_of.size(); ++j)
    for (size_t i = 0; i < component.rows.size(); ++i)
      if (component.log_ratio(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) != kNever)
        rows_of[j].push_back(i);
  return rows_of;
}

IdentityComponents split(const PairTable& log_pair, const std::vector<double>& log_row,
                         const std::vector<double>& log_column, double budget, size_t max_width) {
  Splitter splitter(log_pair, log_row, log_column);
  splitter.gate(budget);
  IdentityComponents components = splitter.components();
  const auto is_wide = [&](const IdentityComponent& part) { return part.order.width > max_width; };
  const double most = static_cast<double>(log_pair.size());
  for (double enlarged = std::max(1.25 * budget, 1e-12);
       std::any_of(components.parts.begin(), components.parts.end(), is_wide); enlarged *= 1.25) {
    if (enlarged > 4 * most)
      throw Error("invalid_value: more than " + std::to_string(max_width) +
                  " things that must all be matched depend on each other");
    splitter.gate(enlarged);
    components = splitter.components();
  }
  return components;
}

}  // namespace loci::memory
