#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/math/random.h"
#include "mapping/sensor/scan.h"

namespace loci::apps::registration_evaluation {

/// Two scans of which the relative pose is known.
struct TruePair {
  std::string name;
  const mapping::Scan* target = nullptr;
  const mapping::Scan* source = nullptr;
  Isometry3d target_from_source = Isometry3d::Identity();  ///< truth; of no use for different places
  bool same_place = true;
  double overlap = 0;  ///< at the truth: part of the smaller scan's 10 cm cells that the other one has
};

/// Scans and the pairs among them, all of one kind.
struct PairSet {
  std::string name;
  bool planar = true;                        ///< a levelled robot: x, y, yaw
  double trusted_m = 0.05, trusted_deg = 1;  ///< an error beyond is one
  std::vector<mapping::Scan> scans;
  std::vector<TruePair> pairs;
};

struct SimulatedWorld {
  std::filesystem::path urdf;
  std::vector<std::filesystem::path> package_paths;
};

/// Scans of a simulated laser from random free places, without error of their poses.
std::vector<mapping::Scan> simulated_scans(const SimulatedWorld& world, size_t count, const Random& random,
                                           int threads, Warnings& warnings);

/// All pairs of the scans of one world with at least this overlap, the first `count` in a random order.
PairSet pairs_among(std::string name, std::vector<mapping::Scan> scans, double min_overlap, size_t count,
                    const Random& random);

/// Frames of a recording with poses and the frame `ahead` positions later, `count` of them spread evenly.
PairSet recording_pairs(const std::filesystem::path& folder, size_t count, size_t ahead);

/// Pairs of clouds (PCD) from a CSV file: target, source (files in the folder `clouds`), and the pose of the
/// source in the target's frame: x_m, y_m, z_m and a rotation vector rx_deg, ry_deg, rz_deg. Error with file
/// and line when one cannot be read.
PairSet listed_pairs(const std::filesystem::path& file, const std::filesystem::path& clouds);

double true_overlap(const mapping::Scan& target, const mapping::Scan& source,
                    const Isometry3d& target_from_source);

/// A start that is off by a shift and a turn of at most this size, uniformly drawn; planar: about z.
Isometry3d perturbed(const Isometry3d& pose, double shift, double turn_deg, bool planar, Random& random);

/// Returned points only, one per cell: the mean of those in it. What all methods get.
mapping::Scan thinned(const mapping::Scan& scan, double voxel);

}  // namespace loci::apps::registration_evaluation
