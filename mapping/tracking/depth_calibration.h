#pragma once

#include <vector>

#include "mapping/recording/recording.h"
#include "mapping/tracking/alignment.h"

namespace loci::mapping::tracking {

/// A frame and where a first pass of tracking saw it.
struct CalibrationView {
  size_t number = 0;  ///< in the recording
  Isometry3d map_from_camera = Isometry3d::Identity();
};

/// The fixed error of a depth camera, found from the recording itself: what remains between views of the same
/// surfaces from different poses, as a function of the pixel.
struct DepthCalibration {
  cv::Mat offsets;         ///< CV_32F, 1/m, at the finest level of FrameImages: measured minus true inverse
                           ///< depth; empty = none
  double improvement = 0;  ///< part by which squared residuals fall on pairs that were held out
  double rms = 0;          ///< of the offsets, 1/m
};

/// Calibrates over pairs of views that are some degrees or centimetres apart: neighbours in a long walk, all
/// pairs in a short one. No offsets where pairs are too
/// few, or where pairs that were held out do not fit clearly better with them. Same result on any number of
/// threads.
DepthCalibration calibrate_depth(const Recording& recording, const std::vector<CalibrationView>& views,
                                 int threads);

}  // namespace loci::mapping::tracking
