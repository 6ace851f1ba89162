#include <pcl/features/cvfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::feature_delegates {

std::vector<float> cvfh(const SurfacePoints& surface) {
  pcl::CVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  pcl::PointCloud<pcl::VFHSignature308> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.histogram; });
}

}  // namespace loci::feature_delegates
