#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "perception/classification/features/delegates.h"

namespace loci::perception::feature_delegates {

// Only the delegates include this header.

/// A surface as PCL wants it.
struct PclClouds {
  explicit PclClouds(const SurfacePoints& surface) {
    for (const Eigen::Vector3f& p : surface.points) points->push_back({p.x(), p.y(), p.z()});
    for (const Eigen::Vector3f& n : surface.normals) normals->push_back({n.x(), n.y(), n.z()});
    tree->setInputCloud(points);
  }

  pcl::PointCloud<pcl::PointXYZ>::Ptr points = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  pcl::PointCloud<pcl::Normal>::Ptr normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree = std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>();
};

/// Sets what all estimators from normals have in common.
template <class Estimator>
void prepare(Estimator& estimator, const PclClouds& clouds) {
  estimator.setInputCloud(clouds.points);
  estimator.setInputNormals(clouds.normals);
  estimator.setSearchMethod(clouds.tree);
}

/// The mean of an array of each signature, without those that have no finite values. Empty when there is
/// none.
template <class Cloud, class Values>
std::vector<float> mean_of(const Cloud& signatures, const Values& values_of) {
  std::vector<float> mean;
  size_t count = 0;
  for (const auto& signature : signatures) {
    const auto& values = values_of(signature);  // a reference, or a value whose life this prolongs
    if (!std::all_of(std::begin(values), std::end(values), [](float value) { return std::isfinite(value); }))
      continue;
    mean.resize(static_cast<size_t>(std::end(values) - std::begin(values)), 0.0f);
    for (size_t i = 0; i < mean.size(); ++i) mean[i] += values[i];
    ++count;
  }
  for (float& value : mean) value /= static_cast<float>(count);
  return mean;
}

/// An array of each signature that has only finite values, with the point that it was taken at.
template <class Cloud, class Values>
LocalFeatures local_of(const PclClouds& clouds, const std::vector<int>& at, const Cloud& signatures,
                       const Values& values_of) {
  LocalFeatures features;
  for (size_t i = 0; i < signatures.size(); ++i) {
    const auto& values = values_of(signatures[i]);
    if (!std::all_of(std::begin(values), std::end(values), [](float value) { return std::isfinite(value); }))
      continue;
    features.length = static_cast<size_t>(std::end(values) - std::begin(values));
    features.values.insert(features.values.end(), std::begin(values), std::end(values));
    features.places.emplace_back((*clouds.points)[static_cast<size_t>(at[i])].getVector3fMap());
  }
  return features;
}

/// Computes signatures and takes the mean of their histograms.
template <class Signature, class Estimator>
std::vector<float> mean_histogram(Estimator& estimator) {
  pcl::PointCloud<Signature> signatures;
  estimator.compute(signatures);
  return mean_of(
      signatures, [](const auto& signature) -> const auto& { return signature.histogram; });
}

/// About `most` points spread evenly over the order of the points.
inline pcl::IndicesPtr some_of(const PclClouds& clouds, size_t most) {
  auto indices = std::make_shared<pcl::Indices>();
  const size_t step = std::max<size_t>(1, clouds.points->size() / most);
  for (size_t i = 0; i < clouds.points->size(); i += step) indices->push_back(static_cast<int>(i));
  return indices;
}

constexpr size_t kSpread = 250;  ///< points whose descriptors are averaged
constexpr size_t kFew = 60;      ///< of those whose descriptors are slow

}  // namespace loci::perception::feature_delegates
