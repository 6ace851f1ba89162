#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "mapping/base/math/pose.h"
#include "mapping/base/math/tally.h"
#include "mapping/sensor/camera.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Why a frame shows no support. `depth`: CV_32F, metres; `points` and `normals`: CV_32FC3, camera frame;
/// `up`: unit, camera frame, where the pose was measured.
Reason no_support_because(const cv::Mat& depth, const cv::Mat& points, const cv::Mat& normals,
                          const mapping::PinholeCamera& camera, const std::optional<Vector3d>& up);

/// Why a processed scene shows no object; unset when it shows one. With `remembers` an object is what the
/// belief has confirmed.
std::optional<Reason> no_object_because(const types::SceneCas& scene, bool remembers);

}  // namespace loci::perception
