#include "mapping/interpretation/walls.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "mapping/base/cell_index.h"

namespace loci {
namespace {

constexpr double kSurfel = 0.03;      // m; points are thinned to these before planes are sought
constexpr double kAreaCell = 0.05;    // m; area of a plane is counted in such cells
constexpr double kOffsetBin = 0.03;   // m
constexpr int kAngleBins = 120;       // of 3 degrees
constexpr double kFacing = 0.94;      // cosine between a point's normal and its plane's
constexpr double kBehind = 0.12;      // m; what lies farther behind a plane speaks against a wall
constexpr double kMostBehind = 0.35;  // windows and doors let one look behind a part of a wall
constexpr double kSameWall =
    0.07;                     // m; parallel layers this near (noise, drift, posters) belong to the plane
constexpr double kGap = 0.6;  // m; wider gaps part a plane into pieces
constexpr size_t kMostPlanes = 60;

/// A small piece of surface.
struct Surfel {
  Vector3d position = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();
  size_t count = 0;
  std::set<int> scans;
  bool taken = false;

  bool vertical() const { return normal.squaredNorm() > 0.5 && std::abs(normal.z()) < 0.25; }
};

std::vector<Surfel> surfels_of(const Surface& surface) {
  CellIndex index(surface.points.size() / 8);
  std::vector<Surfel> surfels;
  for (const SurfacePoint& point : surface.points) {
    const uint32_t number = index.insert(cell_of(point.position, kSurfel));
    if (number == surfels.size()) surfels.emplace_back();
    Surfel& surfel = surfels[number];
    surfel.position += point.position.cast<double>();
    surfel.normal += point.normal.cast<double>();
    ++surfel.count;
    surfel.scans.insert(point.scan);
  }
  for (Surfel& surfel : surfels) {
    surfel.position /= static_cast<double>(surfel.count);
    const double length = surfel.normal.norm();
    surfel.normal = length > 0.3 * static_cast<double>(surfel.count) ? Vector3d(surfel.normal / length)
                                                                     : Vector3d(Vector3d::Zero());
  }
  return surfels;
}

/// Votes of vertical surfels for (angle, offset) of vertical planes.
class PlaneVotes {
 public:
  explicit PlaneVotes(const std::vector<Surfel>& surfels) {
    for (const Surfel& surfel : surfels)
      if (surfel.vertical()) reach_ = std::max(reach_, surfel.position.head<2>().norm());
    offsets_ = 2 * static_cast<int>(reach_ / kOffsetBin + 2) + 1;
    votes_.assign(static_cast<size_t>(kAngleBins * offsets_), 0);
    for (const Surfel& surfel : surfels)
      if (surfel.vertical()) vote(surfel, 1);
  }

  void vote(const Surfel& surfel, int amount) {
    const double angle = std::atan2(surfel.normal.y(), surfel.normal.x());
    const int centre = static_cast<int>(std::lround(angle / step()));
    for (int d = -2; d <= 2; ++d) {
      const int bin = (centre + d + 2 * kAngleBins) % kAngleBins;
      const Vector2d normal = direction(bin);
      const int offset =
          static_cast<int>(std::lround(normal.dot(surfel.position.head<2>()) / kOffsetBin)) + offsets_ / 2;
      votes_[static_cast<size_t>(bin * offsets_ + offset)] += amount;
    }
  }

  struct Peak {
    Vector2d normal;
    double offset = 0;
    int votes = 0;
  };
  Peak strongest() const {
    const auto best = std::max_element(votes_.begin(), votes_.end());
    const int at = static_cast<int>(best - votes_.begin());
    return {direction(at / offsets_), (at % offsets_ - offsets_ / 2) * kOffsetBin, *best};
  }
  void forget(const Peak& peak) {
    const int angle = static_cast<int>(std::lround(std::atan2(peak.normal.y(), peak.normal.x()) / step()));
    const int offset = static_cast<int>(std::lround(peak.offset / kOffsetBin)) + offsets_ / 2;
    votes_[static_cast<size_t>((angle + kAngleBins) % kAngleBins * offsets_ + offset)] = 0;
  }

 private:
  static double step() { return 2 * std::numbers::pi / kAngleBins; }
  static Vector2d direction(int bin) { return {std::cos(bin * step()), std::sin(bin * step())}; }

