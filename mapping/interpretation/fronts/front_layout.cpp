#include "mapping/interpretation/fronts/front_layout.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "mapping/interpretation/fronts/parameters.h"

namespace loci::mapping {
namespace {

enum Side : size_t { left, right, bottom, top };

Side low_side(bool upright) {
  return upright ? left : bottom;
}
Side high_side(bool upright) {
  return upright ? right : top;
}

/// Trims rows and columns without face at the border.
void shrink(const SeamMap& seams, PlacedFront& part, double min_face) {
  const auto trim = [min_face](const std::vector<std::array<float, 2>>& shares) {
    const auto good = [min_face](const std::array<float, 2>& s) {
      return s[0] >= static_cast<float>(kLayout.min_known) && s[1] >= static_cast<float>(min_face);
    };
    const auto first = std::find_if(shares.begin(), shares.end(), good);
    const auto last = std::find_if(shares.rbegin(), shares.rend(), good);
    return std::pair<double, double>(static_cast<double>(first - shares.begin()) * kFaces.cell_m,
                                     static_cast<double>(last - shares.rbegin()) * kFaces.cell_m);
  };
  for (int round = 0; round < 2; ++round) {
    FaceRect& rect = part.rect;
    if (rect.width() <= 0 || rect.height() <= 0) return;
    const auto [l, r] = trim(seams.coverage_of(rect, true));
    rect.u0 += l;
    rect.u1 -= r;
    if (rect.width() <= 0) return;
    const auto [b, t] = trim(seams.coverage_of(rect, false));
    rect.v0 += b;
    rect.v1 -= t;
    const double trimmed[4] = {l, r, b, t};
    for (size_t side = 0; side < 4; ++side)
      if (trimmed[side] > 2 * kFaces.cell_m) part.edges[side] = {};
  }
}

/// The widest strip across a part without face: a protruding object or a hole. A narrow strip that no ray met
/// is no gap: a front continues behind the leg of a table.
std::optional<std::pair<double, double>> widest_gap(const std::vector<std::array<float, 2>>& shares,
                                                    double start) {
  std::optional<std::pair<double, double>> widest;
  size_t begin = 0;
  size_t open = 0;  // of the strip so far, seen and no face
  for (size_t i = 0; i <= shares.size(); ++i) {
    const bool known = i < shares.size() && shares[i][0] >= static_cast<float>(kLayout.min_known);
    const bool face =
        i == shares.size() || (known && shares[i][1] >= static_cast<float>(kLayout.min_cut_face));
    if (!face) {
      open += known ? 1 : 0;
      continue;
    }
    const double width = static_cast<double>(i - begin) * kFaces.cell_m;
    const bool parts =
        static_cast<double>(open) * kFaces.cell_m > kLayout.min_gap_m || width > kLayout.max_hidden_m;
    if (begin > 0 && i < shares.size() && parts && (!widest || width > widest->second - widest->first))
      widest = {start + static_cast<double>(begin) * kFaces.cell_m,
                start + static_cast<double>(i) * kFaces.cell_m};
    begin = i + 1;
    open = 0;
  }
  return widest;
}

struct Cut {
  bool upright = true;
  LineEvidence line;
};

/// Whether a line through a part would cut one of its fixtures.
bool cuts_fixture(const FaceRect& rect, bool upright, double position,
                  const std::vector<FaceFixture>& fixtures) {
  return std::any_of(fixtures.begin(), fixtures.end(), [&](const FaceFixture& fixture) {
    const FaceRect box = fixture.box.grown(kLayout.fixture_gap_m);
    return rect.contains(fixture.u, fixture.v) &&
           (upright ? position > box.u0 && position < box.u1 : position > box.v0 && position < box.v1);
  });
}

/// Significant lines through a part, the strongest first.
std::vector<Cut> possible_cuts(const SeamMap& seams, const FaceRect& rect,
                               const std::vector<FaceFixture>& fixtures) {
  std::vector<Cut> cuts;
  for (const bool upright : {true, false}) {
    for (double p = rect.low(upright) + kLayout.min_side_m; p < rect.high(upright) - kLayout.min_side_m;
         p += kFaces.cell_m) {
      const LineEvidence line = seams.line(upright, p, rect.low(!upright), rect.high(!upright));
      if (line.z < kLayout.min_z || line.share < kLayout.min_share || line.weakest < kLayout.min_weakest)
        continue;
      if (!cuts_fixture(rect, upright, p, fixtures)) cuts.push_back({upright, line});
    }
  }
  std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.line.z > b.line.z; });
  return cuts;
}

