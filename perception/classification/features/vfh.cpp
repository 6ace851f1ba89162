#include <pcl/features/vfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::feature_delegates {

std::vector<float> vfh(const SurfacePoints& surface) {
  pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  pcl::PointCloud<pcl::VFHSignature308> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.histogram; });
}

}  // namespace loci::feature_delegates
