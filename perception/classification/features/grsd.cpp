#include <pcl/features/grsd.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> grsd(const SurfacePoints& surface) {
  constexpr double kRadius = 0.02;
  pcl::GRSDEstimation<pcl::PointXYZ, pcl::Normal, pcl::GRSDSignature21> estimator;
  prepare(estimator, PclClouds(surface));
  estimator.setRadiusSearch(kRadius);
  return mean_histogram<pcl::GRSDSignature21>(estimator);
}

}  // namespace loci::perception::feature_delegates
