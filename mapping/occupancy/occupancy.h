#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/pose.h"
#include "mapping/sensor/scan.h"

namespace octomap {
class OcTree;
}

namespace loci {

struct OccupancyOptions {
  double resolution_m = 0.05;
  double range_max_m = 5;  ///< rays are cut there; what lies behind stays unknown
  int threads = 0;

  void declare(OptionTable& table);
};

enum class Occupancy : uint8_t { unknown, free, occupied };

/// What is known of space: an OctoMap whose missing leaves are unknown, never free.
class OccupancyMap {
 public:
  explicit OccupancyMap(const OccupancyOptions& options);
  ~OccupancyMap();
  OccupancyMap(OccupancyMap&&) noexcept;
  OccupancyMap& operator=(OccupancyMap&&) noexcept;

  /// Inserts all rays of a scan, leaf for leaf what OctoMap's own insertPointCloud makes of them, faster.
  void insert(const Scan& scan);

  Occupancy at(const Vector3d& point) const;
  double resolution() const;
  const octomap::OcTree& tree() const;
  void write_bt(const std::filesystem::path& path) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci
