#include "mapping/fusion/room_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/fusion/signed_distances.h"

namespace loci::mapping {
namespace {

/// The frames that can be integrated, as the depth camera sees them; empty depth where one cannot.
RgbdFrame prepared(const Recording& recording, size_t number, bool edge_filter) {
  RgbdFrame frame = recording.frame(number);
  if (!frame.map_from_camera || !has_depth(frame)) {
    frame.depth.release();
    return frame;
  }
  if (edge_filter) drop_flying_pixels(frame.depth);
  frame.color = color_in_depth(frame);
  return frame;
}

}  // namespace

void MeshOptions::declare(OptionTable& table) {
  table.number("mesh_voxel_m", mesh_voxel_m, "m", "Size of the voxels that the mesh is made of; 0 = no mesh.",
               0, 0.1);
  table.number("mesh_memory_mb", mesh_memory_mb, "MB",
               "Memory of the voxels; where it does not suffice they become larger.", 16, 100000);
}

RoomMesh mesh_room(const Recording& recording, const FusionOptions& fusion, const MeshOptions& options,
                   Progress& progress) {
  const Stopwatch watch;
  FusionOptions checked_fusion = fusion;
  table_of(checked_fusion).validate({"", 0, "fuse"});
  MeshOptions checked = options;
  table_of(checked).validate({"", 0, "mesh"});
  RoomMesh result;
  SignedDistances distances(options.mesh_voxel_m, fusion.range_max_m, options.mesh_memory_mb * 1e6,
                            fusion.threads);
  const auto every = static_cast<size_t>(fusion.every);
  const size_t taken = (recording.size() + every - 1) / every;
  const auto batch = static_cast<size_t>(2 * thread_count(fusion.threads));
  for (size_t begin = 0; begin < taken; begin += batch) {
    progress.check(static_cast<double>(begin) / static_cast<double>(taken),
                   fmt::format("meshing frame {} of {}", begin, taken));
    std::vector<RgbdFrame> frames(std::min(batch, taken - begin));
    parallel_each(frames.size(), fusion.threads, [&](size_t i) {
      frames[i] = prepared(recording, (begin + i) * every, fusion.edge_filter);
    });
    for (const RgbdFrame& frame : frames) {
      if (frame.depth.empty()) continue;
      distances.integrate(frame);
    }
  }
  result.mesh = distances.mesh();
  result.voxel_m = distances.voxel_m();
  result.seconds = watch.seconds();
  return result;
}

}  // namespace loci::mapping
