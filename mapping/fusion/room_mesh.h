#pragma once

#include "mapping/fusion/fusion.h"
#include "mapping/sensor/colored_mesh.h"

namespace loci::mapping {

struct MeshOptions {
  double mesh_voxel_m = 0.01;
  double mesh_memory_mb = 1024;

  void declare(OptionTable& table);
};

struct RoomMesh {
  ColoredMesh mesh;    ///< in the map frame
  double voxel_m = 0;  ///< larger than asked for where the memory did not suffice
  double seconds = 0;
};

/// The surfaces that posed frames show, as one coloured mesh: a truncated signed distance function in blocks
/// of voxels around the measured points (Curless and Levoy 1996; Nießner et al. 2013), whose zero is meshed
/// by surface nets (Gibson 1998). Differences of exposure and white balance between frames are estimated
/// against what was integrated before. Frames, range, filter and threads are those of the fusion; frames
/// without pose or depth are skipped. Same result on any number of threads.
RoomMesh mesh_room(const Recording& recording, const FusionOptions& fusion, const MeshOptions& options,
                   Progress& progress);

}  // namespace loci::mapping
