#include "mapping/interpretation/front_layout.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace loci::mapping {
namespace {

constexpr double kMinZ = 6;            // of a cut
constexpr double kMinShare = 0.6;      // of its length that shows it
constexpr double kMinSide = 0.028;     // m; narrower parts are not cut off
constexpr double kUnbroken = 0.3;      // of a line's mean score along all its length
constexpr double kMinFront = 0.08;     // m
constexpr double kSomeFace = 0.08;     // share of these that is face, while it is cut
constexpr double kMinKnown = 0.1;      // share of a row or column that rays met
constexpr double kMinGap = 0.015;      // m; wider strips without face part it
constexpr double kWidestHidden = 0.1;  // m; wider strips that no ray met part it, too
constexpr double kMinFace = 0.4;       // and of these that is face
constexpr int kDeepest = 60;           // cuts one after the other
constexpr double kSameLine = 0.03;     // m
constexpr double kClearZ = 8;          // of the seam of a front without fixture
constexpr double kMinArea = 0.02;      // m², of a front without fixture
constexpr double kProud = 0.003;       // m

enum Side : size_t { left, right, bottom, top };

/// Trims rows and columns at the border in which there is no face.
void shrink(const SeamMap& seams, PlacedFront& part, double min_face) {
  const auto trim = [min_face](const std::vector<std::array<float, 2>>& shares) {
    const auto good = [min_face](const std::array<float, 2>& s) {
      return s[0] >= static_cast<float>(kMinKnown) && s[1] >= static_cast<float>(min_face);
    };
    const auto first = std::find_if(shares.begin(), shares.end(), good);
    const auto last = std::find_if(shares.rbegin(), shares.rend(), good);
    return std::pair<double, double>(static_cast<double>(first - shares.begin()) * kFaceCell,
                                     static_cast<double>(last - shares.rbegin()) * kFaceCell);
  };
  for (int round = 0; round < 2; ++round) {
    FaceRect& rect = part.rect;
    if (rect.width() <= 0 || rect.height() <= 0) return;
    const auto [l, r] = trim(seams.column_shares(rect));
    rect.u0 += l;
    rect.u1 -= r;
    if (rect.width() <= 0) return;
    const auto [b, t] = trim(seams.row_shares(rect));
    rect.v0 += b;
    rect.v1 -= t;
    const double trimmed[4] = {l, r, b, t};
    for (size_t side = 0; side < 4; ++side)
      if (trimmed[side] > 2 * kFaceCell) part.edges[side] = {};
  }
}

/// The widest strip across a part in which there is no face: something stands out there, or there is a hole.
/// A narrow strip that no ray met says nothing: a front goes on behind the leg of a table.
std::optional<std::pair<double, double>> widest_gap(const std::vector<std::array<float, 2>>& shares,
                                                    double start) {
  std::optional<std::pair<double, double>> widest;
  size_t begin = 0;
  size_t open = 0;  // of the strip so far, seen and no face
  for (size_t i = 0; i <= shares.size(); ++i) {
    const bool known = i < shares.size() && shares[i][0] >= static_cast<float>(kMinKnown);
    const bool face = i == shares.size() || (known && shares[i][1] >= static_cast<float>(kSomeFace));
    if (!face) {
      open += known ? 1 : 0;
      continue;
    }
    const double width = static_cast<double>(i - begin) * kFaceCell;
    const bool parts = static_cast<double>(open) * kFaceCell > kMinGap || width > kWidestHidden;
    if (begin > 0 && i < shares.size() && parts && (!widest || width > widest->second - widest->first))
      widest = {start + static_cast<double>(begin) * kFaceCell, start + static_cast<double>(i) * kFaceCell};
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
  constexpr double kBeside = 0.004;  // m
  return std::any_of(fixtures.begin(), fixtures.end(), [&](const FaceFixture& fixture) {
    const FaceRect box = fixture.box.grown(kBeside);
    return rect.contains(fixture.u, fixture.v) &&
           (upright ? position > box.u0 && position < box.u1 : position > box.v0 && position < box.v1);
  });
}

/// Significant lines through a part, the strongest first.
std::vector<Cut> possible_cuts(const SeamMap& seams, const FaceRect& rect,
                               const std::vector<FaceFixture>& fixtures) {
  std::vector<Cut> cuts;
  for (const bool upright : {true, false}) {
    const double low = upright ? rect.u0 : rect.v0;
    const double high = upright ? rect.u1 : rect.v1;
    for (double p = low + kMinSide; p < high - kMinSide; p += kFaceCell) {
      const LineEvidence line =
          upright ? seams.upright(p, rect.v0, rect.v1) : seams.level(p, rect.u0, rect.u1);
      if (line.z < kMinZ || line.share < kMinShare || line.weakest < kUnbroken) continue;
      if (!cuts_fixture(rect, upright, p, fixtures)) cuts.push_back({upright, line});
    }
  }
  std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.line.z > b.line.z; });
  return cuts;
}

