#include "mapping/articulation/moved_face.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "mapping/articulation/parameters.h"
#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"

namespace loci::mapping {
namespace {

size_t count_near(const FittedPlane& face, const std::vector<Vector3d>& points) {
  return static_cast<size_t>(std::count_if(points.begin(), points.end(), [&](const Vector3d& p) {
    return std::abs(face.distance(p)) < kFaceMotion.inlier_m;
  }));
}

}  // namespace

FittedPlane refined_plane(const FittedPlane& start, const std::vector<Vector3d>& points, double reach) {
  FittedPlane face = start;
  for (int round = 0; round < 5; ++round) {
    Vector3d mean = Vector3d::Zero();
    size_t count = 0;
    for (const Vector3d& p : points)
      if (std::abs(face.distance(p)) < reach) {
        mean += p;
        ++count;
      }
    if (count < 3) return face;
    mean /= static_cast<double>(count);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Vector3d& p : points)
      if (std::abs(face.distance(p)) < reach)
        covariance += (p - mean) * (p - mean).transpose() / static_cast<double>(count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    Vector3d normal = solver.eigenvectors().col(0);
    if (normal.dot(face.normal) < 0) normal = -normal;
    face.normal = normal;
    face.offset = normal.dot(mean);
    face.points = count;
    // Tilt by noise: σ / (spread · √n), for both directions within the plane.
    face.normal_sd = std::sqrt(
        solver.eigenvalues()[0] / static_cast<double>(count) *
        (1 / std::max(solver.eigenvalues()[1], 1e-9) + 1 / std::max(solver.eigenvalues()[2], 1e-9)));
  }
  return face;
}

std::optional<FittedPlane> find_plane(const std::vector<Vector3d>& points,
                                      const std::function<bool(const Vector3d&)>& allowed) {
  if (points.size() < kFaceMotion.min_plane_points) return std::nullopt;
  Random random(1);
  FittedPlane best;
  size_t max_count = 0;
  const auto draw = [&] { return points[random.index(points.size())]; };
  // A subset of the points selects among many planes; all points refine the best.
  std::vector<Vector3d> subset;
  for (size_t i = 0; i < 600; ++i) subset.push_back(draw());
  for (int sample = 0; sample < kFaceMotion.samples; ++sample) {
    const Vector3d a = draw(), b = draw(), c = draw();
    const Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-3 || !allowed(normal.normalized())) continue;
    const FittedPlane face{normal.normalized(), normal.normalized().dot(a), 0, 0};
    const size_t count = count_near(face, subset);
    if (count > max_count) {
      max_count = count;
      best = face;
    }
  }
  if (max_count == 0) return std::nullopt;
  best = refined_plane(best, points, kFaceMotion.inlier_m);
  if (best.points < kFaceMotion.min_plane_points || !allowed(best.normal)) return std::nullopt;
  return best;
}

std::array<double, 2> interval_of(const std::vector<double>& positions) {
  const double cell = kOutline.cell_m;
  const auto [low, high] = std::minmax_element(positions.begin(), positions.end());
  const size_t cells = static_cast<size_t>((*high - *low) / cell) + 1;
  std::vector<double> counts(cells, 0);
  for (const double position : positions) counts[static_cast<size_t>((position - *low) / cell)] += 1;
  std::vector<double> sorted = counts;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[static_cast<size_t>(kOutline.usual_rank * static_cast<double>(sorted.size()))],
               half = 0.5 * usual;
  // Two neighbouring cells must be covered, so that a mixed return does not move an edge.
  size_t first = 0, last = cells - 1;
  while (first + 1 < cells && (counts[first] < half || counts[first + 1] < half)) ++first;
  while (last > first && (counts[last] < half || counts[last - 1] < half)) --last;
  // Within the outermost cells the edge is where their share of points ends.
  const double inner = std::max(usual, 1.0);
  const double before = first > 0 ? std::min(counts[first - 1] / inner, 1.0) : 0;
  const double after = last + 1 < cells ? std::min(counts[last + 1] / inner, 1.0) : 0;
  return {*low + (static_cast<double>(first) - before) * cell,
          *low + (static_cast<double>(last) + 1 + after) * cell};
}

