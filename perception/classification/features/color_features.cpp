#include <pcl/console/print.h>
#include <pcl/features/intensity_gradient.h>
#include <pcl/features/pfhrgb.h>
#include <pcl/features/rift.h>
#include <pcl/features/shot.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {
namespace {

/// Luma of ITU-R BT.601.
float brightness_of(const Eigen::Vector3f& color) {
  return color.dot(Eigen::Vector3f(0.114f, 0.587f, 0.299f));
}

pcl::PointCloud<pcl::PointXYZRGB>::Ptr colored_points(const SurfacePoints& surface) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
  const auto byte = [](float value) { return static_cast<uint8_t>(std::clamp(value, 0.0f, 255.0f)); };
  for (size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f &p = surface.points[i], &color = surface.colors[i];
    cloud->push_back({p.x(), p.y(), p.z(), byte(color[2]), byte(color[1]), byte(color[0])});
  }
  return cloud;
}

}  // namespace

std::vector<float> rift(const SurfacePoints& surface) {
  constexpr double kRadius = 0.03;
  constexpr int kDistances = 4, kAngles = 8;
  if (surface.colors.empty()) return {};
  const PclClouds clouds(surface);
  auto shaded = std::make_shared<pcl::PointCloud<pcl::PointXYZI>>();
  for (size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    shaded->push_back(pcl::PointXYZI(p.x(), p.y(), p.z(), brightness_of(surface.colors[i])));
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

std::vector<float> pfh_rgb(const SurfacePoints& surface) {
  if (surface.colors.empty()) return {};
  // PCL takes all pairs among the neighbours of a point: here every point is a neighbour of the first.
  SurfacePoints some;
  const pcl::IndicesPtr indices = some_of(PclClouds(surface), kSpread);
  for (const int i : *indices) {
    const auto at = static_cast<size_t>(i);
    some.points.push_back(surface.points[at]);
    some.normals.push_back(surface.normals[at]);
    some.colors.push_back(surface.colors[at]);
  }
  pcl::PFHRGBEstimation<pcl::PointXYZRGB, pcl::Normal, pcl::PFHRGBSignature250> estimator;
  estimator.setInputCloud(colored_points(some));
  estimator.setInputNormals(PclClouds(some).normals);
  estimator.setIndices(std::make_shared<pcl::Indices>(1, 0));
  estimator.setKSearch(static_cast<int>(some.points.size()));
  return mean_histogram<pcl::PFHRGBSignature250>(estimator);
}

std::vector<float> color_shot(const SurfacePoints& surface) {
  constexpr double kRadius = 0.04;
  if (surface.colors.empty()) return {};
  const PclClouds clouds(surface);
  const auto cloud = colored_points(surface);
  pcl::SHOTColorEstimation<pcl::PointXYZRGB, pcl::Normal, pcl::SHOT1344> estimator;
  estimator.setInputCloud(cloud);
  estimator.setInputNormals(clouds.normals);
  estimator.setIndices(some_of(clouds, kSpread));
  estimator.setSearchSurface(cloud);
  estimator.setRadiusSearch(kRadius);
  // Points without a unique reference frame get no descriptor; PCL would print a warning for each.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  pcl::PointCloud<pcl::SHOT1344> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.descriptor; });
}

}  // namespace loci::perception::feature_delegates
