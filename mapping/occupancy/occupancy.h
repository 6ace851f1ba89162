#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/sensor/scan.h"

namespace octomap {
class OcTree;
}

namespace loci::mapping {

struct OccupancyOptions {
  double resolution_m = 0.05;
  double range_max_m = 5;  ///< rays are cut there; what lies behind stays unknown
  int threads = 0;         ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(loci::OptionTable& table);
};

enum class Occupancy : uint8_t { unknown, free, occupied };

/// All known space as a dense array, x fastest: for algorithms that visit every voxel or cast many rays.
struct Voxels {
  double resolution = 0;                           ///< metres
  Vector3d low = Vector3d::Zero();                 ///< corner of the first voxel, map frame, metres
  Eigen::Vector3i size = Eigen::Vector3i::Zero();  ///< voxels; zero when nothing is known
  std::vector<Occupancy> states;
  /// Occupied voxels that are doubtful: likelier free than after a single hit, because rays passed through
  /// them too. So are the false points that a beam leaves which meets two surfaces. Ascending indices.
  std::vector<size_t> doubtful;

  bool contains(const Eigen::Vector3i& voxel) const {
    return (voxel.array() >= 0).all() && (voxel.array() < size.array()).all();
  }
  size_t index(const Eigen::Vector3i& voxel) const {
    return static_cast<size_t>(voxel.x()) +
           static_cast<size_t>(size.x()) * (static_cast<size_t>(voxel.y()) +
                                            static_cast<size_t>(size.y()) * static_cast<size_t>(voxel.z()));
  }
  /// Unknown outside.
  Occupancy at(const Eigen::Vector3i& voxel) const {
    return contains(voxel) ? states[index(voxel)] : Occupancy::unknown;
  }
  Eigen::Vector3i voxel_of(const Vector3d& point) const {
    return ((point - low) / resolution).array().floor().cast<int>();
  }
  Vector3d center(const Eigen::Vector3i& voxel) const {
    return low + resolution * (voxel.cast<double>().array() + 0.5).matrix();
  }
};

/// What is known of space: an OctoMap whose missing leaves are unknown, never free.
class OccupancyMap {
 public:
  explicit OccupancyMap(const OccupancyOptions& options);
  ~OccupancyMap();
  OccupancyMap(const OccupancyMap& other);
  OccupancyMap(OccupancyMap&&) noexcept;
  OccupancyMap& operator=(OccupancyMap&&) noexcept;

  /// Inserts all rays of a scan. The tree is afterwards, node for node, what OctoMap's own
  /// `insertPointCloud(points in the map frame, origin, range_max)` makes of it, several times as fast; a ray
  /// without return counts like one beyond the range: free up to there, occupied nowhere. The rays of all
  /// origins of a scan are one measurement: a voxel gets one hit or one miss. Points that are not finite or
  /// outside OctoMap's 65,536 voxels are left out. The same on any number of threads.
  /// Error when the scan spans too many voxels at this resolution (more than 2^30).
  void insert(const Scan& scan);

  Occupancy at(const Vector3d& point) const;
  double resolution() const;
  const octomap::OcTree& tree() const;
  Voxels voxels() const;
  /// OctoMap's maximum-likelihood file (.bt), atomically.
  void write_bt(const std::filesystem::path& path) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::mapping
