#include "mapping/interpretation/face_planes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/base/cell_index.h"
#include "mapping/interpretation/face_raster.h"
#include "mapping/interpretation/line_votes.h"

namespace loci::mapping {
namespace {

constexpr double kPiece = 0.03;          // m; side of the cells whose points are averaged
constexpr int kAngles = 240;             // of 1.5 degrees
constexpr int kAnglesBeside = 3;         // for which a piece votes besides its own
constexpr double kOffsetBin = 0.015;     // m
constexpr double kFacing = 0.95;         // cosine between a piece's normal and its plane's
constexpr double kTaken = 0.022;         // m; pieces this near to a plane are explained by it
constexpr double kMinArea = 0.04;        // m²; a small drawer front
constexpr double kGap = 1.0;             // m; a mirror-like front may leave such a hole
constexpr double kSameFace = 0.035;      // m; layers of one face
constexpr double kSameDirection = 0.99;  // cosine
constexpr int kBesideFixture = 3;        // cells of kPiece within which a plane goes on beside a fixture
constexpr size_t kMaxFaces = 80;
constexpr double kLowest = 0.03;  // m above the floor
constexpr size_t kMinPoints = 2;

/// A small piece of vertical surface.
struct Piece {
  Vector2d position = Vector2d::Zero();
  Vector2d normal = Vector2d::Zero();
  double height = 0;
  bool taken = false;
};

std::vector<Piece> pieces_of(const Surface& surface, double floor_height) {
  struct Sum {
    Vector3d position = Vector3d::Zero(), normal = Vector3d::Zero();
    double count = 0;
  };
  CellIndex index(surface.points.size() / 8);
  std::vector<Sum> sums;
  for (const SurfacePoint& point : surface.points) {
    if (std::abs(point.normal.z()) > 0.35F || point.normal.isZero()) continue;
    if (static_cast<double>(point.position.z()) < floor_height + kLowest) continue;
    const uint32_t number = index.insert(cell_of(point.position, kPiece));
    if (number == sums.size()) sums.emplace_back();
    Sum& sum = sums[number];
    sum.position += point.position.cast<double>();
    sum.normal += point.normal.cast<double>();
    ++sum.count;
  }
  std::vector<Piece> pieces;
  for (const Sum& sum : sums) {
    if (sum.count < kMinPoints || sum.normal.norm() < 0.6 * sum.count) continue;
    const Vector3d normal = sum.normal.normalized();
    if (std::abs(normal.z()) > 0.25) continue;
    const Vector3d position = sum.position / sum.count;
    pieces.push_back({position.head<2>(), normal.head<2>().normalized(), position.z(), false});
  }
  return pieces;
}

LineVotes votes_of(const std::vector<Piece>& pieces) {
  double reach = 0;
  for (const Piece& piece : pieces) reach = std::max(reach, piece.position.norm());
  LineVotes votes(reach, {kAngles, kAnglesBeside, kOffsetBin});
  for (const Piece& piece : pieces) votes.vote(piece.position, piece.normal, 1);
  return votes;
}

std::vector<size_t> inliers_of(const std::vector<Piece>& pieces, const Vector2d& normal, double offset,
                               double width) {
  std::vector<size_t> inliers;
  for (size_t i = 0; i < pieces.size(); ++i)
    if (!pieces[i].taken && std::abs(normal.dot(pieces[i].position) - offset) < width &&
        normal.dot(pieces[i].normal) > kFacing)
      inliers.push_back(i);
  return inliers;
}

/// Fits the plane to its inliers a few times, within ever narrower limits. The nearer a piece the more it
/// counts: of two layers, panels and the carcass beside them, the larger one shall win, not the mean.
std::vector<size_t> refine(const std::vector<Piece>& pieces, Vector2d& normal, double& offset) {
  std::vector<size_t> inliers;
  for (const double width : {0.03, 0.022, 0.018, 0.015, 0.015, 0.015}) {
    inliers = inliers_of(pieces, normal, offset, width);
    if (inliers.size() < 8) break;
    const auto weight = [&](size_t i) {
      const double off = (normal.dot(pieces[i].position) - offset) / width;
      return (1 - off * off) * (1 - off * off);
    };
    double sum = 0;
    Vector2d mean = Vector2d::Zero();
    for (const size_t i : inliers) {
      sum += weight(i);
      mean += weight(i) * pieces[i].position;
    }
    mean /= sum;
    double xx = 0;
    double xy = 0;
    double yy = 0;
    for (const size_t i : inliers) {
      const Vector2d d = pieces[i].position - mean;
      xx += weight(i) * d.x() * d.x();
      xy += weight(i) * d.x() * d.y();
      yy += weight(i) * d.y() * d.y();
    }
    const double along = 0.5 * std::atan2(2 * xy, xx - yy);
    const Vector2d fitted(-std::sin(along), std::cos(along));
    const Vector2d turned = fitted.dot(normal) < 0 ? Vector2d(-fitted) : fitted;
    if (turned.dot(normal) > 0.99) normal = turned;  // a short plane keeps its direction
    offset = normal.dot(mean);
  }
  return inliers;
}

/// Parts a plane where it has gaps wider than kGap.
std::vector<Face> faces_of(const std::vector<Piece>& pieces, std::vector<size_t> inliers,
                           const Vector2d& normal, double offset) {
  Face plane;
  plane.normal = normal;
  plane.offset = offset;
  const auto along = [&](size_t i) { return plane.right().dot(pieces[i].position); };
  std::stable_sort(inliers.begin(), inliers.end(), [&](size_t a, size_t b) { return along(a) < along(b); });
  std::vector<Face> faces;
  double last = -1e9;
  for (const size_t i : inliers) {
    const double u = along(i);
    if (u - last > kGap) {
      faces.push_back(plane);
      faces.back().u_min = u;
      faces.back().v_min = faces.back().v_max = pieces[i].height;
    }
    last = u;
    Face& face = faces.back();
    face.u_max = u;
    face.v_min = std::min(face.v_min, pieces[i].height);
    face.v_max = std::max(face.v_max, pieces[i].height);
    face.area += kPiece * kPiece;
  }
  std::erase_if(faces, [](const Face& face) { return face.area < kMinArea; });
  return faces;
}

/// A plane that was found before, with the cells of it that were seen.
class StrongerPlane {
 public:
  StrongerPlane(std::vector<Face> faces, const std::vector<Piece>& pieces, const std::vector<size_t>& inliers)
      : faces_(std::move(faces)) {
    for (const size_t i : inliers) seen_.insert(cell(pieces[i]));
  }

