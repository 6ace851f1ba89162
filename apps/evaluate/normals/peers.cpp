#include "apps/evaluate/normals/peers.h"

#include <pcl/features/integral_image_normal.h>
#include <pcl/features/linear_least_squares_normal.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <limits>

#include "mapping/base/stopwatch.h"

namespace loci::apps::normals_evaluation {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Cloud::Ptr cloud_of(const cv::Mat& depth, const mapping::PinholeCamera& camera) {
  Cloud::Ptr cloud(
      new Cloud(static_cast<uint32_t>(depth.cols), static_cast<uint32_t>(depth.rows), {kNan, kNan, kNan}));
  cloud->is_dense = false;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      if (!(z > 0)) continue;
      const Vector3d p = camera.unproject(u, v, static_cast<double>(z));
      cloud->at(u, v) = {static_cast<float>(p.x()), static_cast<float>(p.y()), z};
    }
  return cloud;
}

class PclMethod : public Method {
 public:
  Estimate estimate(const cv::Mat& depth, const mapping::PinholeCamera& camera) override {
    const Cloud::Ptr cloud = cloud_of(depth, camera);
    Normals normals;
    const double begin = thread_cpu_seconds();
    compute(cloud, normals);
    Estimate result{cv::Mat(depth.size(), CV_32FC3), thread_cpu_seconds() - begin};
    for (int v = 0; v < depth.rows; ++v)
      for (int u = 0; u < depth.cols; ++u) {
        const pcl::Normal& n = normals.at(u, v);
        result.normals.at<cv::Vec3f>(v, u) = {n.normal_x, n.normal_y, n.normal_z};
      }
    return result;
  }

 private:
  virtual void compute(const Cloud::Ptr& cloud, Normals& normals) = 0;
};

class KdTree : public PclMethod {
  void compute(const Cloud::Ptr& cloud, Normals& normals) override {
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> method;
    method.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    method.setKSearch(20);
    method.setInputCloud(cloud);
    method.compute(normals);
  }
};

/// Both kinds that use the order of the pixels; kept from frame to frame, as in a stream.
template <typename Estimation>
class Organized : public PclMethod {
  void compute(const Cloud::Ptr& cloud, Normals& normals) override {
    method_.setInputCloud(cloud);
    method_.compute(normals);
  }
  Estimation method_;
};

}  // namespace

std::unique_ptr<Method> pcl_normal_estimation() {
  return std::make_unique<KdTree>();
}

std::unique_ptr<Method> pcl_integral_image() {
  return std::make_unique<Organized<pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal>>>();
}

std::unique_ptr<Method> pcl_linear_least_squares() {
  return std::make_unique<Organized<pcl::LinearLeastSquaresNormalEstimation<pcl::PointXYZ, pcl::Normal>>>();
}

}  // namespace loci::apps::normals_evaluation
