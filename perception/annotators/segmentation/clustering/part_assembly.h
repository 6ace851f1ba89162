#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/sensor/camera.h"
#include "perception/annotators/segmentation/clustering/convex_parts.h"

namespace loci::perception {

/// What assembling parts to objects goes by.
struct AssemblyOptions {
  double splinter_m2 = 0.0004;
  double within = 0.8;
  double slack_m = 0.012;
  double appendage = 0.25;
  double hovering_m = 0.025;
  double hidden_gap_m = 0.15;
  double neck_m = 0.05;

  void declare(OptionTable& table);
};

/// A cloud over one support. Frame: the support's plane, z = height; metres.
struct PlaneCloud {
  const std::vector<Eigen::Vector3f>& points;
  const std::vector<Eigen::Vector3f>& normals;
  const std::vector<float>& areas;    ///< what each point stands for, m²
  const std::vector<cv::Vec3b>& lab;  ///< colours, CIE Lab in 8 bits; empty = unknown
  Eigen::Vector2f viewpoint;          ///< where the camera is
  const Isometry3d& camera_from_plane;
  const mapping::PinholeCamera& camera;
  const cv::Mat& image_points;  ///< CV_32FC3, the whole image in the camera frame: what is free, what hidden
};

/// Puts convex parts together to objects:
/// splinters go to the neighbour that they touch most; what lies within another part's footprint and below
/// its top (the inside of a bowl, the back of a rim) belongs to it; a small part that hovers or sticks to a
/// large one without standing on top of it (a handle) belongs to it; a narrow part in the middle above what
/// tapers towards it (a neck, a cap) belongs to it; a far wall that ends at the same rim as a near one and
/// faces inwards is the inside of the same vessel; and two parts of one height, between which there is
/// nothing but what is hidden by something nearer, are one object. Only the front of an object is seen: its
/// footprint is completed by reflection. Gives an object number per part in [0, count).
std::vector<int> assemble_parts(const ConvexParts& parts, const PlaneCloud& cloud,
                                const AssemblyOptions& options, int& count);

}  // namespace loci::perception
