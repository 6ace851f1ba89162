#include "apps/evaluate/filter/speed.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/render/render.h"
#include "mapping/sensor/camera.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::apps::filter_evaluation {
namespace {

/// The same image by Embree: single rays into a tree of instances, on the calling thread.
class InstanceRays {
 public:
  /// Instance i is mesh i modulo the number of meshes. The tree is built on one thread.
  InstanceRays(const std::vector<mapping::TriangleMesh>& meshes,
               const std::vector<Isometry3d>& camera_from_instances);
  ~InstanceRays();
  InstanceRays(const InstanceRays&) = delete;
  InstanceRays& operator=(const InstanceRays&) = delete;

  /// z-depth, CV_32F, NaN = nothing.
  cv::Mat depth(const mapping::PinholeCamera& camera) const;
  /// What the tree over the instances took, without those of the meshes.
  double tree_seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

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

constexpr int kMeshVertices = 3500;  ///< of each mesh, as in §4.2.2.2
constexpr int kDistinctMeshes = 50;
constexpr int kRobotMeshes = 45;

constexpr int kRings = 53, kSegments = 66;
static_assert(kRings * kSegments + 2 == kMeshVertices);

/// x to a power, its sign kept.
double power(double x, double exponent) {
  return std::copysign(std::pow(std::abs(x), exponent), x);
}

std::string obj_text(const mapping::TriangleMesh& mesh) {
  std::string text;
  for (const Eigen::Vector3f& p : mesh.vertices) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : mesh.triangles) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  return text;
}

/// Closed bodies of kMeshVertices vertices between ellipsoid and box with waves on them, half as long as
/// [least, most] along each axis: the sizes of a robot's links.
mapping::TriangleMesh random_body(double min_half_m, double max_half_m, Random& random) {
  Vector3d half;
  for (double& side : half) side = random.uniform(min_half_m, max_half_m);
  const double exponent = random.uniform(0.3, 1), phase = random.uniform(0, 6), lean = random.uniform(0, 6);
  const int waves = 2 + static_cast<int>(random.index(5));
  const auto at = [&](double theta, double phi) {
    const double st = std::sin(theta), ct = std::cos(theta);
    const double r = 1 + 0.08 * std::sin(waves * phi + phase) * st * std::cos(3 * theta + lean);
    const Vector3d unit(power(st, exponent) * power(std::cos(phi), exponent),
                        power(st, exponent) * power(std::sin(phi), exponent), power(ct, exponent));
    return Eigen::Vector3f((r * half.cwiseProduct(unit)).cast<float>());
  };
  mapping::TriangleMesh mesh;
  mesh.vertices.push_back(at(0, 0));
  for (int ring = 1; ring <= kRings; ++ring)
    for (int i = 0; i < kSegments; ++i)
      mesh.vertices.push_back(at(kPi * ring / (kRings + 1), 2 * kPi * i / kSegments));
  mesh.vertices.push_back(at(kPi, 0));
  const auto number = [](int ring, int i) {
    return static_cast<uint32_t>(1 + (ring - 1) * kSegments + i % kSegments);
  };
  for (int i = 0; i < kSegments; ++i) {
    mesh.triangles.push_back({0, number(1, i), number(1, i + 1)});
    mesh.triangles.push_back({kMeshVertices - 1, number(kRings, i + 1), number(kRings, i)});
    for (int ring = 1; ring < kRings; ++ring) {
      mesh.triangles.push_back({number(ring, i), number(ring + 1, i), number(ring + 1, i + 1)});
      mesh.triangles.push_back({number(ring, i), number(ring + 1, i + 1), number(ring, i + 1)});
    }
  }
  return mesh;
}

/// A pose at a random orientation whose origin is in the image, 1 to 6 m away, uniform in depth.
Isometry3d random_pose_in_view(const mapping::PinholeCamera& camera, Random& random) {
  const double z = random.uniform(1, 6);
  const double u = random.uniform(0, camera.width), v = random.uniform(0, camera.height);
  const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = turn.normalized().toRotationMatrix();
  pose.translation() = camera.unproject(u, v, z);
  return pose;
}

/// A robot of 45 links with a mesh each, four arms of revolute joints on a base; meshes are written into a
/// folder, which the URDF's relative names refer to.
mapping::World random_robot(const std::filesystem::path& folder, Random& random) {
  constexpr int kArms = 4;
  mapping::World robot;
  robot.name = "robot";
  robot.root = "link_0";
  for (int i = 0; i < kRobotMeshes; ++i) {
    const std::string file = fmt::format("link_{}.obj", i);
    write_file_atomically(folder / file, obj_text(random_body(0.03, 0.15, random)));
    mapping::Link link;
    link.name = fmt::format("link_{}", i);
    link.visuals.push_back({"", Isometry3d::Identity(), mapping::Mesh{file}, std::nullopt});
    robot.links.push_back(link);
    if (i == 0) continue;
    mapping::Joint joint;
    joint.name = fmt::format("joint_{}", i);
    joint.type = mapping::JointType::revolute;
    joint.parent = fmt::format("link_{}", std::max(0, i - kArms));
    joint.child = link.name;
    joint.parent_from_joint.translation() =
        Vector3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.05, 0.15));
    joint.axis = i % 2 == 0 ? Vector3d::UnitX() : Vector3d::UnitY();
    joint.limits = mapping::JointLimits{-1, 1, 1, 1};
    robot.joints.push_back(joint);
  }
  return robot;
}