namespace {

Motion sliding_motion(const FittedPlane& closed, const FittedPlane& open, const Front& front) {
  Motion motion;
  motion.type = ArticulationType::prismatic;
  motion.axis = closed.normal;
  motion.origin = front.centre;
  motion.position = open.offset - closed.normal.dot(closed.normal * closed.offset);
  return motion;
}

/// The rotation between two planes; `moved`: centroid of the moved part, which determines the direction.
Motion rotating_motion(const FittedPlane& closed, const FittedPlane& open, const Front& front,
                       const Vector3d& moved) {
  Motion motion;
  motion.type = ArticulationType::revolute;
  motion.axis = closed.normal.cross(open.normal).normalized();
  Eigen::Matrix3d planes;
  planes << closed.normal.transpose(), open.normal.transpose(), motion.axis.transpose();
  const Vector3d line =
      planes.fullPivLu().solve(Vector3d(closed.offset, open.offset, motion.axis.dot(front.centre)));
  const Vector3d handle = front.fixture ? front.fixture->centre : front.centre;
  const auto level = [&](const Vector3d& p) { return Vector3d(p - motion.axis * motion.axis.dot(p)); };
  const Vector3d from = level(handle - line), to = level(moved - line);
  Vector3d open_normal = open.normal;
  motion.position = std::atan2(from.cross(to).dot(motion.axis), from.dot(to));
  if (motion.position < 0) {
    motion.axis = -motion.axis;
    motion.position = -motion.position;
  }
  if (open_normal.dot(Eigen::AngleAxisd(motion.position, motion.axis) * closed.normal) < 0)
    open_normal = -open_normal;
  const double angle =
      std::atan2(closed.normal.cross(open_normal).dot(motion.axis), closed.normal.dot(open_normal));
  if (angle > 0) motion.position = angle;
  // Both faces touch a cylinder about the hinge, which is behind them on the bisector of their angle.
  const Vector3d between = (closed.normal + open_normal).normalized();
  motion.origin = line - between * kFaceMotion.hinge_depth_m / std::max(between.dot(closed.normal), 0.2);
  return motion;
}

bool on_fixture(const Vector3d& p, const Front& front) {
  if (!front.fixture) return false;
  Vector3d off = p - front.fixture->centre;
  off -= off.dot(front.normal) * front.normal;
  const double along = off.dot(front.fixture->axis), across = (off - along * front.fixture->axis).norm();
  return std::abs(along) < front.fixture->length / 2 + kFaceMotion.fixture_gap_m &&
         across < front.fixture->radius + kFaceMotion.fixture_gap_m;
}

/// Whether a point near a closed front lies on the face of its panel: neither on its edges, which are seen at
/// a slant, nor on its fixture.
bool on_panel(const Vector3d& p, const Front& front) {
  const Vector3d off = p - front.centre;
  const auto is_inside = [&](const Vector3d& direction, double extent) {
    return std::abs(off.dot(direction)) <
           std::min(kFaceMotion.inner * extent, extent / 2 - kFaceMotion.edge_m);
  };
  return is_inside(front.right(), front.width) && is_inside(front.up, front.height) && !on_fixture(p, front);
}

/// Points on a front's rectangle by cells of 3 cm: their number and distance from its face.
class FrontCells {
 public:
  struct Cell {
    size_t count = 0;
    double sum = 0;  ///< of distances
  };

  FrontCells(const std::vector<Vector3d>& points, const Front& front, const FittedPlane& closed) {
    const int columns = std::max(1, static_cast<int>(front.width / kFaceMotion.cell_m)),
              rows = std::max(1, static_cast<int>(front.height / kFaceMotion.cell_m));
    cells_.resize(static_cast<size_t>(columns * rows));
    for (const Vector3d& p : points) {
      const Vector3d off = p - front.centre;
      const int column = static_cast<int>(std::floor((off.dot(front.right()) / front.width + 0.5) * columns));
      const int row = static_cast<int>(std::floor((off.dot(front.up) / front.height + 0.5) * rows));
      if (column < 0 || column >= columns || row < 0 || row >= rows) continue;
      Cell& cell = cells_[static_cast<size_t>(row * columns + column)];
      ++cell.count;
      cell.sum += closed.distance(p);
    }
  }

  /// Of the cells that fulfil a condition.
  double share(const std::function<bool(const Cell&)>& condition) const {
    return static_cast<double>(std::count_if(cells_.begin(), cells_.end(), condition)) /
           static_cast<double>(cells_.size());
  }

