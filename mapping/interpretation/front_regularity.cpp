#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/front_layout.h"

namespace loci::mapping {
namespace {

constexpr double kStep = 0.01;           // m; of possible edges
constexpr double kStyleStep = 0.005;     // m
constexpr double kFrame = 2.5;           // cost of a frame beside the outermost fronts
constexpr double kMinMargin = 0.01;      // m between a fixture and the edge of its front
constexpr double kHandWidth = 0.06;      // m; what an upright handle or knob takes at least
constexpr double kPartedColumns = 0.12;  // m between fixtures of neighbouring columns
constexpr double kLikeDistance = 0.012;  // m; how alike fixtures of a column are mounted
constexpr double kMaxUnlike = 4;         // cost of one that is not

/// What neighbours share along one direction: the fixtures of each group, in order.
using Groups = std::vector<std::vector<size_t>>;

Groups groups_along(const std::vector<FaceFixture>& fixtures, const std::vector<size_t>& inside, bool u) {
  const auto low = [&](size_t i) {
    return u ? std::min(fixtures[i].box.u0, fixtures[i].u - kHandWidth / 2)
             : std::min(fixtures[i].box.v0, fixtures[i].v - kHandWidth / 4);
  };
  const auto high = [&](size_t i) {
    return u ? std::max(fixtures[i].box.u1, fixtures[i].u + kHandWidth / 2)
             : std::max(fixtures[i].box.v1, fixtures[i].v + kHandWidth / 4);
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
  Divider(const SeamMap& seams, const Face& face, const std::vector<FaceFixture>& fixtures)
      : seams_(seams), face_(face), fixtures_(fixtures) {}

  std::vector<PlacedFront> divide(const PlacedFront& part, const std::vector<size_t>& inside) {
    if (inside.size() == 1) {
      PlacedFront front = part;
      front.fixture = static_cast<int>(inside[0]);
      front.confidence = 0.5;
      return {front};
    }
    const Groups columns = groups_along(fixtures_, inside, true);
    const Groups rows = groups_along(fixtures_, inside, false);
    if (columns.size() < 2 && rows.size() < 2) return {};  // they are one before the other: no layout
    bool by_columns = rows.size() < 2;
    if (columns.size() > 1 && rows.size() > 1) {
      double nearest = 1e9;
      for (size_t i = 1; i < columns.size(); ++i)
        nearest = std::min(nearest, extent(columns[i], true).first - extent(columns[i - 1], true).second);
      by_columns = nearest > kPartedColumns;
    }
    return by_columns ? apply(part, columns, true) : apply(part, rows, false);
  }

 private:
  std::pair<double, double> extent(const std::vector<size_t>& group, bool u) const {
    double low = 1e9;
    double high = -1e9;
    for (const size_t i : group) {
      low = std::min(low, u ? fixtures_[i].box.u0 : fixtures_[i].box.v0);
      high = std::max(high, u ? fixtures_[i].box.u1 : fixtures_[i].box.v1);
    }
    return {low, high};
  }

  /// How unlikely fronts of a group are, if it spans [low, high] along the direction of division.
  double cost(const FaceRect& rect, const std::vector<size_t>& group, bool u, double low, double high) const {
    double sum = 0;
    for (const size_t i : group) {
      FaceRect own = rect;
      (u ? own.u0 : own.v0) = low;
      (u ? own.u1 : own.v1) = high;
      if (group.size() > 1) {  // a guess at the rest of the division: as high as there is room for
        if (u) {
          const double each = rect.height() / static_cast<double>(group.size()) / 2;
          own.v0 = fixtures_[i].v - each;
          own.v1 = fixtures_[i].v + each;
        } else {
          const double each = rect.width() / static_cast<double>(group.size()) / 2;
          own.u0 = fixtures_[i].u - each;
          own.u1 = fixtures_[i].u + each;
        }
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

  /// What a seam that is too weak to cut there still says, as a gain.
  double gain(const FaceRect& rect, bool u, double position) const {
    const LineEvidence line =
        u ? seams_.upright(position, rect.v0, rect.v1) : seams_.level(position, rect.u0, rect.u1);
    if (line.share < 0.3) return 0;
    const double z = std::clamp(line.z - 2, 0.0, 4.0);
    return z * z / 2;
  }

  /// Where the edges of the groups may be: the first and last within the part (a frame may remain beside
  /// them), the others between neighbours.
  std::vector<std::vector<double>> possible_edges(const FaceRect& rect, const Groups& groups, bool u) const {
    std::vector<std::vector<double>> positions;
    for (size_t i = 0; i <= groups.size(); ++i) {
      const double first = i == 0 ? (u ? rect.u0 : rect.v0) : extent(groups[i - 1], u).second + kMinMargin;
      const double last =
          i == groups.size() ? (u ? rect.u1 : rect.v1) : extent(groups[i], u).first - kMinMargin;
      std::vector<double> possible;
      if (i == groups.size())
        for (double p = last; p > first; p -= kStep) possible.push_back(p);
      else
        for (double p = first; p < last; p += kStep) possible.push_back(p);
      if (possible.empty())
        possible.push_back(i == groups.size() ? last : i == 0 ? first : (first + last) / 2);
      positions.push_back(possible);
    }
    return positions;
  }

  /// Costs of every group by its two edges, [group][first edge][last edge], without what styles add.
  std::vector<std::vector<std::vector<double>>> costs_of(
      const FaceRect& rect, const Groups& groups, bool u,
      const std::vector<std::vector<double>>& positions) const {
    std::vector<std::vector<std::vector<double>>> costs(groups.size());
    for (size_t i = 0; i < groups.size(); ++i)
      for (size_t k = 0; k < positions[i].size(); ++k) {
        costs[i].emplace_back();
        for (size_t m = 0; m < positions[i + 1].size(); ++m) {
          double value = cost(rect, groups[i], u, positions[i][k], positions[i + 1][m]);
          if (i == 0 && k > 0) value += kFrame;
          if (i + 1 == groups.size() && m > 0) value += kFrame;
          if (i + 1 < groups.size()) value -= gain(rect, u, positions[i + 1][m]);
          costs[i].back().push_back(value);
        }
      }
    return costs;
  }

  /// The cheapest edges by dynamic programming; `style` is the distance of the upper edge from the fixture
  /// that the fronts share, 0: they have it in the middle, negative: they share nothing.
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
          const double value =
              best[i][k] + costs[i][k][m] + unlike(groups[i], u, positions[i][k], positions[i + 1][m], style);
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

  double unlike(const std::vector<size_t>& group, bool u, double low, double high, double style) const {
    if (u || style < 0) return 0;
    double sum = 0;
    for (const size_t i : group) {
      const double distance = style > 0 ? high - fixtures_[i].v - style : (low + high) / 2 - fixtures_[i].v;
      sum += std::min(0.5 * distance * distance / (kLikeDistance * kLikeDistance), kMaxUnlike);
    }
    return sum;
  }

  std::vector<PlacedFront> apply(const PlacedFront& part, const Groups& groups, bool u) {
    const std::vector<std::vector<double>> positions = possible_edges(part.rect, groups, u);
    const auto costs = costs_of(part.rect, groups, u, positions);
    double least = 0;
    std::vector<double> edges = edges_between(groups, u, -1, positions, costs, least);
    if (!u) {
      least += kMaxUnlike * static_cast<double>(groups.size());
      for (double style = 0; style < 0.15; style += kStyleStep) {
        double total = 0;
        const std::vector<double> styled = edges_between(groups, u, style, positions, costs, total);
        if (total < least) least = total, edges = styled;
      }
    }
    std::vector<PlacedFront> fronts;
    for (size_t i = 0; i < groups.size(); ++i) {
      PlacedFront piece = part;
      (u ? piece.rect.u0 : piece.rect.v0) = edges[i];
      (u ? piece.rect.u1 : piece.rect.v1) = edges[i + 1];
      const size_t first = u ? 0 : 2;
      const FrontEdge regular{FrontEdge::Kind::regular, 0, false, 0};
      const double low = u ? part.rect.u0 : part.rect.v0;
      const double high = u ? part.rect.u1 : part.rect.v1;
      if (edges[i] > low + kStep / 2) piece.edges[first] = regular;
      if (edges[i + 1] < high - kStep / 2) piece.edges[first + 1] = regular;
      const std::vector<PlacedFront> own = divide(piece, groups[i]);
      fronts.insert(fronts.end(), own.begin(), own.end());
    }
    return fronts;
  }

  const SeamMap& seams_;
  const Face& face_;
  const std::vector<FaceFixture>& fixtures_;
};

}  // namespace

std::vector<PlacedFront> divide_evenly(const SeamMap& seams, const Face& face, const PlacedFront& part,
                                       const std::vector<FaceFixture>& fixtures,
                                       const std::vector<size_t>& inside) {
  return Divider(seams, face, fixtures).divide(part, inside);
}

}  // namespace loci::mapping
