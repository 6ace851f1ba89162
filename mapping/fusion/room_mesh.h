#pragma once

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"
#include "mapping/sensor/colored_mesh.h"

namespace loci::mapping {

struct MeshOptions {
  int every = 1;
  double mesh_voxel_m = 0.01;
  double mesh_memory_mb = 1024;
  double range_max_m = 4.0;
  bool edge_filter = true;
  int threads = 0;  ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(OptionTable& table);  ///< what fusion does not declare
};

struct RoomMesh {
  ColoredMesh mesh;    ///< in the map frame
  double voxel_m = 0;  ///< larger than asked for where the memory did not suffice
  size_t frames = 0;   ///< integrated
  double seconds = 0;
};

/// The surfaces that posed frames show, as one coloured mesh: a truncated signed distance function in blocks
/// of voxels around the measured points (Curless and Levoy 1996; Nießner et al. 2013), whose zero is meshed
/// by surface nets (Gibson 1998). Differences of exposure and white balance between frames are estimated
/// against what was integrated before. Frames without pose or depth are skipped. Same result on any number of
/// threads.
RoomMesh mesh_room(const Recording& recording, const MeshOptions& options, Progress& progress);

}  // namespace loci::mapping
