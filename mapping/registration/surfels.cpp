#include "mapping/registration/surfels.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/registration/parameters.h"

namespace loci::mapping::registration {
namespace {

Eigen::Vector3i blocks_of(const Eigen::Vector3i& cell) {
  return {cell.x() >> 2, cell.y() >> 2, cell.z() >> 2};
}

}  // namespace

CellGrid::CellGrid(const Eigen::Vector3i& low, const Eigen::Vector3i& high, const Eigen::Vector3i& centre) {
  low_ = blocks_of(low);
  Eigen::Vector3i last = blocks_of(high);
  const auto volume = [&] { return (last - low_).cast<int64_t>().array().max(0) + 1; };
  for (int reach = 1 << 18; volume().cast<double>().prod() > static_cast<double>(kSurfels.max_blocks);
       reach /= 2) {
    low_ = low_.cwiseMax((blocks_of(centre).array() - reach).matrix());
    last = last.cwiseMin((blocks_of(centre).array() + reach).matrix());
  }
  size_ = (last - low_).array().max(-1) + 1;
  directory_.assign(static_cast<size_t>(size_.cast<int64_t>().prod()), 0);
  blocks_.emplace_back().fill(kNone);
}

namespace {

double rising(double value, double low, double high) {
  return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

/// Lower corner of the 2x2x2 cells whose union holds everything within half a cell of the point.
Eigen::Vector3i corner_of(const Eigen::Vector3f& point, float per_metre) {
  const Eigen::Array3f cells = point.array() * per_metre - 0.5F;
  const Eigen::Array3i towards_zero = cells.cast<int>();
  return towards_zero - (towards_zero.cast<float>() > cells).cast<int>();
}

/// The two smaller eigenvalues of a covariance, and the eigenvector of the smallest.
struct Thinnest {
  double thickness = 0, width = 0;
  Vector3d direction = Vector3d::UnitZ();
};

/// Newton's method from 0 on the characteristic polynomial, which has no root below the smallest: planes need
/// few steps. Where the two smaller ones are nearly equal it stops before: planes are thinner.
Thinnest thinnest(const Eigen::Matrix3d& covariance) {
  const auto minor = [&](Eigen::Index i, Eigen::Index j) {
    return covariance(i, i) * covariance(j, j) - covariance(i, j) * covariance(i, j);
  };
  const double trace = covariance.trace(), minors = minor(0, 1) + minor(0, 2) + minor(1, 2);
  const double determinant = covariance.determinant();
  double smallest = 0;
  for (int k = 0; k < 12; ++k) {
    const double value = ((smallest - trace) * smallest + minors) * smallest - determinant;
    const double slope = (3 * smallest - 2 * trace) * smallest + minors;
    const double step = slope > 0 ? -value / slope : 0;
    if (!(step > 1e-9 * trace)) break;
    smallest += step;
  }
  Thinnest result{.thickness = smallest};
  const double rest = trace - smallest, product = minors - smallest * rest;
  result.width = rest / 2 - std::sqrt(std::max(0.0, rest * rest / 4 - product));
  const Eigen::Matrix3d shifted = covariance - smallest * Eigen::Matrix3d::Identity();
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const Vector3d across = shifted.col(k).cross(shifted.col((k + 1) % 3));
    if (across.squaredNorm() <= longest) continue;
    longest = across.squaredNorm();
    result.direction = across / std::sqrt(longest);
  }
  return result;
}

void fit_plane(Surfels& surfels, size_t i, const Moments<3>& moments, const PlaneFit& fit) {
  const Vector3d own = surfels.moments[i].mean();
  surfels.position[i] = own.cast<float>();
  if (moments.count < kSurfels.min_plane_points) return;
  const Vector3d mean = moments.mean();
  const auto [thickness, width, direction] = thinnest(moments.covariance());
  const double smallest_extent = 0.15 * surfels.cell;  // Less is a line or a spot.
  if (width < smallest_extent * smallest_extent) return;
  Vector3d normal = direction;
  const Vector3d ray = surfels.origin[i].cast<double>() - own;
  const Vector3d view = ray.normalized();
  double weight = 1 - rising(thickness / width, 0.05, kSurfels.max_thickness_ratio);
  if (fit.oriented) {
    const double cosine = std::abs(normal.dot(view));
    const double depth =
        kSurfels.beam_rad * ray.norm() * std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
    weight *= rising(cosine, kSurfels.grazing_cosine, kSurfels.steep_cosine) *
              (1 - rising(depth, kSurfels.shallow_spot_m, kSurfels.deep_spot_m));
  }
  if (thickness > kSurfels.max_thickness_ratio * width) return;
  if (normal.dot(view) < 0) normal = -normal;
  surfels.normal[i] = normal.cast<float>();
  surfels.weight[i] = static_cast<float>(weight);
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
  for (const uint32_t i : grid.find_eight(corner_of(point, 1 / static_cast<float>(cell)))) {
    if (i == CellGrid::kNone) continue;
    const float squared = (position[i] - point).squaredNorm();
    if (squared >= best) continue;
    if (has_side && normal[i].squaredNorm() > 0.5F && normal[i].dot(facing) < kSurfels.same_side_cosine)
      continue;
    best = squared;
    found = i;
  }
  return found;
}

bool Surfels::near(const Eigen::Vector3f& point) const {
  const auto around = grid.find_eight(corner_of(point, 1 / static_cast<float>(cell)));
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

namespace {

/// The moments of each cell with those of its 26 neighbours: each pair is looked up once.
std::vector<Moments<3>> moments_around(const Surfels& surfels) {
  std::vector<Moments<3>> around = surfels.moments;
  const auto add_pair = [&](uint32_t i, const Eigen::Vector3i& step) {
    const uint32_t j = surfels.grid.find(surfels.cells[i] + step);
    if (j == CellGrid::kNone) return;
    around[i].add(surfels.moments[j]);
    around[j].add(surfels.moments[i]);
  };
  for (uint32_t i = 0; i < surfels.cells.size(); ++i) {
    add_pair(i, {0, 0, 1});
    for (int z = -1; z <= 1; ++z) {
      add_pair(i, {0, 1, z});
      for (int y = -1; y <= 1; ++y) add_pair(i, {1, y, z});
    }
  }
  return around;
}

}  // namespace

void fit_planes(Surfels& surfels, bool finest, const PlaneFit& fit) {
  const size_t count = surfels.moments.size();
  surfels.position.assign(count, Eigen::Vector3f::Zero());
  surfels.normal.assign(count, Eigen::Vector3f::Zero());
  surfels.weight.assign(count, 0.F);
  const std::vector<Moments<3>> around = moments_around(surfels);
  for (size_t i = 0; i < count; ++i) {
    const bool alone = !finest && surfels.moments[i].count >= kSurfels.min_own_points;
    fit_plane(surfels, i, alone ? surfels.moments[i] : around[i], fit);
  }
}

CellGrid dilated_grid(const Surfels& surfels) {
  CellGrid dilated = grid_over(
      surfels.cells, [](const Eigen::Vector3i& cell) { return cell; }, 1);
  const auto centre_distance = [&](const Eigen::Vector3i& cell, uint32_t i) {
    const Vector3d centre = (cell.cast<double>().array() + 0.5) * surfels.cell;
    return (centre - surfels.position[i].cast<double>()).squaredNorm();
  };
  for (uint32_t i = 0; i < surfels.size(); ++i) {
    for_neighbours(surfels.cells[i], [&](const Eigen::Vector3i& cell) {
      if (!dilated.covers(cell)) return;
      uint32_t& nearest = dilated.at(cell);
      if (nearest == CellGrid::kNone || centre_distance(cell, i) < centre_distance(cell, nearest))
        nearest = i;
    });
  }
  return dilated;
}

}  // namespace loci::mapping::registration
