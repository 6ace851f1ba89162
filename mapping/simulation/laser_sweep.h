#pragma once

#include "mapping/base/math/random.h"
#include "mapping/render/ray_scene.h"
#include "mapping/sensor/laser.h"

namespace loci::mapping {

/// One noisy sweep from a true pose: points in the scanner frame, one per ray, line by line from the lowest
/// tilt; a ray without return stands at range_max, rays that meet something nearer than range_min are left
/// out. The scan's pose is map_from_scanner. Same seed, same bytes on any number of threads (0 = all cores).
///
/// A beam is five sub-rays: its middle and half its width to the left, right, up and down. A sub-ray comes
/// back unless it hits nothing, glossy material beyond the largest incidence, or what is too dark. Ranges of
/// those that come back are averaged, colour and intensity alike, where they lie together; where they spread
/// over more than mixed_spread_m that is a mixed return, which happens with mixed_probability; otherwise the
/// nearest counts. Reflectance is the luminance (Rec. 709) of the material's colour.
Scan simulate_sweep(const RayScene& scene, const Isometry3d& map_from_scanner, const LaserModel& laser,
                    const Random& random, int threads);

}  // namespace loci::mapping
