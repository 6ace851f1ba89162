#include "apps/evaluate/filter/speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "apps/evaluate/filter/crowd.h"
#include "apps/evaluate/filter/rays.h"
#include "apps/evaluate/temporary_folder.h"
#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/render/render.h"

namespace loci::apps::filter_evaluation {
namespace {

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Time best_time(int repeats, const std::function<void()>& work) {
  Time best;
  for (int i = 0; i < repeats; ++i) {
    const double begin = processor_seconds();
    const Stopwatch watch;
    work();
    const double clock = 1e3 * watch.seconds(), processor = 1e3 * (processor_seconds() - begin);
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
  const TemporaryFolder folder("robot");
  const mapping::World robot = random_robot(folder.path(), random);
  for (const int count : steps_to(options.robots, options.steps)) {
    progress.check(0.7 + 0.3 * count / options.robots, fmt::format("{} robots", count));
    speed.robots.push_back(time_robots(count, robot, {{}, folder.path()}, options));
  }
  return speed;
}

}  // namespace loci::apps::filter_evaluation
