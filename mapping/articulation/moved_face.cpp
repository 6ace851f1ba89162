#include "mapping/articulation/moved_face.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "mapping/base/math.h"

namespace loci::mapping {
namespace {

using Type = JointEstimate::Type;
constexpr double kHingeBehindFace = 0.01;  ///< as in the prior: the middle of a panel
constexpr double kParallelDeg = 4;         ///< faces that differ by less did not turn
constexpr double kOnFace = 0.025;          ///< metres
constexpr size_t kMinPoints = 40;
constexpr int kRounds = 3;  ///< as a face settles, so does what belongs to it
constexpr double kCell = 0.03;
constexpr double kInner = 0.45;           ///< of a front's extent, from its middle
constexpr double kBesideFixture = 0.015;  ///< metres, where beams still touch it
constexpr double kLeanSd = 0.01;          ///< radians, of a front's normal in the map
constexpr double kNearFace = 0.05;        ///< what is seen so near to the closed face …
constexpr double kStillThere = 0.01;  ///< … is the face itself when its mean is so near: carcasses lie deeper

Motion slid(const Face& closed, const Face& open, const Front& front) {
  Motion motion;
  motion.type = Type::prismatic;
  motion.axis = closed.normal;
  motion.origin = front.centre;
  motion.position = open.offset - closed.normal.dot(closed.normal * closed.offset);
  return motion;
}

/// The turn between two planes; `moved` tells to which side of the hinge the part went.
Motion turned(const Face& closed, const Face& open, const Front& front, const Vector3d& moved) {
  Motion motion;
  motion.type = Type::revolute;
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
  // The faces touch a cylinder about the hinge, which lies behind both: on the line that halves their angle.
  const Vector3d between = (closed.normal + open_normal).normalized();
  motion.origin = line - between * kHingeBehindFace / std::max(between.dot(closed.normal), 0.2);
  return motion;
}

bool on_fixture(const Vector3d& p, const Front& front) {
  if (!front.fixture) return false;
  Vector3d off = p - front.fixture->centre;
  off -= off.dot(front.normal) * front.normal;
  const double along = off.dot(front.fixture->axis), across = (off - along * front.fixture->axis).norm();
  return std::abs(along) < front.fixture->length / 2 + kBesideFixture &&
         across < front.fixture->radius + kBesideFixture;
}

/// Whether a point by a closed front lies on its panel's broad side: not on its edge, whose thickness is seen
/// at a slant, nor on its fixture.
bool on_panel(const Vector3d& p, const Front& front) {
  const Vector3d off = p - front.centre;
  return std::abs(off.dot(front.right())) < kInner * front.width &&
         std::abs(off.dot(front.up)) < kInner * front.height && !on_fixture(p, front);
}

/// A front's rectangle in cells of 3 cm: how many points lie on each, and their distance from its face.
class FrontCells {
 public:
  struct Cell {
    size_t count = 0;
    double sum = 0;  ///< of distances
  };

