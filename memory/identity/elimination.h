#pragma once

#include <cstddef>
#include <vector>

namespace loci::memory {

/// In which order the columns of a sparse table are summed out. A row is open from the first of its columns
/// to the last; only which of the open rows are taken has to be remembered on the way.
struct EliminationOrder {
  std::vector<size_t> columns;
  size_t width = 0;  ///< most rows that are open at a time
};

/// An order that keeps few rows open, found greedily from several columns with few pairs: the next column is
/// the one after which the fewest rows are open (ties: the one that opens fewer, then by index).
/// `rows_of_column` lists the rows that each column has a pair with, all below `rows`.
EliminationOrder elimination_order(const std::vector<std::vector<size_t>>& rows_of_column, size_t rows);

}  // namespace loci::memory
