#include "apps/evaluate/filter/crowd.h"

#include <fmt/format.h>

#include <cmath>

#include "mapping/base/files.h"
#include "mapping/base/math.h"

namespace loci::apps::filter_evaluation {
namespace {

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

}  // namespace

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

Isometry3d random_pose_in_view(const mapping::PinholeCamera& camera, Random& random) {
  const double z = random.uniform(1, 6);
  const double u = random.uniform(0, camera.width), v = random.uniform(0, camera.height);
  const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = turn.normalized().toRotationMatrix();
  pose.translation() = camera.unproject(u, v, z);
  return pose;
}

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

JointState random_joints(const mapping::World& robot, Random& random) {
  JointState joints;
  for (const mapping::Joint& joint : robot.joints) joints[joint.name] = random.uniform(-0.6, 0.6);
  return joints;
}

}  // namespace loci::apps::filter_evaluation
