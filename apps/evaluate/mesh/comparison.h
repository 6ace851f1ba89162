#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::mesh_claim {

struct Settings {
  std::vector<std::filesystem::path> package_paths;
  std::filesystem::path folder;  ///< of simulated recordings; those that are there are used again
  double voxel_m = 0.01;
  int seed = 1;
  int places = 2;  ///< of a simulated walk, where the person turns round
  bool open3d = false;
  int threads = 0;
};

/// Distances of vertices from the true surface.
struct VertexErrors {
  double median_m = 0, q95_m = 0;
  double far = 0;  ///< part that is farther than 2 cm
};

/// One method over one recording.
struct Row {
  std::string recording, method;
  size_t frames = 0, vertices = 0, triangles = 0;
  std::optional<VertexErrors> vertex;  ///< where the true surface is known
  /// Rays of frames that were left out, to the true surface or, where it is not known, as they were measured.
  double depth_median_m = 0, depth_q95_m = 0;  ///< of |mesh − ray|, where they are within 5 cm
  double covered = 0;                          ///< part of the rays within 5 cm
  double before = 0;                           ///< part that meets something 5 cm or more before
  double cpu_ms = 0;                           ///< per frame, reading included
  double frames_per_second = 0;
  double memory_mb = 0;  ///< peak above that at the beginning
};

/// Meshes of every other frame of a recording with poses, or of a walk through a world (URDF) with a
/// simulated Kinect: ours and, if asked for, Open3D's. The frames between judge them.
std::vector<Row> compare_meshes(const std::filesystem::path& recording_or_world, const Settings& settings,
                                Progress& progress, Warnings& warnings);

std::string to_text(const std::vector<Row>& rows);
Json to_json(const std::vector<Row>& rows);

}  // namespace loci::apps::mesh_claim
