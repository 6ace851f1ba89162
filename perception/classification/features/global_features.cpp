#include <pcl/common/centroid.h>
#include <pcl/console/print.h>
#include <pcl/features/crh.h>
#include <pcl/features/cvfh.h>
#include <pcl/features/gasd.h>
#include <pcl/features/grsd.h>
#include <pcl/features/our_cvfh.h>
#include <pcl/features/pfh.h>
#include <pcl/features/vfh.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "perception/classification/features/delegates.h"
#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr size_t kMax = 400;              ///< points whose normals are compared with one another
constexpr float kSameDirection = 0.978f;  ///< cosine of 12 degrees
constexpr float kOtherDirection = 0.94f;  ///< cosine of 20 degrees

std::vector<Vector3f> some_of(const std::vector<Vector3f>& vectors) {
  std::vector<Vector3f> some;
  const size_t step = std::max<size_t>(1, vectors.size() / kMax);
  for (size_t i = 0; i < vectors.size(); i += step) some.push_back(vectors[i]);
  return some;
}

/// Lengths along the principal axes, longest first, metres.
std::array<float, 3> extents_of(const std::vector<Vector3f>& points) {
  Vector3f mean = Vector3f::Zero();
  for (const Vector3f& p : points) mean += p / static_cast<float>(points.size());
  Matrix3f scatter = Matrix3f::Zero();
  for (const Vector3f& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3f> solver(scatter);
  std::array<float, 3> extents;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> along;
    along.reserve(points.size());
    for (const Vector3f& p : points) along.push_back(solver.eigenvectors().col(axis).dot(p - mean));
    const auto [low, high] = quantiles(along, 0.02, 0.98);
    extents[static_cast<size_t>(axis)] = high - low;
  }
  std::ranges::sort(extents, std::greater<>());
  return extents;
}

/// Shares of the normals in the three directions that most have, and of all others.
std::array<float, 4> modes_of(std::vector<Vector3f> normals) {
  std::array<float, 4> shares{};
  const auto all = static_cast<float>(normals.size());
  for (size_t mode = 0; mode < 3 && !normals.empty(); ++mode) {
    const Vector3f* best = nullptr;
    std::ptrdiff_t most = 0;
    for (const Vector3f& n : normals) {
      const auto near =
          std::ranges::count_if(normals, [&](const Vector3f& m) { return n.dot(m) > kSameDirection; });
      if (near <= most) continue;
      most = near;
      best = &n;
    }
    if (best == nullptr) break;
    const Vector3f direction = *best;
    shares[mode] = static_cast<float>(most) / all;
    std::erase_if(normals, [&](const Vector3f& m) { return direction.dot(m) > kOtherDirection; });
  }
  shares[3] = static_cast<float>(normals.size()) / all;
  return shares;
}

}  // namespace

std::vector<float> vfh(const SurfacePoints& surface) {
  pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  return mean_histogram<pcl::VFHSignature308>(estimator);
}

std::vector<float> cvfh(const SurfacePoints& surface) {
  pcl::CVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  return mean_histogram<pcl::VFHSignature308>(estimator);
}

std::vector<float> our_cvfh(const SurfacePoints& surface) {
  pcl::OURCVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimator;
  prepare(estimator, PclClouds(surface));
  // Round objects have no frame of their own; that is no news for the terminal.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  return mean_histogram<pcl::VFHSignature308>(estimator);
}

std::vector<float> gasd(const SurfacePoints& surface) {
  const PclClouds clouds(surface);
  pcl::GASDEstimation<pcl::PointXYZ, pcl::GASDSignature512> estimator;
  estimator.setInputCloud(clouds.points);
  return mean_histogram<pcl::GASDSignature512>(estimator);
}

std::vector<float> crh(const SurfacePoints& surface) {
  const PclClouds clouds(surface);
  Eigen::Vector4f centroid;
  pcl::compute3DCentroid(*clouds.points, centroid);
  pcl::CRHEstimation<pcl::PointXYZ, pcl::Normal, pcl::Histogram<90>> estimator;
  prepare(estimator, clouds);
  estimator.setCentroid(centroid);
  return mean_histogram<pcl::Histogram<90>>(estimator);
}

std::vector<float> grsd(const SurfacePoints& surface) {
  constexpr double kRadius = 0.02;
  pcl::GRSDEstimation<pcl::PointXYZ, pcl::Normal, pcl::GRSDSignature21> estimator;
  prepare(estimator, PclClouds(surface));
  estimator.setRadiusSearch(kRadius);
  return mean_histogram<pcl::GRSDSignature21>(estimator);
}

std::vector<float> pfh(const SurfacePoints& surface) {
  constexpr int kDivisions = 5;
  const PclClouds clouds(surface);
  pcl::PFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::PFHSignature125> estimator;
  Eigen::VectorXf histogram(kDivisions * kDivisions * kDivisions);
  estimator.computePointPFHSignature(*clouds.points, *clouds.normals, *some_of(clouds, kSpread), kDivisions,
                                     histogram);
  return {histogram.begin(), histogram.end()};
}

std::vector<float> gauss_image(const SurfacePoints& surface) {
  const std::array<float, 3> extents = extents_of(surface.points);
  std::vector<float> values;
  for (const float extent : extents) values.push_back(10 * extent);
  values.push_back(extents[1] / std::max(extents[0], 1e-3f));
  values.push_back(extents[2] / std::max(extents[0], 1e-3f));
  Matrix3f scatter = Matrix3f::Zero();
  for (const Vector3f& n : surface.normals)
    scatter += n * n.transpose() / static_cast<float>(surface.normals.size());
  const Vector3f spread = Eigen::SelfAdjointEigenSolver<Matrix3f>(scatter).eigenvalues();
  for (int axis = 0; axis < 3; ++axis) values.push_back(std::max(0.0f, spread[axis]));
  for (const float share : modes_of(some_of(surface.normals))) values.push_back(share);
  return values;
}

}  // namespace loci::perception::feature_delegates