  bool is_parallel(const Vector2d& normal) const {
    return faces_.front().normal.dot(normal) > kSameDirection;
  }

  /// Whether a piece of a weaker plane along it is but its fringe: noise, mixed returns, panels a little
  /// behind it.
  bool has_fringe(const Piece& piece) const {
    const double u = faces_.front().right().dot(piece.position);
    return std::abs(before(piece)) < kSameFace &&
           std::any_of(faces_.begin(), faces_.end(), [&](const Face& face) {
             return u > face.u_min - kGap / 4 && u < face.u_max + kGap / 4;
           });
  }

  /// Whether a piece belongs to something narrow that stands a little before it, with the plane to be seen on
  /// both sides: equal handles make a plane of their own.
  bool has_fixture(const Piece& piece) const {
    if (const double depth = before(piece); depth < 0 || depth > kFixtureReach) return false;
    const Eigen::Vector3i at = cell(piece);
    const auto seen_towards = [&](int du, int dv) {
      for (int step = 1; step <= kBesideFixture; ++step)
        if (seen_.find(at + step * Eigen::Vector3i(du, dv, 0)) != CellIndex::kNone) return true;
      return false;
    };
    return (seen_towards(1, 0) && seen_towards(-1, 0)) || (seen_towards(0, 1) && seen_towards(0, -1));
  }

 private:
  double before(const Piece& piece) const {
    return faces_.front().normal.dot(piece.position) - faces_.front().offset;
  }
  Eigen::Vector3i cell(const Piece& piece) const {
    return cell_of(Vector3d(faces_.front().right().dot(piece.position), piece.height, 0), kPiece);
  }

  std::vector<Face> faces_;  ///< pieces of the one plane; never empty
  CellIndex seen_;
};

/// Told piece by piece: a plane that is askew by less than a degree may run along a whole row of fronts and
/// yet have a surface of its own elsewhere.
bool is_explained(const Piece& piece, const Vector2d& normal, const std::vector<StrongerPlane>& stronger) {
  return std::any_of(stronger.begin(), stronger.end(), [&](const StrongerPlane& plane) {
    return plane.is_parallel(normal) && (plane.has_fringe(piece) || plane.has_fixture(piece));
  });
}

}  // namespace

std::vector<Face> find_faces(const Surface& surface, double floor_height) {
  std::vector<Piece> pieces = pieces_of(surface, floor_height);
  std::vector<Face> faces;
  std::vector<StrongerPlane> stronger;
  if (pieces.empty()) return faces;
  LineVotes votes = votes_of(pieces);
  const int fewest = static_cast<int>(0.4 * kMinArea / (kPiece * kPiece));
  for (size_t round = 0; round < 4 * kMaxFaces && faces.size() < kMaxFaces; ++round) {
    const LineVotes::Peak peak = votes.strongest();
    if (peak.votes < fewest) break;
    Vector2d normal = peak.normal;
    double offset = peak.offset;
    std::vector<size_t> inliers = refine(pieces, normal, offset);
    if (faces_of(pieces, inliers, normal, offset).empty()) {
      votes.forget(peak);
      continue;
    }
    for (const size_t i : inliers_of(pieces, normal, offset, kTaken)) {
      pieces[i].taken = true;
      votes.vote(pieces[i].position, pieces[i].normal, -1);
    }
    std::erase_if(inliers, [&](size_t i) { return is_explained(pieces[i], normal, stronger); });
    const std::vector<Face> found = faces_of(pieces, inliers, normal, offset);
    faces.insert(faces.end(), found.begin(), found.end());
    if (!found.empty()) stronger.emplace_back(found, pieces, inliers);
  }
  return faces;
}

}  // namespace loci::mapping