/// The strongest line whose exact position is well inside the part: an edge of the part shows a little way
/// into it.
std::optional<Cut> strongest_cut(const SeamMap& seams, const FaceRect& rect,
                                 const std::vector<FaceFixture>& fixtures) {
  std::vector<Cut> cuts = possible_cuts(seams, rect, fixtures);
  while (!cuts.empty()) {
    Cut cut = cuts.front();
    const double found = cut.line.position;
    const double from = cut.upright ? rect.v0 : rect.u0;
    const double to = cut.upright ? rect.v1 : rect.u1;
    cut.line = seams.refine(cut.upright, cut.line, from, to);
    const double low = cut.upright ? rect.u0 : rect.v0;
    const double high = cut.upright ? rect.u1 : rect.v1;
    const double half = cut.line.width / 2;
    if (cut.line.position - half > low + kMinSide / 2 && cut.line.position + half < high - kMinSide / 2 &&
        std::abs(cut.line.position - found) < kSameLine)
      return cut;
    std::erase_if(cuts, [&](const Cut& other) {
      return other.upright == cut.upright && std::abs(other.line.position - found) < kFaceCell * 1.5;
    });
  }
  return std::nullopt;
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
  Layout(const SeamMap& seams, const Face& face, const std::vector<FaceFixture>& fixtures)
      : seams_(seams), face_(face), fixtures_(fixtures), housed_(fixtures.size(), false) {}

  FrontLayout run() {
    PlacedFront all;
    const FaceGrid& grid = seams_.grid();
    all.rect = {grid.u0, grid.u0 + grid.width * kFaceCell, grid.v0, grid.v0 + grid.height * kFaceCell};
    cut(all, 0);
    drop_lonely();
    for (size_t i = 0; i < housed_.size(); ++i)
      if (!housed_[i]) result_.homeless.push_back(i);
    return std::move(result_);
  }

 private:
  void cut(PlacedFront part, int depth) {
    shrink(seams_, part, kSomeFace);
    if (part.rect.width() < kMinSide || part.rect.height() < kMinSide) return;
    if (depth < kDeepest && cut_gap(part, depth)) return;
    const std::optional<Cut> best =
        depth < kDeepest ? strongest_cut(seams_, part.rect, fixtures_) : std::nullopt;
    if (!best) return finish(part);
    PlacedFront low = part;
    PlacedFront high = part;
    const double half = best->line.width / 2;
    if (best->upright) {
      low.rect.u1 = best->line.position - half;
      high.rect.u0 = best->line.position + half;
      low.edges[right] = edge_of(best->line, -1);
      high.edges[left] = edge_of(best->line, 1);
    } else {
      low.rect.v1 = best->line.position - half;
      high.rect.v0 = best->line.position + half;
      low.edges[top] = edge_of(best->line, -1);
      high.edges[bottom] = edge_of(best->line, 1);
    }
    cut(low, depth + 1);
    cut(high, depth + 1);
  }

  bool cut_gap(const PlacedFront& part, int depth) {
    for (const bool upright : {false, true}) {
      const auto gap = upright ? widest_gap(seams_.column_shares(part.rect), part.rect.u0)
                               : widest_gap(seams_.row_shares(part.rect), part.rect.v0);
      if (!gap || cuts_fixture(part.rect, upright, (gap->first + gap->second) / 2, fixtures_)) continue;
      PlacedFront low = part;
      PlacedFront high = part;
      (upright ? low.rect.u1 : low.rect.v1) = gap->first;
      (upright ? high.rect.u0 : high.rect.v0) = gap->second;
      low.edges[upright ? right : top] = {};
      high.edges[upright ? left : bottom] = {};
      cut(low, depth + 1);
      cut(high, depth + 1);
      return true;
    }
    return false;
  }

  void finish(PlacedFront part) {
    shrink(seams_, part, kMinFace);
    settle_edges(part);
    if (part.rect.width() < kMinFront || part.rect.height() < kMinFront) return;
    std::vector<size_t> inside;
    for (size_t i = 0; i < fixtures_.size(); ++i)
      if (part.rect.contains(fixtures_[i].u, fixtures_[i].v)) inside.push_back(i);
    const SeamMap::Look look = seams_.look(part.rect);
    if (look.known * look.face < 0.5) return;
    for (const size_t i : inside) housed_[i] = true;
    if (inside.size() > 1) {
      const std::vector<PlacedFront> fronts = divide_evenly(seams_, face_, part, fixtures_, inside);
      result_.fronts.insert(result_.fronts.end(), fronts.begin(), fronts.end());
      return;
    }
    if (inside.size() == 1) {
      part.fixture = static_cast<int>(inside[0]);
    } else if (!encloses(part) || look.known * look.face * look.returned < 0.5) {
      return;
    }
    part.confidence = 0.9;
    result_.fronts.push_back(part);
  }

  /// Looks at each edge again over the length that it has in the end.
  void settle_edges(PlacedFront& part) const {
    constexpr double kMaxMoved = 0.012;  // m
    for (const size_t side : {left, right, bottom, top}) {
      if (part.rect.width() < 2 * kMinSide || part.rect.height() < 2 * kMinSide) return;
      const bool upright = side == left || side == right;
      double& position = side == left     ? part.rect.u0
                         : side == right  ? part.rect.u1
                         : side == bottom ? part.rect.v0
                                          : part.rect.v1;
      const double from = upright ? part.rect.v0 : part.rect.u0;
      const double to = upright ? part.rect.v1 : part.rect.u1;
      LineEvidence line = upright ? seams_.upright(position, from, to) : seams_.level(position, from, to);
      const double z = std::max(line.z, part.edges[side].z);
      line = seams_.refine(upright, line, from, to);
      const double sign = side == left || side == bottom ? 1 : -1;
      const double settled = line.position + sign * line.width / 2;
      if (std::abs(settled - position) > kMaxMoved || z < kMinZ) continue;
      position = settled;
      part.edges[side] = edge_of(line, sign);
      part.edges[side].z = z;
    }
  }

  /// Whether resolved lines and borders enclose a part without fixture, and nothing around it stands proud of
  /// it.
  static bool encloses(const PlacedFront& part) {
    return part.rect.width() * part.rect.height() > kMinArea &&
           std::none_of(part.edges.begin(), part.edges.end(), [](const FrontEdge& edge) {
             return (edge.kind == FrontEdge::Kind::step && edge.rise < -kProud) ||
                    (edge.kind != FrontEdge::Kind::border && edge.z < kClearZ);
           });
  }

  /// How closely a front is bound to another by resolved lines between them: 2 by a seam, 1 by a step.
  static int bond(const PlacedFront& a, const PlacedFront& b) {
    constexpr double kGap = 0.012;   // m
    constexpr double kShared = 0.5;  // of the shorter edge
    const auto overlap = [](double a0, double a1, double b0, double b1) {
      return std::min(a1, b1) - std::max(a0, b0) > kShared * std::min(a1 - a0, b1 - b0);
    };
    const bool beside = overlap(a.rect.v0, a.rect.v1, b.rect.v0, b.rect.v1);
    const bool stacked = overlap(a.rect.u0, a.rect.u1, b.rect.u0, b.rect.u1);
    const std::array<bool, 4> meets = {
        beside && std::abs(a.rect.u0 - b.rect.u1) < kGap, beside && std::abs(b.rect.u0 - a.rect.u1) < kGap,
        stacked && std::abs(a.rect.v0 - b.rect.v1) < kGap, stacked && std::abs(b.rect.v0 - a.rect.v1) < kGap};
    for (size_t side = 0; side < 4; ++side)
      if (meets[side] && a.edges[side].kind == FrontEdge::Kind::seam) return 2;
    for (size_t side = 0; side < 4; ++side)
      if (meets[side] && a.edges[side].kind == FrontEdge::Kind::step) return 1;
    return 0;
  }

  /// A seam parts two fronts: what has no fixture and no front on the other side of a seam, nor fronts on two
  /// of its sides, is the side of a cupboard or a box on a counter.
  void drop_lonely() {
    std::vector<PlacedFront>& fronts = result_.fronts;
    const auto lonely = [&](const PlacedFront& front) {
      int bonds = 0;
      for (const PlacedFront& other : fronts)
        if (&other != &front) bonds += bond(front, other);
      return front.fixture < 0 && bonds < 2;
    };
    for (auto found = fronts.begin();
         (found = std::find_if(fronts.begin(), fronts.end(), lonely)) != fronts.end();)
      fronts.erase(found);
  }

  const SeamMap& seams_;
  const Face& face_;
  const std::vector<FaceFixture>& fixtures_;
  std::vector<bool> housed_;
  FrontLayout result_;
};

}  // namespace

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

FrontLayout lay_out_fronts(const SeamMap& seams, const Face& face, const std::vector<FaceFixture>& fixtures) {
  return Layout(seams, face, fixtures).run();
}

}  // namespace loci::mapping