/// A joint state of it.
JointState random_joints(const mapping::World& robot, Random& random) {
  JointState joints;
  for (const mapping::Joint& joint : robot.joints) joints[joint.name] = random.uniform(-0.6, 0.6);
  return joints;
}

Time best_time(int repeats, const std::function<void()>& work) {
  Time best;
  for (int i = 0; i < repeats; ++i) {
    const Stopwatch watch;
    work();
    const double clock = 1e3 * watch.seconds(), processor = 1e3 * watch.cpu_seconds();
    best.clock_ms = i == 0 ? clock : std::min(best.clock_ms, clock);
    best.processor_ms = i == 0 ? processor : std::min(best.processor_ms, processor);
  }
  return best;
}

bool same(const mapping::RenderedView& a, const mapping::RenderedView& b) {
  const auto equal = [](const cv::Mat& x, const cv::Mat& y) {
    return std::memcmp(x.data, y.data, x.total() * x.elemSize()) == 0;
  };
  return equal(a.depth, b.depth) && equal(a.link, b.link);
}

int different_pixels(const cv::Mat& a, const cv::Mat& b) {
  int count = 0;
  for (int i = 0; i < a.rows * a.cols; ++i) {
    const float x = a.ptr<float>()[i], y = b.ptr<float>()[i];
    if (std::isnan(x) != std::isnan(y) || std::abs(x - y) > 0.002f) ++count;
  }
  return count;
}

CrowdTimes time_crowd(int count, const std::vector<mapping::TriangleMesh>& meshes,
                      const std::vector<Isometry3d>& poses, const SpeedOptions& options) {
  const mapping::PinholeCamera camera;
  mapping::RenderScene scene;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i)
    if (i < meshes.size())
      scene.add(fmt::format("mesh_{}", i), meshes[i], poses[i]);
    else
      scene.add_copy(i % meshes.size(), poses[i]);
  CrowdTimes times;
  times.meshes = count;
  mapping::RenderedView one, two, all;
  times.one = best_time(options.repeats, [&] { one = scene.render(camera, Isometry3d::Identity(), {}, 1); });
  times.two = best_time(options.repeats, [&] { two = scene.render(camera, Isometry3d::Identity(), {}, 2); });
  times.same_pixels = same(one, two);
  if (!options.reference) return times;
  mapping::RenderOptions everything;
  everything.occlusion_culling = false;
  times.all = best_time(1, [&] { all = scene.render(camera, Isometry3d::Identity(), everything, 2); });
  times.same_pixels = times.same_pixels && same(one, all);
  const InstanceRays rays(meshes, {poses.begin(), poses.begin() + count});
  times.tree_ms = 1e3 * rays.tree_seconds();
  cv::Mat depth;
  times.rays = best_time(std::min(options.repeats, 3), [&] { depth = rays.depth(camera); });
  times.different = different_pixels(one.depth, depth);
  return times;
}

