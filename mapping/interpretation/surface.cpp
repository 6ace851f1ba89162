#include "mapping/interpretation/surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/cell_index.h"
#include "mapping/base/parallel.h"

namespace loci::mapping {
namespace {

constexpr std::array<double, 3> kCellSizes = {0.02, 0.04, 0.08};
constexpr double kMinNeighbours = 12;

/// Sums of points of a cell, from which sums of neighbourhoods follow.
struct Moments {
  double count = 0;
  Vector3d sum = Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  void add(const Vector3d& point) {
    ++count;
    sum += point;
    squares += point * point.transpose();
  }
  void add(const Moments& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
  }
};

/// Moments of the cells of one scan at one cell size; normals of a cell are shared by its points.
class MomentGrid {
 public:
  MomentGrid(const Scan& scan, double cell_size) : cell_size_(cell_size), index_(scan.points.size() / 4) {
    for (const ScanPoint& point : scan.points) {
      if (!point.returned) continue;
      const uint32_t number = index_.insert(cell_of(point.position, cell_size_));
      if (number == moments_.size()) moments_.emplace_back();
      moments_[number].add(point.position.cast<double>());
    }
    normals_.resize(moments_.size());
  }

  /// The unoriented normal around a point from 3×3×3 cells; zero when there are too few points or they form
  /// no surface.
  Eigen::Vector3f normal(const Eigen::Vector3f& point) {
    const Eigen::Vector3i cell = cell_of(point, cell_size_);
    Cached& cached = normals_[index_.find(cell)];
    if (!cached.known) cached = {estimate(cell), true};
    return cached.normal;
  }

 private:
  struct Cached {
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    bool known = false;
  };

  Eigen::Vector3f estimate(const Eigen::Vector3i& cell) const {
    Moments all;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const uint32_t number = index_.find(cell + Eigen::Vector3i(x, y, z));
          if (number != CellIndex::kNone) all.add(moments_[number]);
        }
    if (all.count < kMinNeighbours) return Eigen::Vector3f::Zero();
    const Vector3d mean = all.sum / all.count;
    const Eigen::Matrix3d covariance = all.squares / all.count - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const Vector3d values = solver.eigenvalues();
    if (values[0] > 0.25 * values[1] || values[1] < 0.05 * values[2]) return Eigen::Vector3f::Zero();
    return solver.eigenvectors().col(0).cast<float>();
  }

  double cell_size_;
  CellIndex index_;
  std::vector<Moments> moments_;
  std::vector<Cached> normals_;
};

/// The finest grid whose neighbourhood is wide against the noise of a depth camera at this range.
size_t level_at(float range) {
  return range < 1.8F ? 0 : range < 3.0F ? 1 : 2;
}

struct Part {
  std::vector<SurfacePoint> points;
  std::vector<std::pair<Eigen::Vector3f, uint32_t>> free_ends;
};

Part gather_scan(const Scan& scan, uint16_t number, uint32_t first_origin, bool free_space) {
  Part part;
  part.points.reserve(scan.points.size());
  std::vector<MomentGrid> grids;
  for (const double size : kCellSizes) grids.emplace_back(scan, size);
  const Eigen::Isometry3f map_from_scan = scan.map_from_scan.cast<float>();
  for (const ScanPoint& point : scan.points) {
    const uint32_t origin = first_origin + point.origin_index;
    if (!point.returned) {
      part.free_ends.emplace_back(map_from_scan * point.position, origin);
      continue;
    }
    const Eigen::Vector3f to_origin = free_space
                                          ? Eigen::Vector3f(scan.origins[point.origin_index] - point.position)
                                          : Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    for (size_t level = free_space ? level_at(to_origin.norm()) : 0; level < grids.size() && normal.isZero();
         ++level)
      normal = grids[level].normal(point.position);
    if (normal.dot(to_origin) < 0) normal = -normal;
    part.points.push_back({map_from_scan * point.position, map_from_scan.linear() * normal, number, origin,
                           point.intensity, point.r, point.g, point.b});
  }
  return part;
}

/// Without origins: horizontal surfaces look up, vertical ones towards the middle of the points.
void orient_without_origins(Surface& surface) {
  Eigen::Vector3d sum = Vector3d::Zero();
  for (const SurfacePoint& point : surface.points) sum += point.position.cast<double>();
  const Eigen::Vector3f middle = (sum / static_cast<double>(surface.points.size())).cast<float>();
  for (SurfacePoint& point : surface.points) {
    const bool flat = std::abs(point.normal.z()) > 0.7F;
    const float side = flat ? point.normal.z() : point.normal.dot(middle - point.position);
    if (side < 0) point.normal = -point.normal;
  }
}

}  // namespace

Surface gather_surface(const ScanSet& scans, int threads, Progress& progress) {
  Surface surface;
  surface.free_space =
      scans.free_space && std::none_of(scans.scans.begin(), scans.scans.end(),
                                       [](const Scan& scan) { return scan.origins.empty(); });
  surface.scans = scans.scans.size();
  std::vector<uint32_t> first_origin;
  for (const Scan& scan : scans.scans) {
    first_origin.push_back(static_cast<uint32_t>(surface.origins.size()));
    for (const Eigen::Vector3f& origin : scan.origins)
      surface.origins.push_back((scan.map_from_scan * origin.cast<double>()).cast<float>());
    surface.scan_of_origin.resize(surface.origins.size(), static_cast<uint16_t>(first_origin.size() - 1));
  }
  progress.check(0, "surface normals");
  std::vector<Part> parts(scans.scans.size());
  parallel_for(parts.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      parts[i] = gather_scan(scans.scans[i], static_cast<uint16_t>(i), first_origin[i], surface.free_space);
  });
  size_t points = 0;
  size_t free_ends = 0;
  for (const Part& part : parts) {
    points += part.points.size();
    free_ends += part.free_ends.size();
  }
  surface.points.reserve(points);
  surface.free_ends.reserve(free_ends);
  for (Part& part : parts) {
    surface.points.insert(surface.points.end(), part.points.begin(), part.points.end());
    surface.free_ends.insert(surface.free_ends.end(), part.free_ends.begin(), part.free_ends.end());
    part = {};
  }
  if (!surface.free_space && !surface.points.empty()) orient_without_origins(surface);
  return surface;
}

void transform(Surface& surface, const Isometry3d& target_from_source) {
  const Eigen::Isometry3f motion = target_from_source.cast<float>();
  for (SurfacePoint& point : surface.points) {
    point.position = motion * point.position;
    point.normal = motion.linear() * point.normal;
  }
  for (Eigen::Vector3f& origin : surface.origins) origin = motion * origin;
  for (auto& [end, origin] : surface.free_ends) end = motion * end;
  if (!surface.free_space && !surface.points.empty()) orient_without_origins(surface);
}

}  // namespace loci::mapping
