#include <pcl/keypoints/iss_3d.h>

#include "perception/classification/features/pcl_clouds.h"

namespace loci::perception::feature_delegates {

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

}  // namespace loci::perception::feature_delegates
