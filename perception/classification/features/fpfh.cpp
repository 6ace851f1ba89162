#include <pcl/features/fpfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::feature_delegates {

std::vector<float> fpfh(const SurfacePoints& surface) {
  constexpr double kRadius = 0.025;
  const PclClouds clouds(surface);
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimator;
  prepare(estimator, clouds);
  estimator.setIndices(some_of(clouds, kSpread));
  estimator.setRadiusSearch(kRadius);
  return mean_histogram<pcl::FPFHSignature33>(estimator);
}

}  // namespace loci::feature_delegates