RobotTimes time_robots(int count, const mapping::World& robot, const mapping::MeshSearch& meshes,
                       const SpeedOptions& options) {
  const mapping::PinholeCamera camera;
  Random random = Random(static_cast<uint64_t>(options.seed)).fork(2);
  mapping::RenderScene scene;
  Warnings warnings;
  for (int i = 0; i < count; ++i) {
    const Isometry3d pose = random_pose_in_view(camera, random);
    i == 0 ? scene.add(robot, meshes, pose, warnings) : scene.add_copy(0, pose);
  }
  if (!warnings.empty()) throw Error("a mesh of the robot cannot be read");
  std::vector<JointState> joints;
  for (int i = 0; i < count; ++i) joints.push_back(random_joints(robot, random));
  RobotTimes times;
  times.robots = count;
  times.update = best_time(options.repeats, [&] {
    for (int i = 0; i < count; ++i) scene.set_joints(static_cast<size_t>(i), joints[static_cast<size_t>(i)]);
  });
  times.draw = best_time(options.repeats, [&] { scene.render(camera, Isometry3d::Identity(), {}, 2); });
  return times;
}

std::vector<int> steps_to(int most, int steps) {
  std::vector<int> counts;
  for (int i = 1; i <= steps; ++i) counts.push_back(std::max(1, most * i / steps));
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  return counts;
}

}  // namespace

void SpeedOptions::declare(OptionTable& table) {
  table.integer("meshes", meshes, "", "Most meshes in view.", 1, 100000);
  table.integer("robots", robots, "", "Most robots in view.", 1, 1000);
  table.number("min_half_m", min_half_m, "m", "Least half length of a mesh along an axis.", 0.001, 10);
  table.number("max_half_m", max_half_m, "m", "Largest half length of a mesh along an axis.", 0.001, 10);
  table.integer("repeats", repeats, "", "Images of each kind; the best counts.", 1, 1000);
  table.integer("steps", steps, "", "Numbers of meshes and of robots that are tried.", 1, 100);
  table.flag("reference", reference, "Also without culling, and by Embree's rays.");
  table.integer("seed", seed, "", "Of meshes and poses.", 0, 1000000);
}

Speed measure_speed(const SpeedOptions& options, Progress& progress) {
  if (options.min_half_m > options.max_half_m)
    throw Error("the least size of a mesh is larger than the largest", {}, "--half-least-m, --half-most-m");
  Random random(static_cast<uint64_t>(options.seed));
  std::vector<mapping::TriangleMesh> meshes;
  for (int i = 0; i < std::min(kDistinctMeshes, options.meshes); ++i)
    meshes.push_back(random_body(options.min_half_m, options.max_half_m, random));
  std::vector<Isometry3d> poses;
  Random places = random.fork(1);
  for (int i = 0; i < options.meshes; ++i) poses.push_back(random_pose_in_view({}, places));
  Speed speed;
  const std::vector<int> counts = steps_to(options.meshes, options.steps);
  for (size_t i = 0; i < counts.size(); ++i) {
    progress.check(0.7 * static_cast<double>(i) / static_cast<double>(counts.size()),
                   fmt::format("{} meshes", counts[i]));
    speed.crowds.push_back(time_crowd(counts[i], meshes, poses, options));
  }
  const TemporaryFolder folder("loci-evaluate-robot");
  const mapping::World robot = random_robot(folder.path(), random);
  for (const int count : steps_to(options.robots, options.steps)) {
    progress.check(0.7 + 0.3 * count / options.robots, fmt::format("{} robots", count));
    speed.robots.push_back(time_robots(count, robot, {{}, folder.path()}, options));
  }
  return speed;
}

}  // namespace loci::apps::filter_evaluation
