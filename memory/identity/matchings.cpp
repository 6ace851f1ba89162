#include "memory/identity/matchings.h"

#include <algorithm>

namespace loci::memory {
namespace {

constexpr double kForbidden = std::numeric_limits<double>::infinity();
/// Makes the assignment prefer what uses a column that must be matched; far above any sum of log odds.
constexpr double kMustMatch = 1e7;

/// Each row takes a column or its own dummy (columns n, n+1, …: unmatched). Costs are negative log odds.
class Assignment {
 public:
  explicit Assignment(const IdentityComponent& component)
      : rows_(component.rows.size()),
        real_columns_(component.columns.size()),
        columns_(rows_ + real_columns_) {
    cost_.assign(rows_ * columns_, kForbidden);
    for (size_t i = 0; i < rows_; ++i) {
      for (size_t j = 0; j < real_columns_; ++j) {
        const double ratio = component.log_ratio(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        if (ratio == kNever) continue;
        cost(i, j) = -ratio - (component.column_free[j] ? 0 : kMustMatch);
      }
      if (component.row_free[i]) cost(i, real_columns_ + i) = 0;
    }
    for (size_t j = 0; j < real_columns_; ++j)
      if (!component.column_free[j]) must_.push_back(j);
  }

  struct State {
    std::vector<size_t> column_of;  ///< per row
    std::vector<size_t> row_of;     ///< per column, kNone = free
    std::vector<double> row_dual, column_dual;
  };
  static constexpr size_t kNone = static_cast<size_t>(-1);

  State empty() const {
    return {std::vector<size_t>(rows_, kNone), std::vector<size_t>(columns_, kNone),
            std::vector<double>(rows_, 0.0), std::vector<double>(columns_, 0.0)};
  }

  /// The lightest assignment in which rows before `fixed` have the columns that `state` gives them and row
  /// `fixed` has none of the banned ones. False when there is none.
  bool solve(State& state, size_t fixed, const std::vector<size_t>& banned) const {
    State fresh = empty();
    for (size_t i = 0; i < fixed; ++i) {
      fresh.column_of[i] = state.column_of[i];
      fresh.row_of[state.column_of[i]] = i;
    }
    state = std::move(fresh);
    for (size_t i = fixed; i < rows_; ++i)
      if (!augment(state, i, fixed, banned)) return false;
    return complete(state);
  }

  size_t rows() const { return rows_; }

 private:
  /// Finds a column for a free row, moving others aside (shortest augmenting path).
  bool augment(State& state, size_t row, size_t fixed, const std::vector<size_t>& banned) const {
    std::vector<double> distance(columns_, kForbidden);
    std::vector<size_t> from(columns_, kNone);
    std::vector<bool> done(columns_, false);
    for (size_t i = 0; i < fixed; ++i) done[state.column_of[i]] = true;
    std::vector<size_t> tree;
    size_t at = row, end = kNone;
    double length = 0;
    while (end == kNone) {
      size_t next = kNone;
      for (size_t j = 0; j < columns_; ++j) {
        if (done[j]) continue;
        const double edge = cost(at, j);
        const bool allowed =
            edge != kForbidden && (at != fixed || std::find(banned.begin(), banned.end(), j) == banned.end());
        if (allowed) {
          const double through = length + edge - state.row_dual[at] - state.column_dual[j];
          if (through < distance[j]) {
            distance[j] = through;
            from[j] = at;
          }
        }
        if (distance[j] != kForbidden && (next == kNone || distance[j] < distance[next])) next = j;
      }
      if (next == kNone) return false;
      done[next] = true;
      length = distance[next];
      tree.push_back(next);
      if (state.row_of[next] == kNone)
        end = next;
      else
        at = state.row_of[next];
    }
    update_duals(state, row, tree, distance, length);
    while (end != kNone) {
      const size_t owner = from[end];
      std::swap(state.column_of[owner], end);
      state.row_of[state.column_of[owner]] = owner;
      if (owner == row) break;
    }
    return true;
  }

  /// Whether every column that must be matched is.
  bool complete(const State& state) const {
    return std::all_of(must_.begin(), must_.end(), [&](size_t j) { return state.row_of[j] != kNone; });
  }
  double& cost(size_t i, size_t j) { return cost_[i * columns_ + j]; }
  double cost(size_t i, size_t j) const { return cost_[i * columns_ + j]; }

  static void update_duals(State& state, size_t row, const std::vector<size_t>& tree,
                           const std::vector<double>& distance, double length) {
    state.row_dual[row] += length;
    for (const size_t j : tree) {
      const double slack = length - distance[j];
      state.column_dual[j] -= slack;
      if (state.row_of[j] != kNone) state.row_dual[state.row_of[j]] += slack;
    }
  }

  size_t rows_, real_columns_, columns_;
  std::vector<double> cost_;
  std::vector<size_t> must_;
};

/// A part of the space of matchings with its heaviest member: rows before `fixed` are as in the member, row
/// `fixed` does not take a banned column.
struct Node {
  Assignment::State state;
  size_t fixed = 0;
  std::vector<size_t> banned;
  double log_weight = 0;
};

double log_weight(const IdentityComponent& component, const Assignment::State& state) {
  double sum = component.log_scale;
  for (size_t i = 0; i < component.rows.size(); ++i)
    if (state.column_of[i] < component.columns.size())
      sum += component.log_ratio(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(state.column_of[i]));
  return sum;
}

Matching matching_of(const IdentityComponent& component, const Node& node) {
  Matching matching;
  matching.log_weight = node.log_weight;
  for (size_t i = 0; i < component.rows.size(); ++i) {
    const size_t j = node.state.column_of[i];
    if (j >= component.columns.size()) continue;
    const size_t row = component.rows[i], column = component.columns[j];
    matching.pairs.emplace_back(component.transposed ? column : row, component.transposed ? row : column);
  }
  std::sort(matching.pairs.begin(), matching.pairs.end());
  return matching;
}

bool heavier(const Matching& a, const Matching& b) {
  return a.log_weight != b.log_weight ? a.log_weight > b.log_weight : a.pairs < b.pairs;
}

}  // namespace

std::vector<Matching> ranked_matchings(const IdentityComponent& component, size_t count) {
  const Assignment assignment(component);
  Node root;
  root.state = assignment.empty();
  if (!assignment.solve(root.state, 0, {})) throw Error("invalid_value: no matching is possible");
  root.log_weight = log_weight(component, root.state);

  const auto lighter = [](const Node& a, const Node& b) { return a.log_weight < b.log_weight; };
  std::vector<Node> open;
  open.push_back(std::move(root));
  std::vector<Matching> result;
  while (!open.empty() && result.size() < count) {
    std::pop_heap(open.begin(), open.end(), lighter);
    const Node node = std::move(open.back());
    open.pop_back();
    result.push_back(matching_of(component, node));
    if (result.size() == count) break;
    for (size_t i = node.fixed; i < assignment.rows(); ++i) {
      Node child{node.state, i, {}, 0};
      if (i == node.fixed) child.banned = node.banned;
      child.banned.push_back(node.state.column_of[i]);
      if (!assignment.solve(child.state, i, child.banned)) continue;
      child.log_weight = log_weight(component, child.state);
      open.push_back(std::move(child));
      std::push_heap(open.begin(), open.end(), lighter);
    }
  }
  return result;
}

std::vector<Matching> combine(const std::vector<Matching>& a, const std::vector<Matching>& b, size_t count) {
  std::vector<Matching> result;
  for (size_t i = 0; i < a.size(); ++i)
    // The combination (i, j) is beaten by all (i', j') with i' <= i and j' <= j.
    for (size_t j = 0; j < b.size() && (i + 1) * (j + 1) <= count; ++j) {
      Matching both = a[i];
      both.log_weight += b[j].log_weight;
      both.pairs.insert(both.pairs.end(), b[j].pairs.begin(), b[j].pairs.end());
      result.push_back(std::move(both));
    }
  std::stable_sort(result.begin(), result.end(), heavier);
  if (result.size() > count) result.resize(count);
  return result;
}

}  // namespace loci::memory
