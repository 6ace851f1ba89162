#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/quantile.h"
#include "mapping/interpretation/support_checks.h"

namespace loci::mapping {
namespace {

constexpr double kRow = 0.02;        // m, along the gap and across
constexpr double kLongest = 0.8;     // m of a slab that one thing hides
constexpr double kEdgeReach = 0.05;  // m from a slab's edge to what belongs to it
constexpr double kFaceReach = 0.12;  // m from a slab's edge to the front below it
constexpr double kMaxFree = 0.05;    // of a row, through which rays passed
constexpr double kSurface = 0.4;     // of a row, to be support
constexpr double kHidden = 0.8;      // of the rows between, that show a thing and the slab's edge below it
constexpr double kMinBeyond = 0.04;  // m of surface on the other side
constexpr double kStandsIn = 0.4;    // m below the slab to which a front goes at least
constexpr double kInLine = 0.015;    // m between a slab's edge on one row and on the others
constexpr double kStep = 0.008;      // m by which a slab's edge differs from what is below or above it
constexpr size_t kMin = 3;           // points that say where something is

/// One side of a rectangle: lengths beyond it, and places along it.
struct Side {
  Eigen::Rotation2Dd axes_from_map;
  Extent part;
  int axis;
  bool upper;

  /// x: how far beyond the edge, y: along it, from the part's lower end.
  Vector2d local(const Vector2d& map_point) const {
    const Vector2d at = axes_from_map * map_point;
    const double beyond = upper ? at[axis] - part.max[axis] : part.min[axis] - at[axis];
    return {beyond, at[1 - axis] - part.min[1 - axis]};
  }
  double width() const { return part.size()[1 - axis]; }
};

/// One of the two edges that run along the gap: where it is over the part, and on the rows beyond where edge,
/// what is below it and what stands above it are.
class FrontEdge {
 public:
  FrontEdge(const Side& side, bool upper) : side_(side), upper_(upper) {}

  /// How far before the part's edge a place is.
  double outward(const Vector2d& local) const { return upper_ ? local.y() - side_.width() : -local.y(); }

  void add_rim(const Vector2d& local) { add(local, &Row::rim); }
  void add_thing(const Vector2d& local) { add(local, &Row::things); }
  void add_below(const Vector2d& local) { add(local, &Row::below); }
  /// A face that runs along this edge, from before the gap to behind it.
  void add_face(const Vector2d& a, const Vector2d& b) {
    if (std::min(a.x(), b.x()) > 0 || std::abs(a.y() - b.y()) > kFaceReach) return;
    if (std::abs(outward(a) + outward(b)) / 2 < kFaceReach) face_to_ = std::max({face_to_, a.x(), b.x()});
  }

  /// Rows, from the part on, over which the slab's edge goes on: in line with its edge over the part, before
  /// what is below or before what stands on it. What is flush with both might be the side of a thing that
  /// stands on the floor.
  std::vector<bool> rows() const {
    std::vector<bool> seen(rows_.size(), false);
    if (own_rim_.size() < kMin) return seen;
    const double line = median(own_rim_);
    for (size_t i = 0; i < rows_.size(); ++i) {
      const Row& row = rows_[i];
      if (row.rim.size() < kMin || (static_cast<double>(i) + 0.5) * kRow > face_to_) continue;
      const double at = median(row.rim);
      const bool overhangs = row.below.size() >= kMin && at > median(row.below) + kStep;
      const bool before_thing = row.things.size() < kMin || at > quantile(row.things, 0.9) + kStep;
      seen[i] = std::abs(at - line) < kInLine && (overhangs || before_thing);
    }
    return seen;
  }

 private:
  struct Row {
    std::vector<double> rim, things, below;  ///< how far before the part's edge
  };
  void add(const Vector2d& local, std::vector<double> Row::*list) {
    const double out = outward(local);
    if (std::abs(out) > kEdgeReach) return;
    const double row = std::floor(local.x() / kRow);
    if (row >= 0 && row < static_cast<double>(rows_.size()))
      (rows_[static_cast<size_t>(row)].*list).push_back(out);
    else if (row < 0 && list == &Row::rim && -local.x() < side_.part.size()[side_.axis])
      own_rim_.push_back(out);
  }

