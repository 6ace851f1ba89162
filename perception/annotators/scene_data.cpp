#include "perception/annotators/scene_data.h"

#include "perception/conversions/opencv.h"
#include "perception/conversions/pcl.h"

namespace loci {
namespace {

/// The first three floats of every point.
template <class Point>
cv::Mat image_of(const types::PointCloud& cloud) {
  const cas::Buffer<Point> points = types::points_of<Point>(cloud);
  cv::Mat image(static_cast<int>(cloud.height.get()), static_cast<int>(cloud.width.get()), CV_32FC3);
  if (points.size() != image.total()) throw Error("the cloud of the scene is not organised");
  auto* out = image.ptr<cv::Vec3f>();
  for (size_t i = 0; i < points.size(); ++i) {
    if constexpr (std::is_same_v<Point, pcl::Normal>)
      out[i] = cv::Vec3f(points[i].normal_x, points[i].normal_y, points[i].normal_z);
    else
      out[i] = cv::Vec3f(points[i].x, points[i].y, points[i].z);
  }
  return image;
}

template <class Cloud>
std::shared_ptr<Cloud> organised(const cv::Mat& image) {
  auto cloud = std::make_shared<Cloud>();
  cloud->resize(image.total());
  cloud->width = static_cast<uint32_t>(image.cols);
  cloud->height = static_cast<uint32_t>(image.rows);
  cloud->is_dense = false;
  return cloud;
}

}  // namespace

cv::Mat cloud_points(const types::SceneCas& scene) {
  return image_of<pcl::PointXYZ>(scene.cloud());
}

cv::Mat cloud_normals(const types::SceneCas& scene) {
  return image_of<pcl::Normal>(scene.normals());
}

void set_cloud_points(const types::SceneCas& scene, const cv::Mat& points) {
  const auto cloud = organised<pcl::PointCloud<pcl::PointXYZ>>(points);
  const auto* in = points.ptr<cv::Vec3f>();
  for (size_t i = 0; i < cloud->size(); ++i) cloud->points[i] = pcl::PointXYZ(in[i][0], in[i][1], in[i][2]);
  scene.set_cloud(types::to(scene.cas(), std::shared_ptr<const pcl::PointCloud<pcl::PointXYZ>>(cloud)));
}

void set_cloud_normals(const types::SceneCas& scene, const cv::Mat& normals) {
  const auto cloud = organised<pcl::PointCloud<pcl::Normal>>(normals);
  const auto* in = normals.ptr<cv::Vec3f>();
  for (size_t i = 0; i < cloud->size(); ++i) cloud->points[i] = pcl::Normal(in[i][0], in[i][1], in[i][2]);
  scene.set_normals(types::to(scene.cas(), std::shared_ptr<const pcl::PointCloud<pcl::Normal>>(cloud)));
}

Isometry3d map_from_camera(const types::Scene& scene) {
  if (!scene.map_from_camera.is_set()) throw Error("the scene has no pose of the camera");
  return types::from<Isometry3d>(scene.map_from_camera.get());
}

bool has_measured_pose(const types::Scene& scene) {
  return scene.map_from_camera.is_set() && scene.map_from_camera.get().frame_id.get() != kAssumedFrame;
}

cas::Buffer<int32_t> cluster_indices(const types::Cluster& cluster) {
  const auto reference = cluster.hypotheses.first<types::ReferenceClusterPoints>();
  return reference ? reference.indices.get().indices.get() : cas::Buffer<int32_t>();
}

std::vector<Vector3d> cluster_points(const types::SceneCas& scene, const types::Cluster& cluster) {
  const Isometry3d pose = map_from_camera(scene.scene());
  const cas::Buffer<pcl::PointXYZ> cloud = types::points_of<pcl::PointXYZ>(scene.cloud());
  std::vector<Vector3d> points;
  for (const int32_t index : cluster_indices(cluster))
    points.push_back(pose * cloud[static_cast<size_t>(index)].getVector3fMap().cast<double>());
  return points;
}

}  // namespace loci
