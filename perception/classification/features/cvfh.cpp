#include <pcl/features/cvfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> cvfh(const SurfacePoints& surface) {
  pcl::CVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  return mean_histogram<pcl::VFHSignature308>(estimator);
}

}  // namespace loci::perception::feature_delegates
