#include <pcl/features/vfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> vfh(const SurfacePoints& surface) {
  pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  return mean_histogram<pcl::VFHSignature308>(estimator);
}

}  // namespace loci::perception::feature_delegates
