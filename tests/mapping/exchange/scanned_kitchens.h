#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/simulation/simulated_robot.h"
#include "mapping/world/furniture.h"
#include "tests/mapping/exchange/furnished_map.h"

namespace loci::mapping::test {

/// A kitchen scanned by a simulated laser from known poses, and interpreted.
inline InterpretedMap scanned(const std::filesystem::path& urdf, const std::vector<PlanarPose>& poses,
                              const std::vector<std::filesystem::path>& packages = {}) {
  Warnings warnings;
  NoProgress progress;
  SimulatedRobotOptions options;
  options.package_paths = packages;
  options.odometry = OdometryModel{0, 0, 0};
  SimulatedRobot robot(urdf, options, poses.front(), warnings);
  ScanSet scans;
  scans.sensor = "hokuyo";
  scans.range_max = options.laser.range_max_m;
  for (const PlanarPose& pose : poses) scans.scans.push_back(robot.scan_at(pose));
  return interpret(scans, {}, progress);
}

inline InterpretedMap scanned_sample_kitchen() {
  const std::filesystem::path samples = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples";
  return scanned(samples / "kitchen.urdf", {{1.14, 1.34, 0},
                                            {3.35, 1.85, -135 * kDegree},
                                            {3.6, 1.35, 135 * kDegree},
                                            {0.9, 1.85, -135 * kDegree},
                                            {2.9, 1.75, 90 * kDegree}});
}

/// Of the shared data; unset without it.
inline std::optional<InterpretedMap> scanned_laboratory_kitchen() {
  const std::filesystem::path kitchens = std::filesystem::path(LOCI_SHARED_DIR) / "data/kitchens";
  const std::filesystem::path urdf = kitchens / "tum_kitchen/tum_kitchen.urdf";
  if (!std::filesystem::exists(urdf)) return std::nullopt;
  return scanned(urdf,
                 {{-3.77, -6.43, 0},
                  {-3.75, -4.15, 0},
                  {-2.35, -2.8, 0},
                  {-3.3, -4.9, -135 * kDegree},
                  {-0.25, -4.7, -90 * kDegree},
                  {0.15, -6.65, -135 * kDegree},
                  {-1.75, -4.06, -90 * kDegree},
                  {-3.15, -3.5, 90 * kDegree}},
                 {kitchens});
}

/// Fronts as they come out of scans: a few millimetres too large, in the slab above them and in each other,
/// two rows that meet in a corner, a wall beside a door.
inline FurnishedMap tight_furniture() {
  FurnishedMap map;
  for (const char* name : {"drawer_1", "door_1", "front_1"}) remove_front(name, map.world, map.semantics);
  add_link(map.world, "wall_east", "wall", "map", Isometry3d(Eigen::Translation3d(1.225, 0, 1)),
           {box_part({0, 0, 0}, {0.05, 4, 2})});
  map.semantics.links["wall_east"].class_name = "wall";
  std::vector<Front> fronts;
  const auto add = [&](const char* name, const Vector3d& centre, const Vector3d& normal, double width,
                       double height, double hinge) {
    Front front = FurnishedMap::front(name, centre, height);
    front.normal = normal;
    front.width = width;
    front.fixture->centre = centre + 0.035 * normal + Vector3d(0, 0, height / 2 - 0.003);
    front.fixture->axis = front.right();
    front.joint = JointEstimate{};
    front.joint->type = hinge == 0 ? ArticulationType::prismatic : ArticulationType::revolute;
    front.joint->axis = hinge == 0 ? normal : Vector3d(0, 0, hinge);
    front.joint->origin = centre + hinge * width / 2 * front.right() - 0.01 * normal;
    fronts.push_back(front);
  };
  const Vector3d south(0, -1, 0), east(1, 0, 0);
  add("drawer_1", {-0.3, 1.4, 0.763}, south, 0.604, 0.2, 0);  // 3 mm into the slab
  add("drawer_2", {0.3, 1.4, 0.762}, south, 0.604, 0.2, 0);
  add("door_1", {-0.3, 1.4, 0.36}, south, 0.602, 0.61, 1);  // 2 mm into the drawers above
  add("door_2", {0.3, 1.4, 0.36}, south, 0.602, 0.61, 1);
  add("door_3", {0.9, 1.4, 0.45}, south, 0.603, 0.86, -1);    // touches the wall and the slab
  add("drawer_3", {-0.6, 1.08, 0.76}, east, 0.65, 0.201, 0);  // around the corner, 5 mm into drawer_1
  add_fronts(fronts, "map", map.world, map.semantics);
  return map;
}

}  // namespace loci::mapping::test
