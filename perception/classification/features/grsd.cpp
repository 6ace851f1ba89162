#include <pcl/features/grsd.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::feature_delegates {

std::vector<float> grsd(const SurfacePoints& surface) {
  constexpr double kRadius = 0.02;
  pcl::GRSDEstimation<pcl::PointXYZ, pcl::Normal, pcl::GRSDSignature21> estimator;
  prepare(estimator, PclClouds(surface));
  estimator.setRadiusSearch(kRadius);
  pcl::PointCloud<pcl::GRSDSignature21> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.histogram; });
}

}  // namespace loci::feature_delegates
