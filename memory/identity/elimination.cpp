#include "memory/identity/elimination.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace loci::memory {
namespace {

class Elimination {
 public:
  Elimination(const std::vector<std::vector<size_t>>& rows_of_column, size_t rows)
      : rows_of_column_(rows_of_column), left_(rows, 0), is_open_(rows, false) {
    for (const std::vector<size_t>& column : rows_of_column_)
      for (const size_t row : column) ++left_[row];
  }

  EliminationOrder from(size_t first) {
    std::vector<bool> done(rows_of_column_.size(), false);
    EliminationOrder order;
    for (size_t next = first; next < done.size(); next = best(done)) {
      done[next] = true;
      take(next);
      order.columns.push_back(next);
      order.width = std::max(order.width, most_open_);
    }
    return order;
  }

 private:
  void take(size_t column) {
    for (const size_t row : rows_of_column_[column])
      if (!is_open_[row]) {
        is_open_[row] = true;
        ++open_;
      }
    most_open_ = open_;
    for (const size_t row : rows_of_column_[column])
      if (--left_[row] == 0) --open_;
  }

  size_t best(const std::vector<bool>& done) const {
    size_t best = done.size();
    std::pair<long, long> least;
    for (size_t column = 0; column < done.size(); ++column) {
      if (done[column]) continue;
      long opened = 0, closed = 0;
      for (const size_t row : rows_of_column_[column]) {
        opened += is_open_[row] ? 0 : 1;
        closed += left_[row] == 1 ? 1 : 0;
      }
      const std::pair<long, long> cost{opened - closed, opened};
      if (best == done.size() || cost < least) {
        best = column;
        least = cost;
      }
    }
    return best;
  }

  const std::vector<std::vector<size_t>>& rows_of_column_;
  std::vector<size_t> left_;  ///< per row: columns that are still to come
  std::vector<bool> is_open_;
  size_t open_ = 0;
  size_t most_open_ = 0;
};

}  // namespace

EliminationOrder elimination_order(const std::vector<std::vector<size_t>>& rows_of_column, size_t rows) {
  constexpr size_t kStarts = 8;
  constexpr size_t kNarrow = 6;  // costs less than the search for a better order
  std::vector<size_t> starts(rows_of_column.size());
  std::iota(starts.begin(), starts.end(), size_t{0});
  std::stable_sort(starts.begin(), starts.end(),
                   [&](size_t a, size_t b) { return rows_of_column[a].size() < rows_of_column[b].size(); });
  starts.resize(std::min(starts.size(), kStarts));
  EliminationOrder best;
  for (const size_t start : starts) {
    EliminationOrder order = Elimination(rows_of_column, rows).from(start);
    if (best.columns.empty() || order.width < best.width) best = std::move(order);
    if (best.width <= kNarrow) break;
  }
  return best;
}

}  // namespace loci::memory
