#include "apps/evaluate/mapping/mapper.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/fusion/fusion.h"
#include "mapping/image/image_io.h"
#include "mapping/interpretation/furniture/map_links.h"
#include "mapping/orthophoto/photo_interpretation.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/simulation/walk.h"
#include "mapping/tracking/tracking.h"
#include "mapping/world/contacts.h"
#include "mapping/world/map_files.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"

namespace loci::apps::mapping_claim {
namespace {

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

mapping::MeshSearch search_of(const Run& run, const std::filesystem::path& file) {
  return {run.package_paths, file.parent_path()};
}

mapping::SimulatedRobotOptions world_of(const Run& run) {
  mapping::SimulatedRobotOptions options;
  options.package_paths = run.package_paths;
  options.floor = run.floor;
  options.ceiling = run.ceiling;
  options.laser = run.survey.exploration.laser;
  options.seed = run.seed;
  options.threads = run.threads;
  return options;
}

/// Scans from known poses: what interpretation makes of them is not blamed on exploration or registration.
mapping::ScanSet scan_from(const Run& run, Progress& progress, Warnings& warnings) {
  mapping::SimulatedRobotOptions options = world_of(run);
  options.odometry = mapping::OdometryModel{0, 0, 0};
  mapping::SimulatedRobot robot(run.world, options, run.poses.front(), warnings);
  mapping::ScanSet scans;
  scans.sensor = mapping::kLaserSensor;
  scans.range_max = options.laser.range_max_m;
  for (const mapping::PlanarPose& pose : run.poses) {
    progress.check(static_cast<double>(scans.scans.size()) / static_cast<double>(run.poses.size()),
                   "scanning " + run.world.string());
    scans.scans.push_back(robot.scan_at(pose));
  }
  return scans;
}

void write_map(const Run& run, const nbv::SurveyResult& result) {
  make_folder(run.folder);
  mapping::write_map(result.map.world, result.map.semantics, run.folder / "map.urdf");
}

nbv::SurveyResult survey_from_poses(const Run& run, Progress& progress, Warnings& warnings) {
  nbv::SurveyResult result;
  result.scans = scan_from(run, progress, warnings);
  mapping::InterpretationOptions options = run.survey.interpretation;
  options.threads = run.threads;
  const Stopwatch watch;
  result.map = interpret(result.scans, options, progress);
  result.seconds = watch.seconds();
  if (run.floor.value_or(0) != 0)
    result.map.semantics.map_from_input = Isometry3d(Eigen::Translation3d(0, 0, -*run.floor));
  write_map(run, result);
  return result;
}

/// Records a walk through the world; the folder of the recording. A camera that is to be tracked is carried
/// at 30 Hz.
std::filesystem::path recorded_walk(const Run& run, Progress& progress, Warnings& warnings) {
  const auto places =
      mapping::standing_places(mapping::read_urdf(run.world), search_of(run, run.world), warnings);
  mapping::RecordOptions options;
  options.seed = static_cast<int>(run.seed);
  options.threads = run.threads;
  options.package_paths = run.package_paths;
  std::filesystem::path folder = run.folder / "recording";
  make_folder(run.folder);
  Random random(run.seed);
  record_views(run.world, run.track ? mapping::stroll(places, random) : mapping::views_from(places),
               run.track ? kSecond / 30 : kSecond, folder, options, progress, warnings);
  return folder;
}

/// From the frame of tracked poses to that of the true ones, in mean: a turn about the vertical and a shift.
/// What tracking has tilted stays tilted.
Isometry3d truth_from_tracked(const mapping::Recording& truth, const mapping::Recording& tracked) {
  constexpr size_t kFrames = 200;  // Enough for a mean: reading a pose reads images, too.
  double sine = 0, cosine = 0, count = 0;
  Vector3d true_sum = Vector3d::Zero(), tracked_sum = Vector3d::Zero();
  for (size_t i = 0; i < truth.size(); i += std::max<size_t>(1, truth.size() / kFrames)) {
    const auto from = tracked.pose_of(i), to = truth.pose_of(i);
    if (!from || !to) continue;
    const Eigen::Matrix3d turn = to->linear() * from->linear().transpose();
    sine += turn(1, 0) - turn(0, 1);
    cosine += turn(0, 0) + turn(1, 1);
    true_sum += to->translation();
    tracked_sum += from->translation();
    ++count;
  }
  if (count == 0) throw Error("no frame has both a true and a tracked pose", {truth.info().path, 0, {}});
  Isometry3d result(Eigen::AngleAxisd(std::atan2(sine, cosine), Vector3d::UnitZ()));
  result.translation() = (true_sum - result.linear() * tracked_sum) / count;
  return result;
}

/// The recording; with tracked poses where they are asked for.
std::unique_ptr<mapping::Recording> opened(const Run& run, const std::filesystem::path& folder,
                                           Progress& progress, Warnings& warnings) {
  auto recording = mapping::open_recording(folder);
  if (!run.track) return recording;
  mapping::TrackingOptions options;
  options.threads = run.threads;
  const mapping::TrackingResult result = track(*recording, options, progress);
  require_usable(result, folder.string());
  auto tracked = with_tracked_poses(mapping::open_recording(folder), result, false, warnings);
  const Isometry3d moved = truth_from_tracked(*recording, *tracked);
  return in_frame(std::move(tracked), moved, "map");
}

/// The map of a recording: fused, interpreted, with fronts from its colour frames.
nbv::SurveyResult map_of_recording(const Run& run, const std::filesystem::path& folder, Progress& progress,
                                   Warnings& warnings) {
  nbv::SurveyResult result;
  const auto recording = opened(run, folder, progress, warnings);
  mapping::FusionOptions fusion;
  fusion.threads = run.threads;
  mapping::InterpretationOptions options = run.survey.interpretation;
  options.threads = run.threads;
  const Stopwatch watch;
  result.scans = fuse(*recording, fusion, progress).scans;
  result.map = interpret(result.scans, options, progress);
  const auto faces = interpret_photos(*recording, run.threads, progress, result.map);
  result.seconds = watch.seconds();
  write_map(run, result);
  for (size_t i = 0; i < faces.size(); ++i)
    mapping::write_image(run.folder / fmt::format("face_{:02}.png", i), drawn(faces[i]));
  return result;
}

nbv::SurveyResult survey_by_exploring(const Run& run, Progress& progress, Warnings& warnings) {
  mapping::SimulatedRobot robot(run.world, world_of(run), {}, warnings);
  const mapping::PlanarPose start = run.start ? *run.start : robot.open_place();
  robot.put_at(start);
  nbv::SurveyOptions options = run.survey;
  options.exploration.seed = run.seed;
  options.exploration.threads = run.threads;
  if (run.floor.value_or(0) != 0) options.map_from_input = robot.map_from_world();
  return survey(robot, start, run.folder, false, options, progress, warnings);
}

/// A surface that is nearly level with the sensor shows no points from which it could be measured.
constexpr double kMinOverTop = 0.05;

/// Height of supports whose tops some pose of the sensor could show: as far up as the robot can move it, even
/// if it did not, or as it was carried.
double observable_height(const Run& run, const nbv::SurveyResult& made) {
  double highest = 0;
  for (const mapping::Scan& scan : made.scans.scans)
    highest = std::max(highest, scan.map_from_scan.translation().z());
  const nbv::ExplorationOptions& exploration = run.survey.exploration;
  const bool explored = run.poses.empty() && !run.walk && !std::filesystem::is_directory(run.world);
  if (explored)
    for (const double height : nbv::scanner_heights(exploration.height, exploration.laser.height_m))
      highest = std::max(highest, height);
  return highest - kMinOverTop;
}

}  // namespace

MappedWorld map_world(const Run& run, Progress& progress, Warnings& warnings) {
  MappedWorld mapped;
  mapped.world = run.world;
  mapped.seed = run.seed;
  nbv::SurveyResult made =
      std::filesystem::is_directory(run.world) ? map_of_recording(run, run.world, progress, warnings)
      : run.walk          ? map_of_recording(run, recorded_walk(run, progress, warnings), progress, warnings)
      : run.poses.empty() ? survey_by_exploring(run, progress, warnings)
                          : survey_from_poses(run, progress, warnings);
  mapped.seconds = made.seconds;
  mapped.scans = made.scans.scans.size();
  mapped.pulls = made.interactions.size();
  mapped.memory_mb = peak_memory_mb();
  mapped.contacts = mapping::closed_contacts(made.map.world).size();
  for (const mapping::Joint& joint : made.map.world.joints)
    if (joint.limits && !mapping::free_range(made.map.world, joint).blocker.empty()) ++mapped.jammed;
  const mapping::MapStructure truth =
      read_structure(run.truth, search_of(run, run.truth), warnings, made.map.semantics.map_from_input);
  mapping::ComparisonOptions comparison = run.comparison;
  comparison.observable_height_m = std::min(comparison.observable_height_m, observable_height(run, made));
  const auto compared = [&] {
    return compare(structure_from_sidecar(made.map.semantics, made.map.world, run.world.string()), truth,
                   comparison);
  };
  if (!made.interactions.empty()) {
    mapped.after = compared();
    replace_fronts(made.fronts_before, made.map);
  }
  mapped.before = compared();
  return mapped;
}

}  // namespace loci::apps::mapping_claim