 private:
  std::vector<Cell> cells_;
};

std::vector<Vector3d> moved_back(const MovedFace& face, const std::vector<Vector3d>& moved) {
  const Isometry3d closed_from_moved = face.motion.moved_from_closed().inverse();
  std::vector<Vector3d> back;
  for (const Vector3d& p : moved)
    if (std::abs(face.open.distance(p)) < kFaceMotion.on_face_m) back.push_back(closed_from_moved * p);
  return back;
}

/// Refines the open plane by the points on the face of the panel.
FittedPlane panel_face(const MovedFace& face, const std::vector<Vector3d>& moved, const Front& front) {
  const Isometry3d closed_from_moved = face.motion.moved_from_closed().inverse();
  std::vector<Vector3d> on_face;
  for (const Vector3d& p : moved)
    if (std::abs(face.open.distance(p)) < kFaceMotion.on_face_m && on_panel(closed_from_moved * p, front))
      on_face.push_back(p);
  return on_face.size() < kFaceMotion.min_points ? face.open
                                                 : refined_plane(face.open, on_face, kFaceMotion.on_face_m);
}

}  // namespace

FittedPlane closed_face(const std::vector<Vector3d>& before, const Front& front) {
  std::vector<Vector3d> on_face;
  for (const Vector3d& p : before)
    if (std::abs((p - front.centre).dot(front.normal)) < kFaceMotion.closed_m && on_panel(p, front))
      on_face.push_back(p);
  FittedPlane assumed{front.normal, front.normal.dot(front.centre), kFaceMotion.normal_sd, 0};
  if (on_face.size() < kFaceMotion.min_points) return assumed;
  FittedPlane face = refined_plane(assumed, on_face, kFaceMotion.closed_inlier_m);
  const Vector3d middle = front.centre - face.normal * face.distance(front.centre);
  const double seen = 1 / (face.normal_sd * face.normal_sd),
               mapped = 1 / (kFaceMotion.normal_sd * kFaceMotion.normal_sd);
  face.normal = (seen * face.normal + mapped * front.normal).normalized();
  face.normal_sd = 1 / std::sqrt(seen + mapped);
  face.offset = face.normal.dot(middle);
  return face;
}

double static_share(const std::vector<Vector3d>& points, const FittedPlane& closed, const Front& front) {
  std::vector<Vector3d> near;
  for (const Vector3d& p : points)
    if (std::abs(closed.distance(p)) < kFaceMotion.near_face_m) near.push_back(p);
  const FrontCells cells(near, front, closed);
  return cells.share([](const FrontCells::Cell& cell) {
    return cell.count > 0 && std::abs(cell.sum / static_cast<double>(cell.count)) < kFaceMotion.still_m;
  });
}

std::array<std::optional<MovedFace>, 3> moved_faces(const FittedPlane& closed,
                                                    const std::vector<Vector3d>& moved, const Front& front,
                                                    double tolerance) {
  std::array<std::optional<MovedFace>, 3> best;
  const auto add_candidate = [&](const FittedPlane& found, const auto& motion_to) {
    MovedFace face{motion_to(found), found, 0};
    for (int round = 0; round < kFaceMotion.rounds; ++round) {
      face.open = panel_face(face, moved, front);
      face.motion = motion_to(face.open);
    }
    if (face.motion.position <
        (face.motion.type == ArticulationType::prismatic ? tolerance : kFaceMotion.parallel_deg * kDegree))
      return;
    face.coverage =
        FrontCells(moved_back(face, moved), front, closed).share([](const FrontCells::Cell& cell) {
          return cell.count > 0;
        });
    std::optional<MovedFace>& known = best[static_cast<size_t>(face.motion.type)];
    if (!known || face.coverage > known->coverage) known = face;
  };
  if (const auto open = find_plane(moved, [&](const Vector3d& n) {
        return std::abs(n.dot(closed.normal)) > std::cos(kFaceMotion.parallel_deg * kDegree);
      })) {
    const FittedPlane face = open->normal.dot(closed.normal) < 0 ? open->flipped() : *open;
    add_candidate(face, [&](const FittedPlane& to) { return sliding_motion(closed, to, front); });
  }
  for (const Vector3d& hinge : {front.up, front.right()})
    if (const auto open = find_plane(moved, [&](const Vector3d& n) {
          return std::abs(n.dot(hinge)) < std::sin(kFaceMotion.square_deg * kDegree) &&
                 std::abs(n.dot(closed.normal)) < std::cos(kFaceMotion.parallel_deg * kDegree);
        })) {
      Vector3d centre = Vector3d::Zero();
      size_t count = 0;
      for (const Vector3d& p : moved)
        if (std::abs(open->distance(p)) < kFaceMotion.on_face_m) {
          centre += p;
          ++count;
        }
      centre /= static_cast<double>(count);
      add_candidate(*open, [&](const FittedPlane& to) { return rotating_motion(closed, to, front, centre); });
    }
  return best;
}

}  // namespace loci::mapping