  const Side& side_;
  bool upper_;
  std::vector<double> own_rim_;
  std::vector<Row> rows_ = std::vector<Row>(static_cast<size_t>(kLongest / kRow));
  double face_to_ = 0;  ///< how far beyond the part a face goes
};

/// Rows beyond a side, by what was seen on each: cells of surface and of passing rays, and whether there are
/// a thing and the slab's edge.
class Rows {
 public:
  Rows(const Side& side, double height, const PlaneEvidence& evidence,
       const std::vector<VerticalPlane>& faces)
      : side_(side) {
    columns_ = std::max(1, static_cast<int>(side.width() / kRow));
    rows_.resize(static_cast<size_t>(kLongest / kRow));
    for (Row& row : rows_) row.support = row.rays = std::vector<int>(static_cast<size_t>(columns_), 0);
    for (const auto& point : evidence.support) count(point.position, &Row::support);
    for (const Vector2d& point : evidence.pierced) count(point, &Row::rays);
    for (const Vector2d& point : evidence.sunk) count(point, &Row::rays);
    for (const Vector2d& point : evidence.above) mark_thing(point);
    for (const bool upper : {false, true}) {
      FrontEdge edge(side, upper);
      for (const Vector2d& point : evidence.rim) edge.add_rim(side.local(point));
      for (const Vector2d& point : evidence.above) edge.add_thing(side.local(point));
      for (const Vector2d& point : evidence.below) edge.add_below(side.local(point));
      for (const VerticalPlane& face : faces)
        if (face.bottom <= height - kStandsIn)
          edge.add_face(side.local(face.at(face.along_min)), side.local(face.at(face.along_max)));
      const std::vector<bool> seen = edge.rows();
      for (size_t i = 0; i < rows_.size(); ++i) rows_[i].edge = rows_[i].edge || seen[i];
    }
  }

  /// How far the slab goes on behind a thing that stands on it; 0 = it ends.
  double goes_on() const {
    size_t first = 0, hidden = 0, to = 0;  // `to`: rows up to the last that shows a thing and the edge
    for (; first < rows_.size() && !is_support(first) && !is_free(first); ++first)
      if (rows_[first].thing && rows_[first].edge) {
        ++hidden;
        to = first + 1;
      }
    if (hidden == 0 || static_cast<double>(hidden) < kHidden * static_cast<double>(to)) return 0;
    if (to == rows_.size()) return 0;  // Its end is not known here.
    size_t last = first;
    while (last < rows_.size() && is_support(last)) ++last;
    const bool bridged = static_cast<double>(last - first) * kRow >= kMinBeyond - 1e-9 &&
                         static_cast<double>(hidden) >= kHidden * static_cast<double>(first);
    // A support of its own behind the thing is as long as it turns out to be.
    if (bridged) to = last == rows_.size() ? first : last;
    return static_cast<double>(to) * kRow;
  }

 private:
  struct Row {
    std::vector<int> support, rays;  ///< by cell
    bool thing = false, edge = false;
  };

  Row* row_of(double beyond) {
    const double row = std::floor(beyond / kRow);
    return row < 0 || row >= static_cast<double>(rows_.size()) ? nullptr : &rows_[static_cast<size_t>(row)];
  }
  void count(const Vector2d& point, std::vector<int> Row::*what) {
    const Vector2d at = side_.local(point);
    const int column = static_cast<int>(std::floor(at.y() / kRow));
    Row* row = row_of(at.x());
    if (row != nullptr && column >= 0 && column < columns_) ++(row->*what)[static_cast<size_t>(column)];
  }
  void mark_thing(const Vector2d& point) {
    const Vector2d at = side_.local(point);
    Row* row = row_of(at.x());
    if (row != nullptr && at.y() > -kEdgeReach && at.y() < side_.width() + kEdgeReach) row->thing = true;
  }
  bool is_support(size_t row) const {
    return static_cast<double>(std::ranges::count_if(rows_[row].support, [](int n) { return n > 0; })) >
           kSurface * columns_;
  }
  bool is_free(size_t row) const {
    int free = 0;
    for (size_t i = 0; i < static_cast<size_t>(columns_); ++i)
      free += rows_[row].rays[i] > 1 && rows_[row].support[i] == 0 ? 1 : 0;
    return free > kMaxFree * columns_;
  }

  const Side& side_;
  int columns_ = 0;
  std::vector<Row> rows_;
};

}  // namespace

void extend_behind_things(Support& support, const PlaneEvidence& evidence,
                          const std::vector<VerticalPlane>& faces) {
  for (Extent& part : support.parts)
    for (const int axis : {0, 1})
      for (const bool upper : {false, true}) {
        const Side side{Eigen::Rotation2Dd(-support.yaw), part, axis, upper};
        const double way = Rows(side, support.height, evidence, faces).goes_on();
        (upper ? part.max : part.min)[axis] += upper ? way : -way;
      }
}

}  // namespace loci::mapping
