#pragma once

#include "perception/classification/local_features.h"

namespace loci::perception::feature_delegates {

// PCL is slow to compile, so that only these functions include it. Points are thinned and have normals.
std::vector<float> vfh(const SurfacePoints& surface);
std::vector<float> cvfh(const SurfacePoints& surface);
std::vector<float> our_cvfh(const SurfacePoints& surface);
std::vector<float> esf(const SurfacePoints& surface);
std::vector<float> grsd(const SurfacePoints& surface);
std::vector<float> rsd(const SurfacePoints& surface);  ///< smallest and largest radius, metres; planes 0.2
std::vector<float> crh(const SurfacePoints& surface);
std::vector<float> pfh(const SurfacePoints& surface);
std::vector<float> pfh_rgb(const SurfacePoints& surface);  ///< empty without colours
std::vector<float> fpfh(const SurfacePoints& surface);
std::vector<float> shot(const SurfacePoints& surface);
std::vector<float> color_shot(const SurfacePoints& surface);  ///< empty without colours
std::vector<float> usc(const SurfacePoints& surface);
std::vector<float> shape_context(const SurfacePoints& surface);
std::vector<float> gasd(const SurfacePoints& surface);
std::vector<float> rift(const SurfacePoints& surface);  ///< empty without colours
std::vector<float> spin_image(const SurfacePoints& surface);
std::vector<float> moments(const SurfacePoints& surface);
std::vector<float> curvatures(const SurfacePoints& surface);  ///< largest and smallest
/// Not of PCL: size along the principal axes and how the normals are spread over the sphere (Horn 1984). 12
/// values.
std::vector<float> gauss_image(const SurfacePoints& surface);

/// Key points, as numbers of points (local_features() says which).
std::vector<int> keypoints(const SurfacePoints& surface);
LocalFeatures shot_at(const SurfacePoints& surface, const std::vector<int>& at);
LocalFeatures fpfh_at(const SurfacePoints& surface, const std::vector<int>& at);

}  // namespace loci::perception::feature_delegates
