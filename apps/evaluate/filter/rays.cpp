#include "apps/evaluate/filter/rays.h"

#include <embree3/rtcore.h>

#include <cmath>

#include "mapping/base/stopwatch.h"

namespace loci::apps::filter_evaluation {

struct InstanceRays::Impl {
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);
  std::vector<RTCScene> meshes;
  std::vector<std::vector<Eigen::Vector3f>> vertices;  ///< Embree reads them where they are
  double tree_seconds = 0;

  ~Impl() {
    rtcReleaseScene(scene);
    for (const RTCScene mesh : meshes) rtcReleaseScene(mesh);
    rtcReleaseDevice(device);
  }
  void add_mesh(const mapping::TriangleMesh& mesh);
  void add_instance(RTCScene mesh, const Isometry3d& pose);
};

void InstanceRays::Impl::add_mesh(const mapping::TriangleMesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners = static_cast<Eigen::Vector3f*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Eigen::Vector3f), mesh.vertices.size()));
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), corners);
  auto* triangles = static_cast<std::array<uint32_t, 3>*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(std::array<uint32_t, 3>), mesh.triangles.size()));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
  rtcCommitGeometry(geometry);
  meshes.push_back(rtcNewScene(device));
  rtcAttachGeometry(meshes.back(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(meshes.back());
}

void InstanceRays::Impl::add_instance(RTCScene mesh, const Isometry3d& pose) {
  const RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, mesh);
  const Eigen::Matrix<float, 3, 4> matrix = pose.matrix().topRows<3>().cast<float>();
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
  rtcCommitGeometry(instance);
  rtcAttachGeometry(scene, instance);
  rtcReleaseGeometry(instance);
}

InstanceRays::InstanceRays(const std::vector<mapping::TriangleMesh>& meshes,
                           const std::vector<Isometry3d>& camera_from_instances)
    : impl_(std::make_unique<Impl>()) {
  for (const mapping::TriangleMesh& mesh : meshes) impl_->add_mesh(mesh);
  const Stopwatch watch;
  for (size_t i = 0; i < camera_from_instances.size(); ++i)
    impl_->add_instance(impl_->meshes[i % meshes.size()], camera_from_instances[i]);
  rtcCommitScene(impl_->scene);
  impl_->tree_seconds = watch.seconds();
}

InstanceRays::~InstanceRays() = default;

double InstanceRays::tree_seconds() const {
  return impl_->tree_seconds;
}

cv::Mat InstanceRays::depth(const mapping::PinholeCamera& camera) const {
  cv::Mat depth(camera.height, camera.width, CV_32F);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3f direction = camera.unproject(u, v, 1).cast<float>();
      RTCRayHit ray{};
      ray.ray.dir_x = direction.x();
      ray.ray.dir_y = direction.y();
      ray.ray.dir_z = direction.z();  // 1: distances along the ray are depths.
      ray.ray.tfar = 100;
      ray.ray.mask = ~0u;
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(impl_->scene, &context, &ray);
      depth.at<float>(v, u) = ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::nanf("") : ray.ray.tfar;
    }
  return depth;
}

}  // namespace loci::apps::filter_evaluation
