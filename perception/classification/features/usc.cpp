#include <pcl/console/print.h>
#include <pcl/features/usc.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> usc(const SurfacePoints& surface) {
  constexpr double kRadius = 0.04;
  const PclClouds clouds(surface);
  pcl::UniqueShapeContext<pcl::PointXYZ, pcl::UniqueShapeContext1960> estimator;
  pcl::PointCloud<pcl::PointXYZ>::Ptr some = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  const pcl::IndicesPtr indices = some_of(clouds, kFew);
  for (const int i : *indices) some->push_back((*clouds.points)[static_cast<size_t>(i)]);
  estimator.setInputCloud(some);
  estimator.setSearchSurface(clouds.points);
  estimator.setRadiusSearch(kRadius);
  estimator.setMinimalRadius(kRadius / 10);
  estimator.setPointDensityRadius(kRadius / 5);
  estimator.setLocalRadius(kRadius);
  // Points whose frame cannot be told get no descriptor; that is no news for the terminal.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  pcl::PointCloud<pcl::UniqueShapeContext1960> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.descriptor; });
}

}  // namespace loci::perception::feature_delegates
