#include "apps/evaluate/tracking/frame_odometry.h"
#include "mapping/base/load_symbol.h"

namespace loci::apps::tracking_evaluation {

std::unique_ptr<FrameOdometry> open3d_odometry([[maybe_unused]] const mapping::PinholeCamera& camera) {
#ifdef LOCI_OPEN3D
  using Create = FrameOdometry* (*)(const mapping::PinholeCamera&);
  static const auto create = reinterpret_cast<Create>(load_symbol(
      "loci_open3d.so", "loci_open3d_odometry", "Open3D cannot be compared", "install libopen3d"));
  return std::unique_ptr<FrameOdometry>(create(camera));
#else
  return nullptr;
#endif
}

}  // namespace loci::apps::tracking_evaluation
