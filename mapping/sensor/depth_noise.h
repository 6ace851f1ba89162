#pragma once

namespace loci::mapping {

/// Standard deviation to reckon with for a depth of `z` metres: half a quantum of a Kinect's disparity.
inline double depth_noise(double z) {
  return 0.5 * 0.125 / (585 * 0.075) * z * z;
}

}  // namespace loci::mapping
