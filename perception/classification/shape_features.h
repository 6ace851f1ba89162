#pragma once

#include <string>
#include <vector>

#include "mapping/base/math/pose.h"

namespace loci::perception {

/// What is seen of an object's surface: points (metres, camera frame) and as many unit normals towards the
/// camera.
struct SurfacePoints {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector3f> colors{};  ///< blue, green, red, 0 to 255, as many; empty = not known
};

/// What an object stands on, in the frame of the points: up·x = ground on it.
struct Ground {
  Vector3d up = Vector3d::UnitZ();
  double height = 0;
};

/// One point per cell of 5 mm: the mean of those in it that have a normal, in order of the cells. All of them
/// have as many points and normals.
SurfacePoints thinned_surface(const SurfacePoints& surface);

/// Names of the descriptors: "VFH", "ESF", "PFH", ...
std::vector<std::string> shape_feature_names();

/// What PCL calls a descriptor of that name: "VFHSignature308". Error that names those that there are.
std::string shape_feature_signature(const std::string& name);

/// One vector that describes the whole surface, computed with PCL (but for GaussImage) after the points were
/// thinned to one for each cell of 5 mm (points without a normal are left out). Descriptors of single points
/// (FPFH, SHOT, ColorSHOT, USC, 3DSC, RIFT, RSD, spin images, moments, curvatures) are averaged over points
/// spread over the surface, those of parts (CVFH, OUR-CVFH) over the parts; PFH and PFHRGB are taken of all
/// pairs of points. The same bytes for the same points. Empty when there are no colours for RIFT, PFHRGB and
/// ColorSHOT, and when there are too few points.
std::vector<float> shape_feature(const std::string& name, const SurfacePoints& surface);

}  // namespace loci::perception
