#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/refinement.h"

namespace loci::mapping {
namespace {

/// Coordinates beyond one side of a rectangle.
struct SideFrame {
  Eigen::Rotation2Dd axes_from_map;
  Extent part;
  int axis;
  bool upper;

  /// x: distance beyond the edge, y: along it from the part's lower end.
  Vector2d local(const Vector2d& map_point) const {
    const Vector2d at = axes_from_map * map_point;
    const double beyond = upper ? at[axis] - part.max[axis] : part.min[axis] - at[axis];
    return {beyond, at[1 - axis] - part.min[1 - axis]};
  }
  double width() const { return part.size()[1 - axis]; }
};

/// One of the two slab edges along the gap: rows of points of the edge, of objects above and of the body
/// below.
class SlabEdge {
 public:
  SlabEdge(const SideFrame& side, bool upper) : side_(side), upper_(upper) {}

  /// Distance of a place before the part's edge.
  double outward(const Vector2d& local) const { return upper_ ? local.y() - side_.width() : -local.y(); }

  void add_rim(const Vector2d& local) { add(local, &Row::rim); }
  void add_object(const Vector2d& local) { add(local, &Row::objects); }
  void add_below(const Vector2d& local) { add(local, &Row::below); }
  /// Adds a face if it runs along this edge from before the gap to behind it.
  void add_face(const Vector2d& a, const Vector2d& b) {
    if (std::min(a.x(), b.x()) > 0 || std::abs(a.y() - b.y()) > kOcclusion.face_reach_m) return;
    if (std::abs(outward(a) + outward(b)) / 2 < kOcclusion.face_reach_m)
      face_to_ = std::max({face_to_, a.x(), b.x()});
  }

  /// For each row beyond the part, whether the slab's edge was seen: in line with the part's own edge and
  /// before the body below or the object above. A flush surface could be the side of an object on the floor.
  std::vector<bool> rows() const {
    std::vector<bool> seen(rows_.size(), false);
    if (own_rim_.size() < kOcclusion.min_points) return seen;
    const double line = median(own_rim_);
    for (size_t i = 0; i < rows_.size(); ++i) {
      const Row& row = rows_[i];
      if (row.rim.size() < kOcclusion.min_points ||
          (static_cast<double>(i) + 0.5) * kOcclusion.row_m > face_to_)
        continue;
      const double at = median(row.rim);
      const bool overhangs =
          row.below.size() >= kOcclusion.min_points && at > median(row.below) + kOcclusion.step_m;
      const bool before_object =
          row.objects.size() < kOcclusion.min_points || at > quantile(row.objects, 0.9) + kOcclusion.step_m;
      seen[i] = std::abs(at - line) < kOcclusion.in_line_m && (overhangs || before_object);
    }
    return seen;
  }

 private:
  struct Row {
    std::vector<double> rim, objects, below;  ///< distances before the part's edge
  };
  void add(const Vector2d& local, std::vector<double> Row::*list) {
    const double out = outward(local);
    if (std::abs(out) > kOcclusion.edge_reach_m) return;
    const double row = std::floor(local.x() / kOcclusion.row_m);
    if (row >= 0 && row < static_cast<double>(rows_.size()))
      (rows_[static_cast<size_t>(row)].*list).push_back(out);
    else if (row < 0 && list == &Row::rim && -local.x() < side_.part.size()[side_.axis])
      own_rim_.push_back(out);
  }

