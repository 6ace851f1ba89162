#include "apps/evaluate/mapping/mapper.h"

#include <sys/resource.h>

#include <chrono>

#include "mapping/articulation/articulation.h"

namespace loci::mapping_claim {
namespace {

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Scans from known poses: what interpretation makes of them is not blamed on exploration or registration.
ScanSet scan_from(const Run& run, Progress& progress, Warnings& warnings) {
  ScannedWorldOptions options;
  options.package_paths = run.package_paths;
  options.ceiling = run.ceiling;
  options.odometry = OdometryModel{0, 0, 0};
  options.seed = run.seed;
  options.threads = run.threads;
  ScannedWorld robot(run.world, options, run.poses.front(), warnings);
  ScanSet scans;
  scans.sensor = "hokuyo";
  scans.range_max = options.laser.range_max_m;
  for (const PlanarPose& pose : run.poses) {
    progress.check(static_cast<double>(scans.scans.size()) / static_cast<double>(run.poses.size()),
                   "scanning " + run.world.string());
    scans.scans.push_back(robot.scan_at(pose));
  }
  return scans;
}

MeshSearch search_of(const Run& run, const std::filesystem::path& file) {
  return {run.package_paths, file.parent_path()};
}

}  // namespace

MapStructure with_prior_joints(MapStructure map) {
  for (KnownFront& known : map.fronts) known.front.joint = joint_prior(known.front);
  return map;
}

MappedWorld map_world(const Run& run, Progress& progress, Warnings& warnings) {
  MappedWorld mapped;
  mapped.world = run.world;
  mapped.seed = run.seed;
  const ScanSet scans = scan_from(run, progress, warnings);
  InterpretationOptions interpretation = run.interpretation;
  interpretation.threads = run.threads;
  const auto begin = std::chrono::steady_clock::now();
  const InterpretedMap map = interpret(scans, interpretation, progress);
  mapped.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  mapped.scans = scans.scans.size();
  mapped.memory_mb = peak_memory_mb();
  const MapStructure found = structure_from_sidecar(map.semantics, map.world, run.world.string());
  const MapStructure truth = read_structure(run.truth, search_of(run, run.truth), warnings);
  mapped.comparison = compare(found, truth, run.comparison);
  mapped.before = compare(with_prior_joints(found), truth, run.comparison);
  return mapped;
}

}  // namespace loci::mapping_claim
