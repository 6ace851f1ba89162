#pragma once

#include "mapping/sensor/frame.h"
#include "perception/detection/lift.h"
#include "perception/detection/people_detector.h"

namespace loci::perception {

/// A frame in which people are looked for, without a map.
inline PeopleFrame people_frame(const mapping::RgbdFrame& frame) {
  return {frame.color, points_of(frame.depth, frame.camera.depth), {}, frame.camera, frame.map_from_camera};
}

}  // namespace loci::perception
