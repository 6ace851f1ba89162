#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mapping/base/pose.h"
#include "mapping/base/time.h"
#include "mapping/sensor/camera.h"

namespace loci::memory {

/// One thing that another system detected. What it does not say is unset.
struct Detection {
  Vector3d position = Vector3d::Zero();                 ///< centre, map frame
  std::optional<double> position_sigma;                 ///< metres per axis
  std::optional<Vector3d> size;                         ///< along the axes of the map, metres
  std::vector<std::pair<std::string, double>> classes;  ///< with probabilities, most probable first
  std::optional<Vector3d> color;                        ///< hue 0 to 360, saturation and value 0 to 1
  std::vector<std::string> texts;
  std::vector<std::pair<std::string, std::vector<float>>> features;
  std::optional<double> score;  ///< uncalibrated, 0 to 1
  std::string place;            ///< empty = not said
};

/// One line of a file of detections: one moment.
struct DetectedScene {
  struct Camera {
    std::optional<Isometry3d> map_from_camera;
    std::optional<mapping::PinholeCamera> lens;
    std::optional<double> near_m, far_m;
  };
  TimeNs time = 0;
  std::optional<Camera> camera;
  std::optional<std::vector<std::pair<std::string, double>>> observed;  ///< places and seen fractions
  std::vector<Detection> detections;
  std::vector<std::string> unknown_keys;  ///< that are not part of the format: "detections.colour"
};

/// Reads one line (docs/file-formats.md). Error says what is wrong with it, with the key as its place; the
/// file and the line are the caller's to add.
DetectedScene parse_detections(std::string_view line);

}  // namespace loci::memory
