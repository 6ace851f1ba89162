#pragma once

#include "mapping/sensor/camera.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::perception::types {

template <>
struct Conversion<mapping::PinholeCamera> {
  using Proxy = CameraInfo;
  static CameraInfo to(cas::Cas& cas, const mapping::PinholeCamera& camera);
  static mapping::PinholeCamera from(const CameraInfo& proxy);
};

/// Both cameras of a sensor become the scene's cameras "depth" and "color".
void set_cameras(const SceneCas& cas, const mapping::RgbdCamera& camera);

/// Throws Error when the scene has no such cameras.
mapping::RgbdCamera cameras(const SceneCas& cas);

}  // namespace loci::perception::types