  double reach_ = 0;
  int offsets_ = 0;
  std::vector<int> votes_;
};

std::vector<size_t> inliers_of(const std::vector<Surfel>& surfels, const Vector2d& normal, double offset,
                               double tolerance) {
  std::vector<size_t> inliers;
  for (size_t i = 0; i < surfels.size(); ++i) {
    const Surfel& surfel = surfels[i];
    if (surfel.taken || !surfel.vertical()) continue;
    if (std::abs(normal.dot(surfel.position.head<2>()) - offset) > tolerance) continue;
    if (normal.dot(surfel.normal.head<2>()) > kFacing) inliers.push_back(i);
  }
  return inliers;
}

/// Fits a line in x, y to inliers, a few times; returns the last inliers.
std::vector<size_t> refine(const std::vector<Surfel>& surfels, Vector2d& normal, double& offset,
                           double tolerance) {
  std::vector<size_t> inliers;
  for (const double width : {0.06, 0.04, 0.03, tolerance}) {
    inliers = inliers_of(surfels, normal, offset, width);
    if (inliers.size() < 20) break;
    Vector2d mean = Vector2d::Zero();
    for (const size_t i : inliers) mean += surfels[i].position.head<2>();
    mean /= static_cast<double>(inliers.size());
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const size_t i : inliers) {
      const Vector2d d = surfels[i].position.head<2>() - mean;
      covariance += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance);
    // A patch that is not much longer than thick says nothing about the direction.
    if (solver.eigenvalues()[1] > 20 * solver.eigenvalues()[0]) {
      Vector2d fitted = solver.eigenvectors().col(0);
      if (fitted.dot(normal) < 0) fitted = -fitted;
      if (fitted.dot(normal) > 0.98) normal = fitted;
    }
    offset = normal.dot(mean);
  }
  return inliers_of(surfels, normal, offset, tolerance * 1.5);
}

/// Parts a plane's inliers where there is a wide gap along it.
std::vector<std::vector<size_t>> pieces(const std::vector<Surfel>& surfels, std::vector<size_t> inliers,
                                        const Vector2d& direction) {
  const auto along = [&](size_t i) { return direction.dot(surfels[i].position.head<2>()); };
  std::stable_sort(inliers.begin(), inliers.end(), [&](size_t a, size_t b) { return along(a) < along(b); });
  std::vector<std::vector<size_t>> parts;
  double last = -1e9;
  for (const size_t i : inliers) {
    if (along(i) - last > kGap) parts.emplace_back();
    last = along(i);
    parts.back().push_back(i);
  }
  return parts;
}

double percentile(std::vector<double> values, double fraction) {
  const auto at = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<size_t>(at)];
}

VerticalPlane plane_of(const std::vector<Surfel>& surfels, const std::vector<size_t>& inliers,
                       const Vector2d& normal) {
  VerticalPlane plane;
  plane.normal = normal;
  std::vector<double> distances, along, heights;
  std::set<std::pair<int, int>> cells;
  std::set<int> scans;
  for (const size_t i : inliers) {
    const Surfel& surfel = surfels[i];
    distances.push_back(normal.dot(surfel.position.head<2>()));
    along.push_back(plane.direction().dot(surfel.position.head<2>()));
    heights.push_back(surfel.position.z());
    cells.emplace(std::floor(along.back() / kAreaCell), std::floor(heights.back() / kAreaCell));
    scans.insert(surfel.scans.begin(), surfel.scans.end());
    plane.inliers += surfel.count;
  }
  plane.offset = percentile(distances, 0.5);
  plane.along_min = percentile(along, 0.005);
  plane.along_max = percentile(along, 0.995);
  plane.bottom = percentile(heights, 0.005);
  plane.top = percentile(heights, 0.995);
  plane.area = static_cast<double>(cells.size()) * kAreaCell * kAreaCell;
  double squares = 0;
  for (const double distance : distances) squares += (distance - plane.offset) * (distance - plane.offset);
  plane.sd = std::sqrt(squares / static_cast<double>(distances.size()));
  plane.scans.assign(scans.begin(), scans.end());
  return plane;
}

