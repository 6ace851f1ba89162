#include "perception/annotators/scene_data.h"

#include "perception/conversions/opencv.h"
#include "perception/conversions/pcl.h"

namespace loci::perception {
namespace {

/// Deletes a cloud that was made from an image, and keeps the image as long: nobody has to take the cloud
/// apart again.
template <class Point>
struct WithImage {
  cv::Mat image;
  void operator()(const pcl::PointCloud<Point>* cloud) const { delete cloud; }
};

pcl::PointXYZ point_of(const cv::Vec3f& v, pcl::PointXYZ*) {
  return {v[0], v[1], v[2]};
}
pcl::Normal point_of(const cv::Vec3f& v, pcl::Normal*) {
  return {v[0], v[1], v[2]};
}
cv::Vec3f vector_of(const pcl::PointXYZ& p) {
  return {p.x, p.y, p.z};
}
cv::Vec3f vector_of(const pcl::Normal& n) {
  return {n.normal_x, n.normal_y, n.normal_z};
}

template <class Point>
std::shared_ptr<const pcl::PointCloud<Point>> cloud_of(const cv::Mat& image) {
  const std::shared_ptr<pcl::PointCloud<Point>> cloud(new pcl::PointCloud<Point>, WithImage<Point>{image});
  cloud->points.resize(image.total());
  const auto* in = image.ptr<cv::Vec3f>();
  for (Point& point : cloud->points) point = point_of(*in++, static_cast<Point*>(nullptr));
  cloud->width = static_cast<uint32_t>(image.cols);
  cloud->height = static_cast<uint32_t>(image.rows);
  cloud->is_dense = false;
  return cloud;
}

template <class Point>
cv::Mat image_of(const typename types::PointTraits<Point>::Proxy& proxy) {
  const auto cloud = types::from<std::shared_ptr<const pcl::PointCloud<Point>>>(proxy);
  if (const auto* made_from = std::get_deleter<WithImage<Point>>(cloud)) return made_from->image;
  cv::Mat image(static_cast<int>(cloud->height), static_cast<int>(cloud->width), CV_32FC3);
  if (cloud->size() != image.total()) throw Error("the cloud of the scene is not organised");
  auto* out = image.ptr<cv::Vec3f>();
  for (size_t i = 0; i < cloud->size(); ++i) out[i] = vector_of(cloud->points[i]);
  return image;
}

}  // namespace

cv::Mat cloud_points(const types::SceneCas& scene) {
  return image_of<pcl::PointXYZ>(scene.cloud());
}

cv::Mat cloud_normals(const types::SceneCas& scene) {
  return image_of<pcl::Normal>(scene.normals());
}

void set_cloud_points(const types::SceneCas& scene, const cv::Mat& points) {
  scene.set_cloud(types::to(scene.cas(), cloud_of<pcl::PointXYZ>(points)));
}

void set_cloud_normals(const types::SceneCas& scene, const cv::Mat& normals) {
  scene.set_normals(types::to(scene.cas(), cloud_of<pcl::Normal>(normals)));
}

Isometry3d map_from_camera(const types::Scene& scene) {
  if (!scene.map_from_camera.is_set()) throw Error("the scene has no pose of the camera");
  return types::from<Isometry3d>(scene.map_from_camera.get());
}

bool has_measured_pose(const types::Scene& scene) {
  return scene.map_from_camera.is_set() && scene.map_from_camera.get().frame_id.get() != kAssumedFrame;
}

std::vector<Vector3d> cluster_points(const types::SceneCas& scene, const types::Cluster& cluster) {
  const Isometry3d pose = map_from_camera(scene.scene());
  const cas::Buffer<pcl::PointXYZ> cloud = types::points_of<pcl::PointXYZ>(scene.cloud());
  std::vector<Vector3d> points;
  for (const int32_t index : cluster_indices(cluster))
    points.push_back(pose * cloud[static_cast<size_t>(index)].getVector3fMap().cast<double>());
  return points;
}

}  // namespace loci::perception
