#include <algorithm>
#include <limits>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/fronts/front_layout.h"
#include "mapping/interpretation/fronts/parameters.h"

namespace loci::mapping {
namespace {

/// Fixtures grouped along one direction, in order.
using Groups = std::vector<std::vector<size_t>>;

/// `hand`: how wide a fixture is taken for at least, metres.
Groups groups_along(const std::vector<FaceFixture>& fixtures, const std::vector<size_t>& inside, bool u,
                    double hand) {
  const double half = hand / (u ? 2 : 4);
  const auto low = [&](size_t i) {
    return std::min(fixtures[i].box.low(u), (u ? fixtures[i].u : fixtures[i].v) - half);
  };
  const auto high = [&](size_t i) {
    return std::max(fixtures[i].box.high(u), (u ? fixtures[i].u : fixtures[i].v) + half);
  };
  std::vector<size_t> order = inside;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return low(a) < low(b); });
  Groups groups;
  double end = -1e9;
  for (const size_t i : order) {
    if (low(i) > end) groups.emplace_back();
    groups.back().push_back(i);
    end = std::max(end, high(i));
  }
  return groups;
}

class Divider {
 public:
  Divider(const SeamMap& seams, const FurnitureFace& face, const std::vector<FaceFixture>& fixtures)
      : seams_(seams), face_(face), fixtures_(fixtures) {}

  std::vector<PlacedFront> divide(const PlacedFront& part, const std::vector<size_t>& inside) {
    if (inside.size() == 1) {
      PlacedFront front = part;
      front.fixture = static_cast<int>(inside[0]);
      front.confidence = kDivision.confidence * front.edge_confidence();
      return {front};
    }
    Groups columns = groups_along(fixtures_, inside, true, kDivision.hand_m);
    const Groups rows = groups_along(fixtures_, inside, false, kDivision.hand_m);
    // Bars where two doors meet may leave less space.
    if (columns.size() < 2 && rows.size() < 2) columns = groups_along(fixtures_, inside, true, 0);
    if (columns.size() < 2 && rows.size() < 2) return {};  // they overlap: no layout
    if (rows.size() < 2) return apply(part, columns, true).fronts;
    Division by_rows = apply(part, rows, false);
    if (columns.size() < 2) return by_rows.fronts;
    Division by_columns = apply(part, columns, true);
    return std::move(by_columns.cost < by_rows.cost ? by_columns : by_rows).fronts;
  }

 private:
  std::pair<double, double> extent(const std::vector<size_t>& group, bool u) const {
    double low = 1e9;
    double high = -1e9;
    for (const size_t i : group) {
      low = std::min(low, fixtures_[i].box.low(u));
      high = std::max(high, fixtures_[i].box.high(u));
    }
    return {low, high};
  }

  /// Negative log likelihood of the fronts of a group that spans [low, high] along the direction of division.
  double cost(const FaceRect& rect, const std::vector<size_t>& group, bool u, double low, double high) const {
    double sum = 0;
    for (const size_t i : group) {
      FaceRect own = rect;
      own.low(u) = low;
      own.high(u) = high;
      if (group.size() > 1) {  // a guess at the rest of the division: even
        const double each = (u ? rect.height() : rect.width()) / static_cast<double>(group.size()) / 2;
        const double middle = u ? fixtures_[i].v : fixtures_[i].u;
        own.low(!u) = middle - each;
        own.high(!u) = middle + each;
      }
      Front front;
      front.centre = face_.at(own.u(), own.v());
      front.normal = face_.normal3();
      front.width = own.width();
      front.height = own.height();
      front.fixture = fixtures_[i].fixture;
      sum -= front_log_likelihood(front);
    }
    return sum;
  }

  /// Log likelihood gain of a seam that is too weak for a cut.
  double gain(const FaceRect& rect, bool u, double position) const {
    const LineEvidence line = seams_.line(u, position, rect.low(!u), rect.high(!u));
    if (line.share < 0.3) return 0;
    const double z = std::clamp(line.z - 2, 0.0, 4.0);
    return z * z / 2;
  }

  /// Possible edges of the groups: the first and last within the part (a frame may remain beside them), the
  /// others between neighbours.
  std::vector<std::vector<double>> possible_edges(const FaceRect& rect, const Groups& groups, bool u) const {
    std::vector<std::vector<double>> positions;
    for (size_t i = 0; i <= groups.size(); ++i) {
      const double first = i == 0 ? rect.low(u) : extent(groups[i - 1], u).second + kDivision.min_margin_m;
      const double last =
          i == groups.size() ? rect.high(u) : extent(groups[i], u).first - kDivision.min_margin_m;
      std::vector<double> possible;
      if (i == groups.size())
        for (double p = last; p > first; p -= kDivision.step_m) possible.push_back(p);
      else
        for (double p = first; p < last; p += kDivision.step_m) possible.push_back(p);
      if (possible.empty())
        possible.push_back(i == groups.size() ? last : i == 0 ? first : (first + last) / 2);
      positions.push_back(possible);
    }
    return positions;
  }

