#pragma once

#include <memory>

#include "mapping/sensor/colored_mesh.h"
#include "mapping/sensor/frame.h"

namespace loci::apps::mesh_claim {

/// Another method that makes a mesh of posed frames.
class Mesher {
 public:
  virtual ~Mesher() = default;
  /// A frame with pose.
  virtual void add(const mapping::RgbdFrame& frame) = 0;
  virtual mapping::ColoredMesh mesh() = 0;
};

struct MesherOptions {
  double voxel_m = 0.01;
  double truncation_m = 0.04;
  double range_max_m = 4;
};

/// Open3D's ScalableTSDFVolume. Error when loci was built without Open3D or it is not installed.
std::unique_ptr<Mesher> open3d_mesher(const MesherOptions& options);

}  // namespace loci::apps::mesh_claim
