#include <pcl/features/pfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> pfh(const SurfacePoints& surface) {
  constexpr int kDivisions = 5;
  const PclClouds clouds(surface);
  pcl::PFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::PFHSignature125> estimator;
  Eigen::VectorXf histogram(kDivisions * kDivisions * kDivisions);
  estimator.computePointPFHSignature(*clouds.points, *clouds.normals, *some_of(clouds, kSpread), kDivisions,
                                     histogram);
  return {histogram.begin(), histogram.end()};
}

}  // namespace loci::perception::feature_delegates
