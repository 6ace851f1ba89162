#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"

namespace loci::mapping {

/// One return (or missing return) of a scan, in the sensor frame.
struct ScanPoint {
  Eigen::Vector3f position;     ///< metres; a ray without return stands at range_max
  float intensity = 0;          ///< reflectance · cos(incidence) for lasers, 0 where unknown
  uint8_t r = 0, g = 0, b = 0;  ///< colour
  uint16_t origin_index = 0;    ///< which of the scan's origins the ray started from
  bool returned = true;         ///< false: nothing was hit up to range_max (free space is information)
};

/// Points that were taken together: one sweep of a laser, or one or several fused depth frames.
struct Scan {
  std::string name;  ///< file name without extension, e.g. "scan_000"
  Isometry3d map_from_scan = Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of the pose: x y z roll pitch yaw
  bool registered = true;                   ///< otherwise odometry alone knows the pose: it spoils a map
  std::vector<Eigen::Vector3f> origins;     ///< where rays started, in the scan's frame; at least one
  std::vector<ScanPoint> points;
};

/// Sensors that are treated by name: the images of a depth camera were turned upright, which says where up is
/// in scans that are not levelled; a laser says nothing about it.
inline constexpr const char* kDepthCameraSensor = "kinect";
inline constexpr const char* kLaserSensor = "hokuyo";

/// Scans of one place, in one map frame.
struct ScanSet {
  std::string sensor;      ///< kDepthCameraSensor, kLaserSensor, or what made it
  bool levelled = true;    ///< z of the map frame is known to be up and the floor at 0
  double range_max = 0;    ///< metres
  double resolution = 0;   ///< voxel size that points were thinned to, metres; 0 = not thinned
  bool free_space = true;  ///< whether rays (origins) are known; a bare cloud has none
  std::vector<Scan> scans;
};

/// Writes `scans.yaml` and one binary PCD per scan into a folder (docs/file-formats.md).
void write_scan_set(const ScanSet& set, const std::filesystem::path& folder);

/// Like write_scan_set for a set that has grown by its last scan since it was written: points that are there
/// already are not written again, poses of all scans are.
void append_to_scan_set(const ScanSet& set, const std::filesystem::path& folder);

/// Reads what write_scan_set wrote, or a single bare PCD (then free_space is false and the origin is
/// unknown).
ScanSet read_scan_set(const std::filesystem::path& path);

/// Like read_scan_set, without the scans that could not be registered (a warning says how many).
ScanSet read_registered_scans(const std::filesystem::path& path, Warnings& warnings);

}  // namespace loci::mapping