/// The strongest line whose exact position is well inside the part: the part's own edges show inside it, too.
std::optional<Cut> strongest_cut(const SeamMap& seams, const FaceRect& rect,
                                 const std::vector<FaceFixture>& fixtures) {
  std::vector<Cut> cuts = possible_cuts(seams, rect, fixtures);
  while (!cuts.empty()) {
    Cut cut = cuts.front();
    const double found = cut.line.position;
    cut.line = seams.refine(cut.upright, cut.line, rect.low(!cut.upright), rect.high(!cut.upright));
    const double low = rect.low(cut.upright);
    const double high = rect.high(cut.upright);
    const double half = cut.line.width / 2;
    if (cut.line.position - half > low + kLayout.min_side_m / 2 &&
        cut.line.position + half < high - kLayout.min_side_m / 2 &&
        std::abs(cut.line.position - found) < kLayout.same_line_m)
      return cut;
    std::erase_if(cuts, [&](const Cut& other) {
      return other.upright == cut.upright && std::abs(other.line.position - found) < kFaces.cell_m * 1.5;
    });
  }
  return std::nullopt;
}

/// What the cells of a strip across a part show, position by position: 1 for face, -1 for something behind
/// it, 0 for what no ray met.
std::vector<int> outline_of(const SeamMap& seams, const FaceRect& strip, bool upright) {
  std::vector<int> states;
  for (const auto& [known, face] : seams.coverage_of(strip, upright))
    states.push_back(known < static_cast<float>(kLayout.min_known)  ? 0
                     : face >= static_cast<float>(kLayout.min_seen) ? 1
                                                                    : -1);
  return states;
}

/// Where the outline of a part steps: a tall unit beside a row of low ones in the same plane. No seam runs
/// across such a part. Unset where no step is high enough, or where the part ends.
std::optional<double> outline_step(const SeamMap& seams, const FaceRect& rect, bool upright) {
  constexpr int kWindow = kLayout.outline_cells;
  const auto positions = static_cast<size_t>((rect.high(upright) - rect.low(upright)) / kFaces.cell_m);
  if (positions < size_t{2} * kWindow) return std::nullopt;
  std::vector<int> steps(positions, 0), both(positions, 0);
  const double strip_m = kSeams.chunk_cells * kFaces.cell_m;
  for (double from = rect.low(!upright); from + strip_m <= rect.high(!upright); from += strip_m) {
    FaceRect strip = rect;
    strip.low(!upright) = from;
    strip.high(!upright) = from + strip_m;
    const std::vector<int> states = outline_of(seams, strip, upright);
    std::vector<int> sums(states.size() + 1, 0);
    std::partial_sum(states.begin(), states.end(), sums.begin() + 1);
    for (size_t p = kWindow; p + kWindow <= std::min(positions, states.size()); ++p) {
      const int low = sums[p] - sums[p - kWindow];
      const int high = sums[p + kWindow] - sums[p];
      const auto clear = static_cast<int>(kLayout.outline_clear * kWindow);
      if (std::abs(low) < clear || std::abs(high) < clear) continue;
      if (low * high < 0) ++steps[p];
      if (low > 0 && high > 0) ++both[p];
    }
  }
  const auto highest = std::max_element(steps.begin(), steps.end());
  const auto p = static_cast<size_t>(highest - steps.begin());
  if (*highest * strip_m < kLayout.min_outline_step_m || both[p] * strip_m < kLayout.min_front_m)
    return std::nullopt;
  const auto last = std::find_if(highest, steps.end(), [&](int step) { return step < *highest; });
  const auto middle = static_cast<double>(p) + static_cast<double>(last - highest - 1) / 2;
  return rect.low(upright) + middle * kFaces.cell_m;
}

FrontEdge edge_of(const LineEvidence& line, double sign) {
  FrontEdge edge;
  edge.kind = line.kind == LineEvidence::Kind::seam ? FrontEdge::Kind::seam : FrontEdge::Kind::step;
  edge.z = line.z;
  edge.relief = line.relief;
  edge.rise = sign * line.rise;
  return edge;
}

class Layout {
 public:
  Layout(const SeamMap& seams, const FurnitureFace& face, const std::vector<FaceFixture>& fixtures)
      : seams_(seams), face_(face), fixtures_(fixtures), assigned_(fixtures.size(), false) {}

  FrontLayout run() {
    PlacedFront all;
    all.rect = seams_.grid().extent();
    cut(all, 0);
    add_overhung();
    drop_isolated();
    for (size_t i = 0; i < assigned_.size(); ++i)
      if (!assigned_[i]) result_.unassigned.push_back(i);
    return std::move(result_);
  }

 private:
  void cut(PlacedFront part, int depth) {
    shrink(seams_, part, kLayout.min_cut_face);
    if (part.rect.width() < kLayout.min_side_m || part.rect.height() < kLayout.min_side_m) return;
    if (depth < kLayout.max_depth && cut_gap(part, depth)) return;
    const std::optional<Cut> best =
        depth < kLayout.max_depth ? strongest_cut(seams_, part.rect, fixtures_) : std::nullopt;
    if (!best && depth < kLayout.max_depth && cut_outline(part, depth)) return;
    if (!best) return finish(part);
    const double half = best->line.width / 2;
    split(part, best->upright, best->line.position - half, best->line.position + half,
          edge_of(best->line, -1), edge_of(best->line, 1), depth);
  }

  bool cut_gap(const PlacedFront& part, int depth) {
    for (const bool upright : {false, true}) {
      const auto gap = widest_gap(seams_.coverage_of(part.rect, upright), part.rect.low(upright));
      if (!gap || cuts_fixture(part.rect, upright, (gap->first + gap->second) / 2, fixtures_)) continue;
      split(part, upright, gap->first, gap->second, {}, {}, depth);
      return true;
    }
    return false;
  }

  bool cut_outline(const PlacedFront& part, int depth) {
    for (const bool upright : {true, false}) {
      const std::optional<double> step = outline_step(seams_, part.rect, upright);
      if (!step || cuts_fixture(part.rect, upright, *step, fixtures_)) continue;
      split(part, upright, *step, *step, {}, {}, depth);
      return true;
    }
    return false;
  }

  /// Cuts both pieces of a part beside a line or gap.
  void split(const PlacedFront& part, bool upright, double low_end, double high_begin,
             const FrontEdge& low_edge, const FrontEdge& high_edge, int depth) {
    PlacedFront low = part;
    PlacedFront high = part;
    low.rect.high(upright) = low_end;
    high.rect.low(upright) = high_begin;
    low.edges[high_side(upright)] = low_edge;
    high.edges[low_side(upright)] = high_edge;
    cut(low, depth + 1);
    cut(high, depth + 1);
  }

  void finish(PlacedFront part) {
    shrink(seams_, part, kLayout.min_face);
    settle_edges(part);
    if (part.rect.width() < kLayout.min_front_m || part.rect.height() < kLayout.min_front_m) return;
    std::vector<size_t> inside;
    for (size_t i = 0; i < fixtures_.size(); ++i)
      if (part.rect.contains(fixtures_[i].u, fixtures_[i].v)) inside.push_back(i);
    const SeamMap::Coverage seen = seams_.coverage(part.rect);
    // What no ray met says nothing against a front that has a handle.
    if (inside.empty() ? seen.known * seen.face < kLayout.min_seen
                       : seen.face < kLayout.min_seen || seen.known * seen.face < kLayout.min_seen_fixed)
      return;
    for (const size_t i : inside) assigned_[i] = true;
    if (inside.size() > 1) {
      const std::vector<PlacedFront> fronts = divide_evenly(seams_, face_, part, fixtures_, inside);
      result_.fronts.insert(result_.fronts.end(), fronts.begin(), fronts.end());
      return;
    }
    if (inside.size() == 1) {
      part.fixture = static_cast<int>(inside[0]);
    } else if (!encloses(part) || seen.known * seen.face * seen.returned < 0.5) {
      return;
    }
    part.confidence = part.edge_confidence();
    (part.fixture < 0 && is_recessed(part) ? recessed_ : result_.fronts).push_back(part);
  }