  /// Costs of every group by its two edges, [group][first edge][last edge], without style costs.
  std::vector<std::vector<std::vector<double>>> costs_of(
      const FaceRect& rect, const Groups& groups, bool u,
      const std::vector<std::vector<double>>& positions) const {
    std::vector<std::vector<std::vector<double>>> costs(groups.size());
    for (size_t i = 0; i < groups.size(); ++i)
      for (size_t k = 0; k < positions[i].size(); ++k) {
        costs[i].emplace_back();
        for (size_t m = 0; m < positions[i + 1].size(); ++m) {
          double value = cost(rect, groups[i], u, positions[i][k], positions[i + 1][m]);
          if (i == 0 && k > 0) value += kDivision.frame_cost;
          if (i + 1 == groups.size() && m > 0) value += kDivision.frame_cost;
          if (i + 1 < groups.size()) value -= gain(rect, u, positions[i + 1][m]);
          costs[i].back().push_back(value);
        }
      }
    return costs;
  }

  /// The cheapest edges by dynamic programming. `style`: the common distance of the upper edges from the
  /// fixtures; 0: fixtures in the middle, negative: no common style.
  std::vector<double> edges_between(const Groups& groups, bool u, double style,
                                    const std::vector<std::vector<double>>& positions,
                                    const std::vector<std::vector<std::vector<double>>>& costs,
                                    double& total) const {
    std::vector<std::vector<double>> best{std::vector<double>(positions[0].size(), 0)};
    std::vector<std::vector<size_t>> from{std::vector<size_t>(positions[0].size(), 0)};
    for (size_t i = 0; i < groups.size(); ++i) {
      best.emplace_back(positions[i + 1].size(), std::numeric_limits<double>::max());
      from.emplace_back(positions[i + 1].size(), 0);
      for (size_t m = 0; m < positions[i + 1].size(); ++m)
        for (size_t k = 0; k < positions[i].size(); ++k) {
          const double value = best[i][k] + costs[i][k][m] +
                               style_cost(groups[i], u, positions[i][k], positions[i + 1][m], style);
          if (value < best[i + 1][m]) best[i + 1][m] = value, from[i + 1][m] = k;
        }
    }
    const auto cheapest = std::min_element(best.back().begin(), best.back().end());
    total = *cheapest;
    auto at = static_cast<size_t>(cheapest - best.back().begin());
    std::vector<double> edges(groups.size() + 1);
    for (size_t i = groups.size() + 1; i-- > 0;) {
      edges[i] = positions[i][at];
      at = from[i][at];
    }
    return edges;
  }

  double style_cost(const std::vector<size_t>& group, bool u, double low, double high, double style) const {
    if (u || style < 0) return 0;
    double sum = 0;
    for (const size_t i : group) {
      const double distance = style > 0 ? high - fixtures_[i].v - style : (low + high) / 2 - fixtures_[i].v;
      sum += std::min(0.5 * distance * distance / (kDivision.style_sd_m * kDivision.style_sd_m),
                      kDivision.max_style_cost);
    }
    return sum;
  }

  struct Division {
    double cost = 0;  ///< negative log likelihood, without style
    std::vector<PlacedFront> fronts;
  };

  /// The cost of given edges.
  static double cost_of(const std::vector<double>& edges, const std::vector<std::vector<double>>& positions,
                        const std::vector<std::vector<std::vector<double>>>& costs) {
    const auto index = [&](size_t i) {
      return static_cast<size_t>(std::ranges::find(positions[i], edges[i]) - positions[i].begin());
    };
    double sum = 0;
    for (size_t i = 0; i < costs.size(); ++i) sum += costs[i][index(i)][index(i + 1)];
    return sum;
  }

  Division apply(const PlacedFront& part, const Groups& groups, bool u) {
    const std::vector<std::vector<double>> positions = possible_edges(part.rect, groups, u);
    const auto costs = costs_of(part.rect, groups, u, positions);
    double min_cost = 0;
    std::vector<double> edges = edges_between(groups, u, -1, positions, costs, min_cost);
    if (!u) {
      min_cost += kDivision.max_style_cost * static_cast<double>(groups.size());
      for (double style = 0; style < 0.15; style += kDivision.style_step_m) {
        double total = 0;
        const std::vector<double> styled = edges_between(groups, u, style, positions, costs, total);
        if (total < min_cost) min_cost = total, edges = styled;
      }
    }
    Division division{cost_of(edges, positions, costs), {}};
    for (size_t i = 0; i < groups.size(); ++i) {
      PlacedFront piece = part;
      piece.rect.low(u) = edges[i];
      piece.rect.high(u) = edges[i + 1];
      const size_t first = u ? 0 : 2;
      const FrontEdge regular{FrontEdge::Kind::regular, 0, false, 0};
      if (edges[i] > part.rect.low(u) + kDivision.step_m / 2) piece.edges[first] = regular;
      if (edges[i + 1] < part.rect.high(u) - kDivision.step_m / 2) piece.edges[first + 1] = regular;
      const std::vector<PlacedFront> own = divide(piece, groups[i]);
      division.fronts.insert(division.fronts.end(), own.begin(), own.end());
    }
    return division;
  }

  const SeamMap& seams_;
  const FurnitureFace& face_;
  const std::vector<FaceFixture>& fixtures_;
};

}  // namespace

std::vector<PlacedFront> divide_evenly(const SeamMap& seams, const FurnitureFace& face,
                                       const PlacedFront& part, const std::vector<FaceFixture>& fixtures,
                                       const std::vector<size_t>& inside) {
  return Divider(seams, face, fixtures).divide(part, inside);
}

}  // namespace loci::mapping
