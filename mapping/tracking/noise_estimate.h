#pragma once

#include <optional>

#include "mapping/recording/recording.h"

namespace loci::mapping::tracking {

/// Standard deviation of depth as a part of its square, 1/m, estimated from some frames: on planes inverse
/// depth is a linear function of the pixel, so that its second differences are noise. Unset without enough
/// depth.
std::optional<double> depth_noise_per_z2(const Recording& recording);

}  // namespace loci::mapping::tracking