/// Fraction of the plane's length, in columns, behind which something was seen.
double seen_behind(const std::vector<Surfel>& surfels, const VerticalPlane& plane, double floor_height) {
  const double margin = std::min(0.1, plane.length() / 4);
  const auto columns = static_cast<size_t>((plane.length() - 2 * margin) / kAreaCell) + 1;
  std::vector<int> behind(columns, 0);
  for (const Surfel& surfel : surfels) {
    if (surfel.position.z() < floor_height + 0.1) continue;
    const double depth = plane.offset - plane.normal.dot(surfel.position.head<2>());
    if (depth < kBehind || depth > 4) continue;
    const double along = plane.direction().dot(surfel.position.head<2>()) - plane.along_min - margin;
    if (along < 0 || along >= static_cast<double>(columns) * kAreaCell) continue;
    ++behind[static_cast<size_t>(along / kAreaCell)];
  }
  const auto seen = std::count_if(behind.begin(), behind.end(), [](int count) { return count >= 3; });
  return static_cast<double>(seen) / static_cast<double>(columns);
}

std::string why_no_wall(const VerticalPlane& plane, double floor_height,
                        const InterpretationOptions& options) {
  if (plane.area < options.wall_min_area_m2) return fmt::format("only {:.2f} m2 were seen", plane.area);
  if (plane.top < floor_height + options.wall_min_top_m)
    return fmt::format("its top is at {:.2f} m", plane.top);
  if (plane.behind > kMostBehind)
    return fmt::format("something was seen behind {:.0f} % of its length", 100 * plane.behind);
  return {};
}

/// A plane that stands at the depth of furniture before a wall of the same direction, which goes on beside
/// it, is the front of tall furniture.
void part_furniture_from_walls(WallSearch& search) {
  constexpr double kShallowest = 0.25;
  constexpr double kDeepest = 0.8;
  constexpr double kBeside = 0.5;       // m between the two along the wall
  constexpr double kLeastLength = 0.8;  // m; less may be a niche in the wall
  std::vector<VerticalPlane> walls;
  for (const VerticalPlane& plane : search.walls) {
    double before = 0;
    for (const VerticalPlane& wall : search.walls) {
      const double distance =
          wall.normal.dot(plane.at((plane.along_min + plane.along_max) / 2)) - wall.offset;
      if (wall.normal.dot(plane.normal) < 0.99 || distance < kShallowest || distance > kDeepest) continue;
      if (wall.length() < kLeastLength) continue;
      const double gap =
          std::max(plane.along_min, wall.along_min) - std::min(plane.along_max, wall.along_max);
      if (gap < kBeside) before = distance;
    }
    if (before > 0) {
      const Vector2d middle = plane.at((plane.along_min + plane.along_max) / 2);
      search.notes.push_back(
          fmt::format("vertical plane of {:.2f} m2 at ({:.2f}, {:.2f}) is no wall: it stands {:.2f} m before "
                      "one, as furniture does",
                      plane.area, middle.x(), middle.y(), before));
      search.others.push_back(plane);
    } else {
      walls.push_back(plane);
    }
  }
  search.walls = std::move(walls);
}

}  // namespace

WallSearch find_walls(const Surface& surface, double floor_height, const InterpretationOptions& options) {
  std::vector<Surfel> surfels = surfels_of(surface);
  PlaneVotes votes(surfels);
  WallSearch result;
  const int fewest = static_cast<int>(0.3 * options.wall_min_area_m2 / (kSurfel * kSurfel));
  for (size_t round = 0; round < kMostPlanes; ++round) {
    const PlaneVotes::Peak peak = votes.strongest();
    if (peak.votes < fewest) break;
    Vector2d normal = peak.normal;
    double offset = peak.offset;
    const std::vector<size_t> inliers = refine(surfels, normal, offset, options.plane_tolerance_m);
    if (inliers.size() < static_cast<size_t>(fewest)) {
      votes.forget(peak);
      continue;
    }
    for (const size_t i : inliers_of(surfels, normal, offset, kSameWall)) {
      surfels[i].taken = true;
      votes.vote(surfels[i], -1);
    }
    for (const std::vector<size_t>& piece : pieces(surfels, inliers, {-normal.y(), normal.x()})) {
      VerticalPlane plane = plane_of(surfels, piece, normal);
      if (plane.area < options.wall_min_area_m2 / 2) continue;
      plane.behind = seen_behind(surfels, plane, floor_height);
      const std::string why = why_no_wall(plane, floor_height, options);
      const Vector2d middle = plane.at((plane.along_min + plane.along_max) / 2);
      if (!why.empty())
        result.notes.push_back(fmt::format("vertical plane of {:.2f} m2 at ({:.2f}, {:.2f}) is no wall: {}",
                                           plane.area, middle.x(), middle.y(), why));
      (why.empty() ? result.walls : result.others).push_back(std::move(plane));
    }
  }
  part_furniture_from_walls(result);
  return result;
}

}  // namespace loci
