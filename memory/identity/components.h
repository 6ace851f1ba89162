#pragma once

#include <vector>

#include "memory/identity/elimination.h"
#include "memory/identity/problem.h"

namespace loci::memory {

/// A connected part of the problem, oriented so that its rows are the smaller side, with every row and column
/// divided by the weight of leaving it unmatched: those weights are then 1 (or 0 where it must be matched).
struct IdentityComponent {
  bool transposed = false;   ///< rows are observations, columns are objects
  std::vector<size_t> rows;  ///< indexes in the whole problem
  std::vector<size_t> columns;
  PairTable log_ratio;         ///< rows × columns: log weight over the two scales; kNever = no pair
  std::vector<bool> row_free;  ///< may stay unmatched
  std::vector<bool> column_free;
  double log_scale = 0;    ///< log of the product of all scales
  EliminationOrder order;  ///< of the columns
};

/// Per column the rows that it has a pair with.
std::vector<std::vector<size_t>> rows_of_columns(const IdentityComponent& component);

struct IdentityComponents {
  std::vector<IdentityComponent> parts;  ///< includes single rows and columns only if they must be matched
  double log_alone = 0;                  ///< log weight of what has no partner at all
  double gate_bound = 0;
};

/// `log_pair` old × new, `log_row` and `log_column` of staying unmatched. Drops pairs by ascending odds
/// within the budget, and beyond it as long as a part's elimination order is wider than `max_width`.
IdentityComponents split(const PairTable& log_pair, const std::vector<double>& log_row,
                         const std::vector<double>& log_column, double budget, size_t max_width = 20);

}  // namespace loci::memory
