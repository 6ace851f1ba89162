#include "apps/evaluate/mapping/mapper.h"

#include <sys/resource.h>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/interpretation/front_links.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"

namespace loci::mapping_claim {
namespace {

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

ScannedWorldOptions world_of(const Run& run) {
  ScannedWorldOptions options;
  options.package_paths = run.package_paths;
  options.ceiling = run.ceiling;
  options.laser = run.survey.exploration.laser;
  options.seed = run.seed;
  options.threads = run.threads;
  return options;
}

/// Scans from known poses: what interpretation makes of them is not blamed on exploration or registration.
ScanSet scan_from(const Run& run, Progress& progress, Warnings& warnings) {
  ScannedWorldOptions options = world_of(run);
  options.odometry = OdometryModel{0, 0, 0};
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

SurveyResult survey_from_poses(const Run& run, Progress& progress, Warnings& warnings) {
  SurveyResult result;
  result.scans = scan_from(run, progress, warnings);
  InterpretationOptions options = run.survey.interpretation;
  options.threads = run.threads;
  const Stopwatch watch;
  result.map = interpret(result.scans, options, progress);
  result.seconds = watch.seconds();
  make_folder(run.folder);
  write_urdf(result.map.world, run.folder / "map.urdf");
  write_semantic_map(result.map.semantics, sidecar_path(run.folder / "map.urdf"));
  return result;
}

SurveyResult survey_by_exploring(const Run& run, Progress& progress, Warnings& warnings) {
  ScannedWorld robot(run.world, world_of(run), {}, warnings);
  const PlanarPose start = run.start ? *run.start : robot.open_place();
  robot.put_at(start);
  SurveyOptions options = run.survey;
  options.exploration.seed = run.seed;
  options.exploration.threads = run.threads;
  return survey(robot, start, run.folder, false, options, progress, warnings);
}

MeshSearch search_of(const Run& run, const std::filesystem::path& file) {
  return {run.package_paths, file.parent_path()};
}

}  // namespace

MappedWorld map_world(const Run& run, Progress& progress, Warnings& warnings) {
  MappedWorld mapped;
  mapped.world = run.world;
  mapped.seed = run.seed;
  SurveyResult made = run.poses.empty() ? survey_by_exploring(run, progress, warnings)
                                        : survey_from_poses(run, progress, warnings);
  mapped.seconds = made.seconds;
  mapped.scans = made.scans.scans.size();
  mapped.pulls = made.interactions.size();
  mapped.memory_mb = peak_memory_mb();
  const MapStructure truth = read_structure(run.truth, search_of(run, run.truth), warnings);
  const auto compared = [&] {
    return compare(structure_from_sidecar(made.map.semantics, made.map.world, run.world.string()), truth,
                   run.comparison);
  };
  if (!made.interactions.empty()) {
    mapped.after = compared();
    replace_fronts(made.fronts_before, made.map);
  }
  mapped.before = compared();
  return mapped;
}

}  // namespace loci::mapping_claim
