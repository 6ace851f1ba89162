#include "mapping/interpretation/surfaces/vertical_planes.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/interpretation/surfaces/parameters.h"

namespace loci::mapping {

LineVotes::LineVotes(double reach, const Bins& bins)
    : bins_(bins),
      step_(2 * kPi / bins.angles),
      offsets_(2 * static_cast<int>(reach / bins.offset_m + 2) + 1),
      votes_(static_cast<size_t>(bins.angles * offsets_), 0) {}

Vector2d LineVotes::direction(int angle) const {
  return {std::cos(angle * step_), std::sin(angle * step_)};
}

void LineVotes::vote(const Vector2d& position, const Vector2d& normal, int amount) {
  const int centre = static_cast<int>(std::lround(std::atan2(normal.y(), normal.x()) / step_));
  for (int d = -bins_.spread; d <= bins_.spread; ++d) {
    const int angle = (centre + d + 2 * bins_.angles) % bins_.angles;
    const int offset =
        static_cast<int>(std::lround(direction(angle).dot(position) / bins_.offset_m)) + offsets_ / 2;
    votes_[static_cast<size_t>(angle * offsets_ + offset)] += amount;
  }
}

LineVotes::Peak LineVotes::strongest() const {
  const auto best = std::max_element(votes_.begin(), votes_.end());
  const int at = static_cast<int>(best - votes_.begin());
  const int offset = at % offsets_ - offsets_ / 2;
  return {direction(at / offsets_), offset * bins_.offset_m, *best, static_cast<size_t>(at)};
}

namespace {

LineVotes votes_of(const std::vector<Surfel>& surfels, const std::vector<size_t>& upright) {
  double reach = 0;
  for (const size_t i : upright) reach = std::max(reach, surfels[i].position.head<2>().norm());
  LineVotes votes(reach, {kWalls.angle_bins, kWalls.angle_spread_bins, kWalls.offset_bin_m});
  for (const size_t i : upright) votes.vote(surfels[i].position.head<2>(), surfels[i].normal.head<2>(), 1);
  return votes;
}

std::vector<size_t> inliers_of(const std::vector<Surfel>& surfels, const std::vector<size_t>& upright,
                               const Vector2d& normal, double offset, double tolerance) {
  std::vector<size_t> inliers;
  for (const size_t i : upright) {
    const Surfel& surfel = surfels[i];
    if (surfel.taken) continue;
    if (std::abs(normal.dot(surfel.position.head<2>()) - offset) > tolerance) continue;
    if (normal.dot(surfel.normal.head<2>()) > kWalls.min_facing_cosine) inliers.push_back(i);
  }
  return inliers;
}

/// The line in x, y through inliers; `normal` stays where they do not determine it.
void fit(const std::vector<Surfel>& surfels, const std::vector<size_t>& inliers, Vector2d& normal,
         double& offset) {
  Vector2d mean = Vector2d::Zero();
  for (const size_t i : inliers) mean += surfels[i].position.head<2>();
  mean /= static_cast<double>(inliers.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const size_t i : inliers) {
    const Vector2d d = surfels[i].position.head<2>() - mean;
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance);
  // A patch that is not much longer than thick does not determine the direction.
  if (solver.eigenvalues()[1] > 20 * solver.eigenvalues()[0]) {
    Vector2d fitted = solver.eigenvectors().col(0);
    if (fitted.dot(normal) < 0) fitted = -fitted;
    if (fitted.dot(normal) > 0.98) normal = fitted;
  }
  offset = normal.dot(mean);
}

/// Fits a plane to its inliers repeatedly; returns the last inliers.
std::vector<size_t> refine(const std::vector<Surfel>& surfels, const std::vector<size_t>& upright,
                           Vector2d& normal, double& offset, double tolerance) {
  for (const double width : {0.06, 0.04, 0.03, tolerance}) {
    const std::vector<size_t> inliers = inliers_of(surfels, upright, normal, offset, width);
    if (inliers.size() < 20) break;
    fit(surfels, inliers, normal, offset);
  }
  return inliers_of(surfels, upright, normal, offset, tolerance * 1.5);
}

/// Splits a plane's inliers at wide gaps along it.
std::vector<std::vector<size_t>> split_at_gaps(const std::vector<Surfel>& surfels,
                                               std::vector<size_t> inliers, const Vector2d& direction) {
  const auto along = [&](size_t i) { return direction.dot(surfels[i].position.head<2>()); };
  std::stable_sort(inliers.begin(), inliers.end(), [&](size_t a, size_t b) { return along(a) < along(b); });
  std::vector<std::vector<size_t>> parts;
  double last = -1e9;
  for (const size_t i : inliers) {
    if (along(i) - last > kWalls.max_gap_m) parts.emplace_back();
    last = along(i);
    parts.back().push_back(i);
  }
  return parts;
}

VerticalPlane plane_of(const std::vector<Surfel>& surfels, const std::vector<size_t>& inliers,
                       const Vector2d& normal) {
  VerticalPlane plane;
  plane.normal = normal;
  std::vector<double> distances, along, heights;
  std::set<std::pair<int, int>> cells;
  std::set<uint16_t> scans;
  for (const size_t i : inliers) {
    const Surfel& surfel = surfels[i];
    distances.push_back(normal.dot(surfel.position.head<2>()));
    along.push_back(plane.direction().dot(surfel.position.head<2>()));
    heights.push_back(surfel.position.z());
    cells.emplace(std::floor(along.back() / kWalls.area_cell_m),
                  std::floor(heights.back() / kWalls.area_cell_m));
    scans.insert(surfel.scans.begin(), surfel.scans.end());
    plane.inliers += surfel.count;
  }
  plane.offset = median(distances);
  plane.along_min = quantile(along, 0.005);
  plane.along_max = quantile(along, 0.995);
  plane.bottom = quantile(heights, 0.005);
  plane.top = quantile(heights, 0.995);
  plane.area = static_cast<double>(cells.size()) * kWalls.area_cell_m * kWalls.area_cell_m;
  double squares = 0;
  for (const double distance : distances) squares += (distance - plane.offset) * (distance - plane.offset);
  plane.sd = std::sqrt(squares / static_cast<double>(distances.size()));
  plane.scans.assign(scans.begin(), scans.end());
  return plane;
}

}  // namespace

std::vector<Surfel> surfels_of(const Surface& surface) {
  CellIndex index(surface.points.size() / 8);
  std::vector<Surfel> surfels;
  for (const SurfacePoint& point : surface.points) {
    const uint32_t number = index.insert(cell_of(point.position, kWalls.surfel_m));
    if (number == surfels.size()) surfels.emplace_back();
    Surfel& surfel = surfels[number];
    surfel.position += point.position.cast<double>();
    surfel.normal += point.normal.cast<double>();
    ++surfel.count;
    // Points are ordered by scan.
    if (surfel.scans.empty() || surfel.scans.back() != point.scan) surfel.scans.push_back(point.scan);
  }
  for (Surfel& surfel : surfels) {
    surfel.position /= static_cast<double>(surfel.count);
    const double length = surfel.normal.norm();
    surfel.normal = length > 0.3 * static_cast<double>(surfel.count) ? Vector3d(surfel.normal / length)
                                                                     : Vector3d(Vector3d::Zero());
  }
  return surfels;
}

std::vector<PlanePatch> vertical_planes(std::vector<Surfel>& surfels, const InterpretationOptions& options) {
  std::vector<size_t> upright;
  for (size_t i = 0; i < surfels.size(); ++i)
    if (surfels[i].vertical()) upright.push_back(i);
  LineVotes votes = votes_of(surfels, upright);
  std::vector<PlanePatch> result;
  const int min_votes =
      static_cast<int>(0.3 * options.min_wall_area_m2 / (kWalls.surfel_m * kWalls.surfel_m));
  for (size_t round = 0; round < kWalls.max_planes; ++round) {
    const LineVotes::Peak peak = votes.strongest();
    if (peak.votes < min_votes) break;
    Vector2d normal = peak.normal;
    double offset = peak.offset;
    const std::vector<size_t> inliers = refine(surfels, upright, normal, offset, options.plane_tolerance_m);
    if (inliers.size() < static_cast<size_t>(min_votes)) {
      votes.forget(peak);
      continue;
    }
    for (const size_t i : inliers_of(surfels, upright, normal, offset, kWalls.same_wall_m)) {
      surfels[i].taken = true;
      votes.vote(surfels[i].position.head<2>(), surfels[i].normal.head<2>(), -1);
    }
    for (std::vector<size_t>& piece : split_at_gaps(surfels, inliers, {-normal.y(), normal.x()})) {
      VerticalPlane plane = plane_of(surfels, piece, normal);
      if (plane.area >= options.min_wall_area_m2 / 2) result.push_back({std::move(plane), std::move(piece)});
    }
  }
  return result;
}

PlanePatch united(const std::vector<Surfel>& surfels, const PlanePatch& a, const PlanePatch& b) {
  PlanePatch patch;
  patch.surfels = a.surfels;
  patch.surfels.insert(patch.surfels.end(), b.surfels.begin(), b.surfels.end());
  Vector2d normal = a.plane.normal;
  double offset = a.plane.offset;
  fit(surfels, patch.surfels, normal, offset);
  patch.plane = plane_of(surfels, patch.surfels, normal);
  return patch;
}

}  // namespace loci::mapping