  const SideFrame& side_;
  bool upper_;
  std::vector<double> own_rim_;
  std::vector<Row> rows_ = std::vector<Row>(static_cast<size_t>(kOcclusion.max_gap_m / kOcclusion.row_m));
  double face_to_ = 0;  ///< how far beyond the part a face extends
};

/// Rows beyond a side: cells of surface and of passing rays, and whether an object and the slab's edge were
/// seen.
class Rows {
 public:
  Rows(const SideFrame& side, double height, const PlaneEvidence& evidence,
       const std::vector<VerticalPlane>& faces)
      : side_(side) {
    columns_ = std::max(1, static_cast<int>(side.width() / kOcclusion.row_m));
    rows_.resize(static_cast<size_t>(kOcclusion.max_gap_m / kOcclusion.row_m));
    for (Row& row : rows_) row.support = row.rays = std::vector<int>(static_cast<size_t>(columns_), 0);
    for (const auto& point : evidence.support) count(point.position, &Row::support);
    for (const Vector2d& point : evidence.pierced) count(point, &Row::rays);
    for (const Vector2d& point : evidence.sunk) count(point, &Row::rays);
    for (const Vector2d& point : evidence.above) mark_object(point);
    for (const bool upper : {false, true}) {
      SlabEdge edge(side, upper);
      for (const Vector2d& point : evidence.rim) edge.add_rim(side.local(point));
      for (const Vector2d& point : evidence.above) edge.add_object(side.local(point));
      for (const Vector2d& point : evidence.below) edge.add_below(side.local(point));
      for (const VerticalPlane& face : faces)
        if (face.bottom <= height - kOcclusion.face_depth_m)
          edge.add_face(side.local(face.at(face.along_min)), side.local(face.at(face.along_max)));
      const std::vector<bool> seen = edge.rows();
      for (size_t i = 0; i < rows_.size(); ++i) rows_[i].edge = rows_[i].edge || seen[i];
    }
  }

  /// How far the slab continues behind an object that stands on it, metres; 0 = it ends.
  double extension() const {
    size_t first = 0, hidden = 0, to = 0;  // `to`: rows up to the last with an object and the edge
    for (; first < rows_.size() && !is_support(first) && !is_free(first); ++first)
      if (rows_[first].object && rows_[first].edge) {
        ++hidden;
        to = first + 1;
      }
    if (hidden == 0 || static_cast<double>(hidden) < kOcclusion.min_hidden * static_cast<double>(to))
      return 0;
    if (to == rows_.size()) return 0;  // The end is unknown.
    size_t last = first;
    while (last < rows_.size() && is_support(last)) ++last;
    const bool bridged =
        static_cast<double>(last - first) * kOcclusion.row_m >= kOcclusion.min_beyond_m - 1e-9 &&
        static_cast<double>(hidden) >= kOcclusion.min_hidden * static_cast<double>(first);
    // A support of its own behind the object is measured on its own.
    if (bridged) to = last == rows_.size() ? first : last;
    return static_cast<double>(to) * kOcclusion.row_m;
  }

 private:
  struct Row {
    std::vector<int> support, rays;  ///< by cell
    bool object = false, edge = false;
  };

  Row* row_of(double beyond) {
    const double row = std::floor(beyond / kOcclusion.row_m);
    return row < 0 || row >= static_cast<double>(rows_.size()) ? nullptr : &rows_[static_cast<size_t>(row)];
  }
  void count(const Vector2d& point, std::vector<int> Row::*what) {
    const Vector2d at = side_.local(point);
    const int column = static_cast<int>(std::floor(at.y() / kOcclusion.row_m));
    Row* row = row_of(at.x());
    if (row != nullptr && column >= 0 && column < columns_) ++(row->*what)[static_cast<size_t>(column)];
  }
  void mark_object(const Vector2d& point) {
    const Vector2d at = side_.local(point);
    Row* row = row_of(at.x());
    if (row != nullptr && at.y() > -kOcclusion.edge_reach_m &&
        at.y() < side_.width() + kOcclusion.edge_reach_m)
      row->object = true;
  }
  bool is_support(size_t row) const {
    return static_cast<double>(std::ranges::count_if(rows_[row].support, [](int n) { return n > 0; })) >
           kOcclusion.min_surface * columns_;
  }
  bool is_free(size_t row) const {
    int free = 0;
    for (size_t i = 0; i < static_cast<size_t>(columns_); ++i)
      free += rows_[row].rays[i] > 1 && rows_[row].support[i] == 0 ? 1 : 0;
    return free > kOcclusion.max_free * columns_;
  }

  const SideFrame& side_;
  int columns_ = 0;
  std::vector<Row> rows_;
};

}  // namespace

void extend_behind_objects(Support& support, const PlaneEvidence& evidence,
                           const std::vector<VerticalPlane>& faces) {
  for (Extent& part : support.parts)
    for (const int axis : {0, 1})
      for (const bool upper : {false, true}) {
        const SideFrame side{Eigen::Rotation2Dd(-support.yaw), part, axis, upper};
        const double extension = Rows(side, support.height, evidence, faces).extension();
        (upper ? part.max : part.min)[axis] += upper ? extension : -extension;
      }
}

}  // namespace loci::mapping
