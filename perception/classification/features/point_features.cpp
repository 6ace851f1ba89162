#include <pcl/console/print.h>
#include <pcl/features/3dsc.h>
#include <pcl/features/fpfh.h>
#include <pcl/features/moment_invariants.h>
#include <pcl/features/principal_curvatures.h>
#include <pcl/features/rsd.h>
#include <pcl/features/shot.h>
#include <pcl/features/spin_image.h>
#include <pcl/features/usc.h>
#include <pcl/keypoints/iss_3d.h>

#include <array>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {
namespace {

pcl::PointCloud<pcl::FPFHSignature33> fpfh_signatures(const PclClouds& clouds,
                                                      const pcl::IndicesPtr& indices) {
  constexpr double kRadius = 0.025;
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimator;
  prepare(estimator, clouds);
  estimator.setIndices(indices);
  estimator.setRadiusSearch(kRadius);
  pcl::PointCloud<pcl::FPFHSignature33> signatures;
  estimator.compute(signatures);
  return signatures;
}

pcl::PointCloud<pcl::SHOT352> shot_signatures(const PclClouds& clouds, const pcl::IndicesPtr& indices) {
  constexpr double kRadius = 0.04;
  pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> estimator;
  prepare(estimator, clouds);
  estimator.setIndices(indices);
  estimator.setSearchSurface(clouds.points);
  estimator.setRadiusSearch(kRadius);
  // Points without a unique reference frame get no descriptor; PCL would print a warning for each.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  pcl::PointCloud<pcl::SHOT352> signatures;
  estimator.compute(signatures);
  return signatures;
}

/// An estimator at points spread over the surface, from their neighbours within a radius.
template <class Estimator>
void prepare_at(Estimator& estimator, const PclClouds& clouds, size_t points, double radius) {
  prepare(estimator, clouds);
  estimator.setIndices(some_of(clouds, points));
  estimator.setSearchSurface(clouds.points);
  estimator.setRadiusSearch(radius);
}

}  // namespace

std::vector<int> keypoints(const SurfacePoints& surface) {
  constexpr double kRadius = 0.025;
  constexpr size_t kMin = 20;
  const PclClouds clouds(surface);
  pcl::ISSKeypoint3D<pcl::PointXYZ, pcl::PointXYZ> detector;
  detector.setInputCloud(clouds.points);
  detector.setSearchMethod(clouds.tree);
  detector.setSalientRadius(kRadius);
  detector.setNonMaxRadius(kRadius / 2);
  detector.setMinNeighbors(5);
  pcl::PointCloud<pcl::PointXYZ> found;
  detector.compute(found);
  const pcl::PointIndicesConstPtr indices = detector.getKeypointsIndices();
  std::vector<int> at(indices->indices.begin(), indices->indices.end());
  if (at.size() >= kMin) return at;
  const pcl::IndicesPtr spread = some_of(clouds, kFew);
  return {spread->begin(), spread->end()};
}

std::vector<float> fpfh(const SurfacePoints& surface) {
  const PclClouds clouds(surface);
  return mean_of(
      fpfh_signatures(clouds, some_of(clouds, kSpread)),
      [](const auto& signature) -> const auto& { return signature.histogram; });
}

LocalFeatures fpfh_at(const SurfacePoints& surface, const std::vector<int>& at) {
  const PclClouds clouds(surface);
  return local_of(
      clouds, at, fpfh_signatures(clouds, std::make_shared<pcl::Indices>(at.begin(), at.end())),
      [](const auto& signature) -> const auto& { return signature.histogram; });
}

std::vector<float> shot(const SurfacePoints& surface) {
  const PclClouds clouds(surface);
  return mean_of(
      shot_signatures(clouds, some_of(clouds, kSpread)),
      [](const auto& signature) -> const auto& { return signature.descriptor; });
}

LocalFeatures shot_at(const SurfacePoints& surface, const std::vector<int>& at) {
  const PclClouds clouds(surface);
  return local_of(
      clouds, at, shot_signatures(clouds, std::make_shared<pcl::Indices>(at.begin(), at.end())),
      [](const auto& signature) -> const auto& { return signature.descriptor; });
}

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
  // Points without a unique reference frame get no descriptor; PCL would print a warning for each.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  pcl::PointCloud<pcl::UniqueShapeContext1960> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.descriptor; });
}

std::vector<float> shape_context(const SurfacePoints& surface) {
  constexpr double kRadius = 0.04;
  const PclClouds clouds(surface);
  // Its directions about the normal are drawn, by default from the same seed.
  pcl::ShapeContext3DEstimation<pcl::PointXYZ, pcl::Normal, pcl::ShapeContext1980> estimator;
  prepare_at(estimator, clouds, kFew, kRadius);
  estimator.setMinimalRadius(kRadius / 10);
  estimator.setPointDensityRadius(kRadius / 5);
  pcl::PointCloud<pcl::ShapeContext1980> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.descriptor; });
}

std::vector<float> rsd(const SurfacePoints& surface) {
  constexpr double kRadius = 0.02, kPlane = 0.2;
  const PclClouds clouds(surface);
  pcl::RSDEstimation<pcl::PointXYZ, pcl::Normal, pcl::PrincipalRadiiRSD> estimator;
  prepare_at(estimator, clouds, kSpread, kRadius);
  estimator.setPlaneRadius(kPlane);
  pcl::PointCloud<pcl::PrincipalRadiiRSD> radii;
  estimator.compute(radii);
  return mean_of(radii, [](const auto& at) { return std::array{at.r_min, at.r_max}; });
}

std::vector<float> moments(const SurfacePoints& surface) {
  constexpr double kRadius = 0.025;
  const PclClouds clouds(surface);
  pcl::MomentInvariantsEstimation<pcl::PointXYZ, pcl::MomentInvariants> estimator;
  estimator.setInputCloud(clouds.points);
  estimator.setSearchMethod(clouds.tree);
  estimator.setIndices(some_of(clouds, kSpread));
  estimator.setSearchSurface(clouds.points);
  estimator.setRadiusSearch(kRadius);
  pcl::PointCloud<pcl::MomentInvariants> invariants;
  estimator.compute(invariants);
  return mean_of(invariants, [](const auto& at) { return std::array{at.j1, at.j2, at.j3}; });
}

std::vector<float> curvatures(const SurfacePoints& surface) {
  constexpr double kRadius = 0.02;
  const PclClouds clouds(surface);
  pcl::PrincipalCurvaturesEstimation<pcl::PointXYZ, pcl::Normal, pcl::PrincipalCurvatures> estimator;
  prepare_at(estimator, clouds, kSpread, kRadius);
  pcl::PointCloud<pcl::PrincipalCurvatures> signatures;
  estimator.compute(signatures);
  return mean_of(signatures, [](const auto& at) { return std::array{at.pc1, at.pc2}; });
}

std::vector<float> spin_image(const SurfacePoints& surface) {
  constexpr double kRadius = 0.05;
  const PclClouds clouds(surface);
  pcl::SpinImageEstimation<pcl::PointXYZ, pcl::Normal, pcl::Histogram<153>> estimator(8, 0, 1);
  prepare_at(estimator, clouds, kSpread, kRadius);
  return mean_histogram<pcl::Histogram<153>>(estimator);
}

}  // namespace loci::perception::feature_delegates