  /// The parts without fixture under an overhang below which a plinth recedes, which leaves space for the
  /// feet of who stands before a cupboard; panels and sides of cupboards have none. It is seen below some
  /// parts of a row only, and holds for those beside them and upon them.
  std::vector<bool> standing_on_plinth() const {
    std::vector<PlacedFront> parts = recessed_;
    parts.insert(parts.end(), result_.fronts.begin(), result_.fronts.end());
    std::vector<bool> standing;
    for (const PlacedFront& part : parts)
      standing.push_back(part.edges[bottom].kind != FrontEdge::Kind::border &&
                         part.edges[bottom].rise > kFronts.min_plinth_m);
    const auto shares_plinth = [&](const PlacedFront& part, const PlacedFront& other) {
      const std::array<bool, 4> meets = meeting_sides(part, other);
      const bool level = std::abs(part.rect.v0 - other.rect.v0) < kLayout.plinth_level_m;
      return meets[bottom] || ((meets[left] || meets[right]) && level);
    };
    for (bool grown = true; grown;) {
      grown = false;
      for (size_t i = 0; i < parts.size(); ++i)
        for (size_t k = 0; k < parts.size() && !standing[i]; ++k)
          if (standing[k] && shares_plinth(parts[i], parts[k])) standing[i] = grown = true;
    }
    standing.resize(recessed_.size());
    return standing;
  }

  /// Adds parts without fixture behind something that protrudes where the fronts with fixtures end, too, or
  /// over a plinth: the counter over a row of cupboards, or a wall or tall unit at its end.
  void add_overhung() {
    std::vector<PlacedFront> known;
    std::copy_if(result_.fronts.begin(), result_.fronts.end(), std::back_inserter(known),
                 [](const PlacedFront& front) { return front.fixture >= 0; });
    const auto is_row = [&](const PlacedFront& part, size_t side) {
      return std::any_of(known.begin(), known.end(), [&](const PlacedFront& front) {
        return std::abs(edge_at(front.rect, side) - edge_at(part.rect, side)) < kLayout.neighbour_gap_m;
      });
    };
    const auto ends_row = [&](const PlacedFront& part, size_t side) {
      return (side == left || side == right) && (is_row(part, bottom) || is_row(part, top)) &&
             std::none_of(known.begin(), known.end(),
                          [&](const PlacedFront& front) { return meeting_sides(part, front)[side]; });
    };
    const std::vector<bool> on_plinth = standing_on_plinth();
    for (size_t i = 0; i < recessed_.size(); ++i) {
      const PlacedFront& part = recessed_[i];
      bool overhung = true;
      for (const size_t side : {left, right, bottom, top})
        overhung = overhung && (!is_proud(part.edges[side]) || is_row(part, side) || ends_row(part, side) ||
                                (side == top && on_plinth[i]));
      if (overhung) result_.fronts.push_back(part);
    }
  }

  static double edge_at(const FaceRect& rect, size_t side) {
    const bool upright = side == left || side == right;
    return side == left || side == bottom ? rect.low(upright) : rect.high(upright);
  }

  /// Refines each edge over its final length.
  void settle_edges(PlacedFront& part) const {
    for (const size_t side : {left, right, bottom, top}) {
      if (part.rect.width() < 2 * kLayout.min_side_m || part.rect.height() < 2 * kLayout.min_side_m) return;
      const bool upright = side == left || side == right;
      const bool is_low = side == left || side == bottom;
      double& position = is_low ? part.rect.low(upright) : part.rect.high(upright);
      const double from = part.rect.low(!upright);
      const double to = part.rect.high(!upright);
      LineEvidence line = seams_.line(upright, position, from, to);
      const double z = std::max(line.z, part.edges[side].z);
      line = seams_.refine(upright, line, from, to);
      const double sign = is_low ? 1 : -1;
      const double settled = line.position + sign * line.width / 2;
      if (std::abs(settled - position) > kLayout.max_settle_m || z < kLayout.min_z) continue;
      position = settled;
      part.edges[side] = edge_of(line, sign);
      part.edges[side].z = z;
    }
  }

  /// Whether resolved lines and borders enclose a part without fixture. A level seam may be weak: fronts of a
  /// column are parted by short ones. An upright one may be a shadow on a single front.
  static bool encloses(const PlacedFront& part) {
    const auto weak = [&](size_t side) {
      const FrontEdge& edge = part.edges[side];
      const double length = side == left || side == right ? part.rect.height() : part.rect.width();
      // Each chunk counts for so much at most: a short edge cannot show more.
      const double most = kSeams.max_z * std::sqrt(length / (kSeams.chunk_cells * kFaces.cell_m));
      return edge.kind != FrontEdge::Kind::border &&
             edge.z < std::min(kLayout.min_bare_z, kLayout.clear_edge * most);
    };
    return part.rect.width() * part.rect.height() > kLayout.min_bare_m2 && !weak(left) && !weak(right) &&
           !(weak(bottom) && weak(top));
  }

