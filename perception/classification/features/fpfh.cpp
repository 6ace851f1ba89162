#include <pcl/features/fpfh.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {
namespace {

pcl::PointCloud<pcl::FPFHSignature33> signatures_at(const PclClouds& clouds, const pcl::IndicesPtr& indices) {
  constexpr double kRadius = 0.025;
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimator;
  prepare(estimator, clouds);
  estimator.setIndices(indices);
  estimator.setRadiusSearch(kRadius);
  pcl::PointCloud<pcl::FPFHSignature33> signatures;
  estimator.compute(signatures);
  return signatures;
}

}  // namespace

std::vector<float> fpfh(const SurfacePoints& surface) {
  const PclClouds clouds(surface);
  return mean_of(
      signatures_at(clouds, some_of(clouds, kSpread)),
      [](const auto& signature) -> const auto& { return signature.histogram; });
}

LocalFeatures fpfh_at(const SurfacePoints& surface, const std::vector<int>& at) {
  const PclClouds clouds(surface);
  return local_of(
      clouds, at, signatures_at(clouds, std::make_shared<pcl::Indices>(at.begin(), at.end())),
      [](const auto& signature) -> const auto& { return signature.histogram; });
}

}  // namespace loci::perception::feature_delegates
