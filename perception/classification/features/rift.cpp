#include <pcl/features/intensity_gradient.h>
#include <pcl/features/rift.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

std::vector<float> rift(const SurfacePoints& surface) {
  constexpr double kRadius = 0.03;
  constexpr int kDistances = 4, kAngles = 8;
  if (surface.brightness.empty()) return {};
  const PclClouds clouds(surface);
  auto shaded = std::make_shared<pcl::PointCloud<pcl::PointXYZI>>();
  for (size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    shaded->push_back(pcl::PointXYZI(p.x(), p.y(), p.z(), surface.brightness[i]));
  }
  auto tree = std::make_shared<pcl::search::KdTree<pcl::PointXYZI>>();
  auto gradients = std::make_shared<pcl::PointCloud<pcl::IntensityGradient>>();
  pcl::IntensityGradientEstimation<pcl::PointXYZI, pcl::Normal, pcl::IntensityGradient> slopes;
  slopes.setInputCloud(shaded);
  slopes.setInputNormals(clouds.normals);
  slopes.setSearchMethod(tree);
  slopes.setRadiusSearch(kRadius / 2);
  slopes.setNumberOfThreads(1);
  slopes.compute(*gradients);
  pcl::RIFTEstimation<pcl::PointXYZI, pcl::IntensityGradient, pcl::Histogram<kDistances * kAngles>> estimator;
  estimator.setInputCloud(shaded);
  estimator.setInputGradient(gradients);
  estimator.setSearchMethod(tree);
  estimator.setRadiusSearch(kRadius);
  estimator.setNrDistanceBins(kDistances);
  estimator.setNrGradientBins(kAngles);
  estimator.setIndices(some_of(clouds, kSpread));
  estimator.setSearchSurface(shaded);
  return mean_histogram<pcl::Histogram<kDistances * kAngles>>(estimator);
}

}  // namespace loci::perception::feature_delegates
