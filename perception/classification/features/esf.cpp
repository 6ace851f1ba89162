#include <ctime>

#include "perception/classification/features/pcl_clouds.h"

// PCL draws its pairs of points with rand() after srand(time()): another descriptor every second. Here they
// come from a generator of our own, the same for the same points.
#include <pcl/common/distances.h>
#include <pcl/common/transforms.h>
#include <pcl/features/esf.h>

#include "mapping/base/math/random.h"

namespace {

thread_local loci::Random draw(0);

}  // namespace

#define srand(seed) (draw = loci::Random(0))
#define rand() static_cast<int>(draw.bits() >> 33)
#include <pcl/features/impl/esf.hpp>
#undef rand
#undef srand

namespace loci::perception::feature_delegates {

std::vector<float> esf(const SurfacePoints& surface) {
  // A type of point of which PCL's own library has no estimator: what was compiled above is used.
  pcl::PointCloud<pcl::PointXYZL>::Ptr cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZL>>();
  for (const Eigen::Vector3f& p : surface.points) cloud->push_back({p.x(), p.y(), p.z(), 0});
  pcl::ESFEstimation<pcl::PointXYZL, pcl::ESFSignature640> estimator;
  estimator.setInputCloud(cloud);
  return mean_histogram<pcl::ESFSignature640>(estimator);
}

}  // namespace loci::perception::feature_delegates
