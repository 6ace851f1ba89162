#include <pcl/console/print.h>
#include <pcl/features/our_cvfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> our_cvfh(const SurfacePoints& surface) {
  pcl::OURCVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  // Round things have no frame of their own; that is no news for the terminal.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  return mean_histogram<pcl::VFHSignature308>(estimator);
}

}  // namespace loci::perception::feature_delegates
