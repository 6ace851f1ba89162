#include "mapping/interpretation/surfaces/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/error.h"
#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/moments.h"
#include "mapping/base/parallel.h"
#include "mapping/interpretation/surfaces/parameters.h"

namespace loci::mapping {
namespace {

/// Moments of the cells of one scan at one cell size. The points of a cell share its normal.
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

  /// The unoriented normal around a point from 3×3×3 cells; zero for too few points or no surface.
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
    Moments<3> all;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const uint32_t number = index_.find(cell + Eigen::Vector3i(x, y, z));
          if (number != CellIndex::kNone) all.add(moments_[number]);
        }
    if (all.count < kNormals.min_neighbours) return Eigen::Vector3f::Zero();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(all.covariance());
    const Vector3d& values = solver.eigenvalues();
    if (values[0] > 0.25 * values[1] || values[1] < 0.05 * values[2]) return Eigen::Vector3f::Zero();
    return solver.eigenvectors().col(0).cast<float>();
  }

  double cell_size_;
  CellIndex index_;
  std::vector<Moments<3>> moments_;
  std::vector<Cached> normals_;
};

/// The finest grid whose neighbourhood is wide compared with a depth camera's noise at this range.
size_t level_at(float range) {
  return range < 1.8F ? 0 : range < 3.0F ? 1 : 2;
}

/// Where the points of a scan and its ends of rays without return begin in the surface.
struct Begin {
  size_t point = 0, free_end = 0;
  uint32_t origin = 0;
};

void gather_scan(const Scan& scan, uint16_t number, Begin next, Surface& surface) {
  std::vector<MomentGrid> grids;
  for (const double size : kNormals.cell_sizes_m) grids.emplace_back(scan, size);
  const Eigen::Isometry3f map_from_scan = scan.map_from_scan.cast<float>();
  for (const ScanPoint& point : scan.points) {
    const uint32_t origin = next.origin + point.origin_index;
    if (!point.returned) {
      surface.free_ends[next.free_end++] = {map_from_scan * point.position, origin};
      continue;
    }
    const Eigen::Vector3f to_origin = surface.free_space
                                          ? Eigen::Vector3f(scan.origins[point.origin_index] - point.position)
                                          : Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    for (size_t level = surface.free_space ? level_at(to_origin.norm()) : 0;
         level < grids.size() && normal.isZero(); ++level)
      normal = grids[level].normal(point.position);
    if (normal.dot(to_origin) < 0) normal = -normal;
    surface.points[next.point++] = {map_from_scan * point.position,
                                    map_from_scan.linear() * normal,
                                    number,
                                    origin,
                                    point.intensity,
                                    point.r,
                                    point.g,
                                    point.b};
  }
}

/// Without origins, normals of horizontal surfaces point up, others to the centroid of the points.
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
  std::vector<Begin> begins;
  Begin end;
  for (const Scan& scan : scans.scans) {
    begins.push_back(end);
    for (const Eigen::Vector3f& origin : scan.origins)
      surface.origins.push_back((scan.map_from_scan * origin.cast<double>()).cast<float>());
    surface.scan_of_origin.resize(surface.origins.size(), static_cast<uint16_t>(begins.size() - 1));
    end.origin = static_cast<uint32_t>(surface.origins.size());
    for (const ScanPoint& point : scan.points) ++(point.returned ? end.point : end.free_end);
  }
  progress.check(0, "surface normals");
  surface.points.resize(end.point);
  surface.free_ends.resize(end.free_end);
  parallel_for(begins.size(), threads, [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i)
      gather_scan(scans.scans[i], static_cast<uint16_t>(i), begins[i], surface);
  });
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

namespace {

struct Counts {
  size_t returns = 0;
  size_t tops = 0, undersides = 0;  ///< points of furniture

  bool upside_down() const {
    return undersides > kScanCheck.min_undersides && undersides > kScanCheck.underside_ratio * tops;
  }
};

bool is_of_furniture(const SurfacePoint& point) {
  return point.position.z() > kScanCheck.min_height_m && point.position.z() < kScanCheck.max_height_m;
}

std::vector<Counts> counts_of(const Surface& surface) {
  std::vector<Counts> counts(surface.scans);
  for (const SurfacePoint& point : surface.points) {
    Counts& scan = counts[point.scan];
    ++scan.returns;
    if (!is_of_furniture(point)) continue;
    scan.tops += point.normal.z() > kScanCheck.level_cosine;
    scan.undersides += point.normal.z() < -kScanCheck.level_cosine;
  }
  return counts;
}

/// Clears the marks of scans whose undersides others saw, too: a scanner that stands low sees those of wall
/// cupboards and no tops. What an upside-down scan shows is not where others saw something.
void acquit(const Surface& surface, std::vector<bool>& bad) {
  CellIndex seen;
  for (const SurfacePoint& point : surface.points)
    if (!bad[point.scan]) seen.insert(cell_of(point.position, kScanCheck.same_place_m));
  std::vector<std::array<size_t, 2>> undersides(bad.size(), {0, 0});  // not seen by others, seen
  for (const SurfacePoint& point : surface.points) {
    if (!bad[point.scan] || !is_of_furniture(point) || point.normal.z() > -kScanCheck.level_cosine) continue;
    const bool known = seen.find(cell_of(point.position, kScanCheck.same_place_m)) != CellIndex::kNone;
    ++undersides[point.scan][known ? 1 : 0];
  }
  for (size_t i = 0; i < bad.size(); ++i) bad[i] = bad[i] && undersides[i][1] < undersides[i][0];
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

void remove_bad_scans(const ScanSet& scans, Surface& surface, std::vector<std::string>& notes) {
  const std::vector<Counts> counts = counts_of(surface);
  std::vector<std::string> empty, upside_down;
  std::vector<bool> bad(counts.size(), false);
  for (size_t i = 0; i < counts.size(); ++i) bad[i] = counts[i].upside_down();
  if (std::find(bad.begin(), bad.end(), true) != bad.end()) acquit(surface, bad);
  for (size_t i = 0; i < counts.size(); ++i) {
    const std::string name = scans.scans[i].name.empty() ? fmt::format("scan {}", i) : scans.scans[i].name;
    if (counts[i].returns == 0) empty.push_back(name);
    if (bad[i]) upside_down.push_back(name);
  }
  if (!empty.empty()) notes.push_back("scans without returns, not used: " + listed(empty));
  if (upside_down.empty()) return;
  if (2 * upside_down.size() > counts.size() - empty.size())
    throw Error(fmt::format("the scans are upside down: furniture shows undersides, not tops ({})",
                            listed(upside_down)),
                {}, "turn the scans, or correct the poses in scans.yaml");
  notes.push_back("scans upside down (furniture shows undersides, not tops), not used: " +
                  listed(upside_down));
  std::erase_if(surface.points, [&](const SurfacePoint& point) { return bad[point.scan]; });
  std::erase_if(surface.free_ends, [&](const auto& ray) { return bad[surface.scan_of_origin[ray.second]]; });
}

}  // namespace loci::mapping
