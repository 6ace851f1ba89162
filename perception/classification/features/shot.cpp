#include <pcl/console/print.h>
#include <pcl/features/shot.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {
namespace {

pcl::PointCloud<pcl::SHOT352> signatures_at(const PclClouds& clouds, const pcl::IndicesPtr& indices) {
  constexpr double kRadius = 0.04;
  pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> estimator;
  prepare(estimator, clouds);
  estimator.setIndices(indices);
  estimator.setSearchSurface(clouds.points);
  estimator.setRadiusSearch(kRadius);
  // Points whose frame cannot be told get no descriptor; that is no news for the terminal.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  pcl::PointCloud<pcl::SHOT352> signatures;
  estimator.compute(signatures);
  return signatures;
}

}  // namespace

std::vector<float> shot(const SurfacePoints& surface) {
  const PclClouds clouds(surface);
  return mean_of(
      signatures_at(clouds, some_of(clouds, kSpread)),
      [](const auto& signature) -> const auto& { return signature.descriptor; });
}

LocalFeatures shot_at(const SurfacePoints& surface, const std::vector<int>& at) {
  const PclClouds clouds(surface);
  return local_of(
      clouds, at, signatures_at(clouds, std::make_shared<pcl::Indices>(at.begin(), at.end())),
      [](const auto& signature) -> const auto& { return signature.descriptor; });
}

}  // namespace loci::perception::feature_delegates
