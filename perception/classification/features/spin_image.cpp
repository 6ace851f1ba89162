#include <pcl/features/spin_image.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> spin_image(const SurfacePoints& surface) {
  constexpr double kRadius = 0.05;
  const PclClouds clouds(surface);
  pcl::SpinImageEstimation<pcl::PointXYZ, pcl::Normal, pcl::Histogram<153>> estimator(8, 0, 1);
  prepare(estimator, clouds);
  estimator.setIndices(some_of(clouds, kSpread));
  estimator.setSearchSurface(clouds.points);
  estimator.setRadiusSearch(kRadius);
  return mean_histogram<pcl::Histogram<153>>(estimator);
}

}  // namespace loci::perception::feature_delegates