  FrontCells(const std::vector<Vector3d>& points, const Front& front, const Face& closed) {
    const int columns = std::max(1, static_cast<int>(front.width / kCell)),
              rows = std::max(1, static_cast<int>(front.height / kCell));
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

  /// Of the cells that are as asked.
  double share(const std::function<bool(const Cell&)>& asked) const {
    return static_cast<double>(std::count_if(cells_.begin(), cells_.end(), asked)) /
           static_cast<double>(cells_.size());
  }

 private:
  std::vector<Cell> cells_;
};

std::vector<Vector3d> put_back(const MovedFace& face, const std::vector<Vector3d>& moved) {
  const Isometry3d closed_from_moved = face.motion.moved_from_closed().inverse();
  std::vector<Vector3d> back;
  for (const Vector3d& p : moved)
    if (std::abs(face.open.distance(p)) < kOnFace) back.push_back(closed_from_moved * p);
  return back;
}

/// The open face by what lies on the panel's broad side when it is put back.
Face panel_face(const MovedFace& face, const std::vector<Vector3d>& moved, const Front& front) {
  const Isometry3d closed_from_moved = face.motion.moved_from_closed().inverse();
  std::vector<Vector3d> on_face;
  for (const Vector3d& p : moved)
    if (std::abs(face.open.distance(p)) < kOnFace && on_panel(closed_from_moved * p, front))
      on_face.push_back(p);
  return on_face.size() < kMinPoints ? face.open : refined_face(face.open, on_face, kOnFace);
}

}  // namespace

/// The closed face: the plane through what was seen of it before, without its fixture. How it leans is known
/// from the map, too, which weighs for a small front.
Face closed_face(const std::vector<Vector3d>& before, const Front& front) {
  std::vector<Vector3d> on_face;
  for (const Vector3d& p : before)
    if (std::abs((p - front.centre).dot(front.normal)) < 0.04 && on_panel(p, front)) on_face.push_back(p);
  const Face assumed{front.normal, front.normal.dot(front.centre), kLeanSd, 0};
  if (on_face.size() < kMinPoints) return assumed;
  Face face = refined_face(assumed, on_face, 0.03);
  const Vector3d middle = front.centre - face.normal * face.distance(front.centre);
  const double seen = 1 / (face.normal_sd * face.normal_sd), told = 1 / (kLeanSd * kLeanSd);
  face.normal = (seen * face.normal + told * front.normal).normalized();
  face.normal_sd = 1 / std::sqrt(seen + told);
  face.offset = face.normal.dot(middle);
  return face;
}

double still_share(const std::vector<Vector3d>& points, const Face& closed, const Front& front) {
  std::vector<Vector3d> near;
  for (const Vector3d& p : points)
    if (std::abs(closed.distance(p)) < kNearFace) near.push_back(p);
  const FrontCells cells(near, front, closed);
  return cells.share([](const FrontCells::Cell& cell) {
    return cell.count > 0 && std::abs(cell.sum / static_cast<double>(cell.count)) < kStillThere;
  });
}

std::array<std::optional<MovedFace>, 3> moved_faces(const Face& closed, const std::vector<Vector3d>& moved,
                                                    const Front& front, double tolerance) {
  std::array<std::optional<MovedFace>, 3> best;
  const auto consider = [&](const Face& found, const auto& motion_to) {
    MovedFace face{motion_to(found), found, 0};
    for (int round = 0; round < kRounds; ++round) {
      face.open = panel_face(face, moved, front);
      face.motion = motion_to(face.open);
    }
    if (face.motion.position < (face.motion.type == Type::prismatic ? tolerance : kParallelDeg * kPi / 180))
      return;
    face.coverage = FrontCells(put_back(face, moved), front, closed).share([](const FrontCells::Cell& cell) {
      return cell.count > 0;
    });
    std::optional<MovedFace>& known = best[static_cast<size_t>(face.motion.type)];
    if (!known || face.coverage > known->coverage) known = face;
  };
  if (const auto open = find_face(moved, [&](const Vector3d& n) {
        return std::abs(n.dot(closed.normal)) > std::cos(kParallelDeg * kPi / 180);
      })) {
    const Face face = open->normal.dot(closed.normal) < 0 ? open->flipped() : *open;
    consider(face, [&](const Face& to) { return slid(closed, to, front); });
  }
  for (const Vector3d& hinge : {front.up, front.right()})
    if (const auto open = find_face(moved, [&](const Vector3d& n) {
          return std::abs(n.dot(hinge)) < std::sin(8 * kPi / 180) &&
                 std::abs(n.dot(closed.normal)) < std::cos(kParallelDeg * kPi / 180);
        })) {
      Vector3d centre = Vector3d::Zero();
      size_t count = 0;
      for (const Vector3d& p : moved)
        if (std::abs(open->distance(p)) < kOnFace) {
          centre += p;
          ++count;
        }
      centre /= static_cast<double>(count);
      consider(*open, [&](const Face& to) { return turned(closed, to, front, centre); });
    }
  return best;
}

}  // namespace loci::mapping
