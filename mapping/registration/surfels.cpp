#include "mapping/registration/surfels.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace loci::mapping::registration {
namespace {

/// A plane is trusted fully when its thickness variance is far below its smaller extent's, not at all at this
/// part of it.
constexpr double kThicknessRatio = 0.3;
/// Cosines of incidence between which trust rises from none to full.
constexpr double kGrazingCosine = 0.25;
constexpr double kSteepCosine = 0.45;
/// The spot of a beam this wide (radians; 0.2 degrees is usual) is so deep on a slanted surface, metres,
/// where trust falls from full to none: scanners then tend to report its near end, which would shift the
/// plane.
constexpr double kBeamWidth = 0.0035;
constexpr double kShallowSpot = 0.025;
constexpr double kDeepSpot = 0.05;
constexpr double kPointsForPlane = 5;
constexpr double kPointsOfOwn = 12;
constexpr float kSameSide = 0.5F;  ///< cosine: normals agree within 60 degrees

double rising(double value, double low, double high) {
  return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

/// Lower corner of the 2x2x2 cells whose union holds everything within half a cell of the point.
Eigen::Vector3i corner_of(const Eigen::Vector3f& point, double per_metre) {
  constexpr double far = 1 << 20;  // Adding it makes all positive: then the conversion rounds down.
  const Eigen::Array3d cells = point.cast<double>().array() * per_metre + (far - 0.5);
  return cells.cast<int>() - static_cast<int>(far);
}

void fit_plane(Surfels& surfels, size_t i, const Moments& moments, const PlaneFit& fit) {
  const Vector3d own = surfels.moments[i].sum / surfels.moments[i].count;
  surfels.position[i] = own.cast<float>();
  if (moments.count < kPointsForPlane) return;
  const Vector3d mean = moments.sum / moments.count;
  const Eigen::Matrix3d covariance = moments.products / moments.count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Vector3d values = solver.eigenvalues().cwiseMax(0.0);
  const double smallest_extent = 0.15 * surfels.cell;  // Less is a line or a spot.
  if (values[1] < smallest_extent * smallest_extent) return;
  Vector3d normal = solver.eigenvectors().col(0);
  const Vector3d ray = surfels.origin[i].cast<double>() - own;
  const Vector3d view = ray.normalized();
  double trust = 1 - rising(values[0] / values[1], 0.05, kThicknessRatio);
  if (fit.oriented) {
    const double cosine = std::abs(normal.dot(view));
    const double depth = kBeamWidth * ray.norm() * std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
    trust *= rising(cosine, kGrazingCosine, kSteepCosine) * (1 - rising(depth, kShallowSpot, kDeepSpot));
  }
  if (values[0] > kThicknessRatio * values[1]) return;
  if (normal.dot(view) < 0) normal = -normal;
  surfels.normal[i] = normal.cast<float>();
  surfels.trust[i] = static_cast<float>(trust);
  surfels.position[i] = (own - normal * normal.dot(own - mean)).cast<float>();
}

template <class Visit>
void for_neighbours(const Eigen::Vector3i& cell, const Visit& visit) {
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) visit(Eigen::Vector3i(cell + Eigen::Vector3i(x, y, z)));
}

/// A grid that covers cells and `border` more around them.
template <class Change>
CellGrid grid_over(const std::vector<Eigen::Vector3i>& cells, const Change& change, int border) {
  if (cells.empty()) return {};
  Eigen::Vector3i low = change(cells.front()), high = low;
  for (const Eigen::Vector3i& cell : cells) {
    low = low.cwiseMin(change(cell));
    high = high.cwiseMax(change(cell));
  }
  return {low.array() - border, high.array() + border, (low + high) / 2};
}

}  // namespace

uint32_t Surfels::number_of(const Eigen::Vector3i& at, const Eigen::Vector3f& seen_from) {
  uint32_t& number = grid.at(at);
  if (number == CellGrid::kNone) {
    number = static_cast<uint32_t>(cells.size());
    cells.push_back(at);
    moments.emplace_back();
    origin.push_back(seen_from);
  }
  return number;
}

uint32_t Surfels::nearest(const Eigen::Vector3f& point, const Eigen::Vector3f& facing, float radius) const {
  const bool has_side = facing.squaredNorm() > 0.5F;
  float best = radius * radius;
  uint32_t found = CellGrid::kNone;
  for (const uint32_t i : grid.find_eight(corner_of(point, 1 / cell))) {
    if (i == CellGrid::kNone) continue;
    const float squared = (position[i] - point).squaredNorm();
    if (squared >= best) continue;
    if (has_side && normal[i].squaredNorm() > 0.5F && normal[i].dot(facing) < kSameSide) continue;
    best = squared;
    found = i;
  }
  return found;
}

bool Surfels::near(const Eigen::Vector3f& point) const {
  const auto around = grid.find_eight(corner_of(point, 1 / cell));
  return std::any_of(around.begin(), around.end(), [](uint32_t i) { return i != CellGrid::kNone; });
}

Surfels coarser(const Surfels& fine) {
  Surfels coarse;
  coarse.cell = 2 * fine.cell;
  const auto half = [](const Eigen::Vector3i& cell) {
    return Eigen::Vector3i(cell.x() >> 1, cell.y() >> 1, cell.z() >> 1);
  };
  coarse.grid = grid_over(fine.cells, half, 0);
  for (size_t i = 0; i < fine.cells.size(); ++i) {
    const uint32_t number = coarse.number_of(half(fine.cells[i]), fine.origin[i]);
    coarse.moments[number].add(fine.moments[i]);
  }
  return coarse;
}

void fit_planes(Surfels& surfels, bool finest, const PlaneFit& fit) {
  const size_t count = surfels.moments.size();
  surfels.position.assign(count, Eigen::Vector3f::Zero());
  surfels.normal.assign(count, Eigen::Vector3f::Zero());
  surfels.trust.assign(count, 0.F);
  for (size_t i = 0; i < count; ++i) {
    if (!finest && surfels.moments[i].count >= kPointsOfOwn) {
      fit_plane(surfels, i, surfels.moments[i], fit);
      continue;
    }
    Moments around;
    for_neighbours(surfels.cells[i], [&](const Eigen::Vector3i& cell) {
      const uint32_t j = surfels.grid.find(cell);
      if (j != CellGrid::kNone) around.add(surfels.moments[j]);
    });
    fit_plane(surfels, i, around, fit);
  }
}

CellGrid wide_net(const Surfels& surfels) {
  CellGrid net = grid_over(
      surfels.cells, [](const Eigen::Vector3i& cell) { return cell; }, 1);
  const auto centre_distance = [&](const Eigen::Vector3i& cell, uint32_t i) {
    const Vector3d centre = (cell.cast<double>().array() + 0.5) * surfels.cell;
    return (centre - surfels.position[i].cast<double>()).squaredNorm();
  };
  for (uint32_t i = 0; i < surfels.size(); ++i) {
    for_neighbours(surfels.cells[i], [&](const Eigen::Vector3i& cell) {
      if (!net.covers(cell)) return;
      uint32_t& nearest = net.at(cell);
      if (nearest == CellGrid::kNone || centre_distance(cell, i) < centre_distance(cell, nearest))
        nearest = i;
    });
  }
  return net;
}

}  // namespace loci::mapping::registration
