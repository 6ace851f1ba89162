#include <pcl/console/print.h>
#include <pcl/features/shot.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::feature_delegates {

std::vector<float> shot(const SurfacePoints& surface) {
  constexpr double kRadius = 0.04;
  const PclClouds clouds(surface);
  pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> estimator;
  prepare(estimator, clouds);
  estimator.setIndices(some_of(clouds, kSpread));
  estimator.setSearchSurface(clouds.points);
  estimator.setRadiusSearch(kRadius);
  // Points whose frame cannot be told get no descriptor; that is no news for the terminal.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  pcl::PointCloud<pcl::SHOT352> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.descriptor; });
}

}  // namespace loci::feature_delegates
