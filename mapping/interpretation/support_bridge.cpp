#include <algorithm>
#include <cmath>

#include "mapping/interpretation/support_checks.h"

namespace loci {
namespace {

constexpr double kRow = 0.02;          // m, along the gap and across
constexpr double kLongest = 0.8;       // m of a slab that one thing hides
constexpr double kEdgeReach = 0.05;    // m from a slab's edge to what belongs to it
constexpr double kFaceReach = 0.12;    // m from a slab's edge to the front below it
constexpr double kMostFree = 0.05;     // of a row, through which rays passed
constexpr double kSurface = 0.4;       // of a row, to be support
constexpr double kHidden = 0.8;        // of the rows between, that show a thing and the slab's edge below it
constexpr double kLeastBeyond = 0.04;  // m of surface on the other side
constexpr double kStandsIn = 0.4;      // m below the slab to which a front goes at least

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

/// Rows beyond a side, by what was seen on each: cells of surface and of passing rays, and whether there are
/// a thing and the slab's edge.
class Rows {
 public:
  Rows(const Side& side, const PlaneEvidence& evidence) : side_(side) {
    columns_ = std::max(1, static_cast<int>(side.width() / kRow));
    rows_.resize(static_cast<size_t>(kLongest / kRow));
    for (Row& row : rows_) row.support = row.rays = std::vector<int>(static_cast<size_t>(columns_), 0);
    for (const auto& point : evidence.support) count(point.position, &Row::support);
    for (const Vector2d& point : evidence.pierced) count(point, &Row::rays);
    for (const Vector2d& point : evidence.sunk) count(point, &Row::rays);
    for (const Vector2d& point : evidence.above) mark(point, &Row::thing);
    for (const Vector2d& point : evidence.rim) mark(point, &Row::edge);
  }

  /// How far the slab goes on behind a thing that stands on it, and the length that this hides; 0 = it ends.
  double goes_on(double& hidden_to) const {
    size_t hidden = 0, first = 0;
    while (first < rows_.size() && !is_support(first)) {
      if (is_free(first)) return 0;
      hidden += rows_[first].thing && rows_[first].edge ? 1 : 0;
      ++first;
    }
    size_t last = first;
    while (last < rows_.size() && is_support(last)) ++last;
    hidden_to = static_cast<double>(first) * kRow;
    const double beyond = static_cast<double>(last - first) * kRow;
    if (first == 0 || beyond < kLeastBeyond - 1e-9) return 0;
    if (last == rows_.size()) return 0;  // A support of its own, whose end is not known here.
    if (static_cast<double>(hidden) < kHidden * static_cast<double>(first)) return 0;
    return static_cast<double>(last) * kRow;
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
  /// Not near a wall or what stands behind: at the part's other edges at least one is open.
  void mark(const Vector2d& point, bool Row::*what) {
    const Vector2d at = side_.local(point);
    Row* row = row_of(at.x());
    if (row != nullptr && at.y() > -kEdgeReach && at.y() < side_.width() + kEdgeReach) row->*what = true;
  }
  bool is_support(size_t row) const {
    return static_cast<double>(std::ranges::count_if(rows_[row].support, [](int n) { return n > 0; })) >
           kSurface * columns_;
  }
  bool is_free(size_t row) const {
    int free = 0;
    for (size_t i = 0; i < static_cast<size_t>(columns_); ++i)
      free += rows_[row].rays[i] > 1 && rows_[row].support[i] == 0 ? 1 : 0;
    return free > kMostFree * columns_;
  }

  const Side& side_;
  int columns_ = 0;
  std::vector<Row> rows_;
};

/// Whether one front goes through below an edge that runs along the gap, from before it to behind it.
bool front_goes_through(const Side& side, double hidden_to, double height,
                        const std::vector<VerticalPlane>& faces) {
  return std::ranges::any_of(faces, [&](const VerticalPlane& face) {
    if (face.bottom > height - kStandsIn) return false;
    const Vector2d a = side.local(face.at(face.along_min)), b = side.local(face.at(face.along_max));
    if (std::min(a.x(), b.x()) > 0 || std::max(a.x(), b.x()) < hidden_to) return false;
    const auto near_edge = [&](const Vector2d& end) {
      return std::abs(end.y()) < kFaceReach || std::abs(end.y() - side.width()) < kFaceReach;
    };
    return near_edge(a) && near_edge(b) && std::abs(a.y() - b.y()) < kFaceReach;
  });
}

}  // namespace

void extend_behind_things(Support& support, const PlaneEvidence& evidence,
                          const std::vector<VerticalPlane>& faces) {
  for (Extent& part : support.parts)
    for (const int axis : {0, 1})
      for (const bool upper : {false, true}) {
        const Side side{Eigen::Rotation2Dd(-support.yaw), part, axis, upper};
        double hidden_to = 0;
        const double way = Rows(side, evidence).goes_on(hidden_to);
        if (way == 0 || !front_goes_through(side, hidden_to, support.height, faces)) continue;
        (upper ? part.max : part.min)[axis] += upper ? way : -way;
      }
}

}  // namespace loci