  /// Whether the surroundings protrude from a part beyond an edge.
  static bool is_proud(const FrontEdge& edge) {
    return edge.kind != FrontEdge::Kind::border && edge.rise < -kLayout.flush_m;
  }
  static bool is_recessed(const PlacedFront& part) {
    return std::any_of(part.edges.begin(), part.edges.end(), is_proud);
  }

  /// At which of its sides another front is next to a front.
  static std::array<bool, 4> meeting_sides(const PlacedFront& a, const PlacedFront& b) {
    const auto overlap = [](double a0, double a1, double b0, double b1) {
      return std::min(a1, b1) - std::max(a0, b0) > kLayout.shared_edge * std::min(a1 - a0, b1 - b0);
    };
    const bool beside = overlap(a.rect.v0, a.rect.v1, b.rect.v0, b.rect.v1);
    const bool stacked = overlap(a.rect.u0, a.rect.u1, b.rect.u0, b.rect.u1);
    return {beside && std::abs(a.rect.u0 - b.rect.u1) < kLayout.neighbour_gap_m,
            beside && std::abs(b.rect.u0 - a.rect.u1) < kLayout.neighbour_gap_m,
            stacked && std::abs(a.rect.v0 - b.rect.v1) < kLayout.neighbour_gap_m,
            stacked && std::abs(b.rect.v0 - a.rect.v1) < kLayout.neighbour_gap_m};
  }

  /// The line between two neighbouring fronts: 2 for a seam, also where one panel is a little thicker and the
  /// other front has a fixture, 1 for another step, 0 for none.
  static int bond(const PlacedFront& a, const PlacedFront& b) {
    const std::array<bool, 4> meets = meeting_sides(a, b);
    int strongest = 0;
    for (size_t side = 0; side < 4; ++side) {
      const FrontEdge& edge = a.edges[side];
      if (!meets[side]) continue;
      if (edge.kind == FrontEdge::Kind::seam) return 2;
      if (edge.kind == FrontEdge::Kind::step)
        strongest = std::max(strongest, b.fixture >= 0 && std::abs(edge.rise) < kLayout.flush_m ? 2 : 1);
    }
    return strongest;
  }

  /// Drops parts without fixture that have neither a front across a seam nor fronts on two sides: the side of
  /// a cupboard, or a box on a counter.
  void drop_isolated() {
    std::vector<PlacedFront>& fronts = result_.fronts;
    const auto isolated = [&](const PlacedFront& front) {
      int bonds = 0;
      for (const PlacedFront& other : fronts)
        if (&other != &front) bonds += bond(front, other);
      return front.fixture < 0 && bonds < 2;
    };
    for (auto found = fronts.begin();
         (found = std::find_if(fronts.begin(), fronts.end(), isolated)) != fronts.end();)
      fronts.erase(found);
  }

  const SeamMap& seams_;
  const FurnitureFace& face_;
  const std::vector<FaceFixture>& fixtures_;
  std::vector<bool> assigned_;
  std::vector<PlacedFront> recessed_;  ///< without fixture
  FrontLayout result_;
};

}  // namespace

double PlacedFront::edge_confidence() const {
  double sum = 0;
  for (const FrontEdge& edge : edges)
    sum += edge.kind == FrontEdge::Kind::border    ? kLayout.border_confidence
           : edge.kind == FrontEdge::Kind::regular ? kLayout.regular_confidence
                                                   : std::clamp(edge.z / (2 * kLayout.min_z), 0.5, 1.0);
  return 0.45 + 0.5 * sum / 4;
}

const char* front_edge_name(FrontEdge::Kind kind) {
  switch (kind) {
    case FrontEdge::Kind::border:
      return "border";
    case FrontEdge::Kind::seam:
      return "seam";
    case FrontEdge::Kind::step:
      return "step";
    case FrontEdge::Kind::regular:
      return "regular";
  }
  return "border";
}

FrontLayout lay_out_fronts(const SeamMap& seams, const FurnitureFace& face,
                           const std::vector<FaceFixture>& fixtures) {
  return Layout(seams, face, fixtures).run();
}

}  // namespace loci::mapping
