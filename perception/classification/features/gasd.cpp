#include <pcl/features/gasd.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> gasd(const SurfacePoints& surface) {
  const PclClouds clouds(surface);
  pcl::GASDEstimation<pcl::PointXYZ, pcl::GASDSignature512> estimator;
  estimator.setInputCloud(clouds.points);
  return mean_histogram<pcl::GASDSignature512>(estimator);
}

}  // namespace loci::perception::feature_delegates
