#include "mapping/recording/recording.h"

#include <fmt/format.h>

#include "mapping/base/math/pose.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/formats/layouts.h"
#include "mapping/recording/formats/scannet.h"
#include "mapping/recording/gravity.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/recording/ros/ros_recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

Json to_json(const PinholeCamera& camera) {
  return {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy}};
}

/// Whether a path looks like a recording, for the hint.
bool is_recording(const fs::path& path) {
  if (!fs::is_directory(path)) return is_ros1_bag(path) || is_ros2_bag(path) || is_sens(path);
  return fs::exists(path / "recording.yaml") || is_seven_scenes(path) || is_tum(path) ||
         is_pcd_series(path) || is_ros2_bag(path) || is_nerfstudio(path) || is_stray_scanner(path) ||
         is_replica(path) || is_redwood(path);
}

/// A folder or file below that could have been meant, for the hint.
std::string recording_below(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_recording(entry.path())) return entry.path().string();
  return {};
}

/// Files that would be read in another form: Error that says in which.
void refuse_unread_files(const fs::path& folder) {
  const fs::path depth = folder / "depth";
  if (!fs::is_directory(depth)) return;
  for (const auto& entry : fs::directory_iterator(depth))
    for (const char* ending : {".pfm", ".pgm", ".npz", ".mat", ".h5", ".hdf5", ".raw", ".bin"})
      if (lower_case(entry.path().extension().string()) == ending)
        throw Error(fmt::format("depth as {} is not read", ending), {entry.path().string(), 0, {}},
                    "write it in metres, e.g. in Python: numpy.save(\"NAME.npy\", depth.astype(\"<f4\"))");
}

Error nothing_fits(const fs::path& folder) {
  const std::string below = recording_below(folder);
  if (below.empty())
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_regular_file()) refuse_foreign_format(entry.path());
  return Error(fs::is_empty(folder) ? "the folder is empty" : "the folder holds no recording",
               {folder.string(), 0, {}},
               below.empty() ? "a recording has recording.yaml, *.depth.* as in 7-Scenes, depth.txt as "
                               "TUM's, *.mcap or *.db3, color/ "
                               "and depth/, transforms.json, or *.pcd"
                             : fmt::format("did you mean '{}'?", below));
}

/// The reader of the format.
std::unique_ptr<Recording> open_format(const fs::path& path, const RecordingOptions& options,
                                       Progress* progress) {
  const fs::path folder = path.filename() == "recording.yaml"
                              ? (path.has_parent_path() ? path.parent_path() : fs::path("."))
                              : path;
  if (!fs::is_directory(folder)) {
    if (is_ros1_bag(folder) || folder.extension() == ".bag" || is_ros2_bag(folder))
      return std::make_unique<RosRecording>(folder, options, progress);
    if (is_pcd_series(folder)) return std::make_unique<PcdSeries>(folder);
    if (is_sens(folder)) return std::make_unique<SensRecording>(folder);
    if (fs::is_empty(folder)) throw Error("the file is empty", {path.string(), 0, {}});
    refuse_foreign_format(folder);
    throw Error("this file is no recording", {path.string(), 0, {}},
                "a recording is a folder, a bag of ROS, a .sens file or an organised PCD");
  }
  if (fs::exists(folder / "recording.yaml")) return std::make_unique<FileRecording>(read_loci_layout(folder));
  if (is_seven_scenes(folder)) return std::make_unique<FileRecording>(read_seven_scenes(folder));
  if (is_tum(folder)) return std::make_unique<FileRecording>(read_tum(folder, options.color_delay_s));
  if (is_ros2_bag(folder)) return std::make_unique<RosRecording>(folder, options, progress);
  if (is_pcd_series(folder)) return std::make_unique<PcdSeries>(folder);
  if (is_nerfstudio(folder)) return std::make_unique<FileRecording>(read_nerfstudio(folder));
  if (is_stray_scanner(folder)) return std::make_unique<FileRecording>(read_stray_scanner(folder));
  if (is_replica(folder)) return std::make_unique<FileRecording>(read_replica(folder));
  if (is_redwood(folder)) return std::make_unique<FileRecording>(read_redwood(folder));
  refuse_unread_files(folder);
  throw nothing_fits(folder);
}

Isometry3d required_pose(const fs::path& file) {
  const std::optional<Isometry3d> pose = read_pose_file(file);
  if (!pose) throw Error("the pose has a value that is not a finite number", {file.string(), 0, {}});
  return *pose;
}

/// A recording whose poses have z up as far as that is known: by world_to_map.txt, by --up, or by what is
/// seen.
std::unique_ptr<Recording> levelled(std::unique_ptr<Recording> recording, const fs::path& path,
                                    const RecordingOptions& options) {
  constexpr double kLevelEnough = 0.94;  // 20 degrees: the rest is left to the floor of the map.
  const bool automatic = options.up == "auto", keep = options.up == "keep";
  const Vector3d given = automatic || keep ? Vector3d::UnitZ() : parse_direction(options.up);
  if (recording->info().frames_with_pose == 0) {
    if (!automatic && !keep) return with_up(std::move(recording), given);
    return recording;
  }
  const fs::path transform =
      beside_or_above(fs::is_directory(path) ? path : fs::absolute(path).parent_path(), "world_to_map.txt");
  if (recording->info().map_frame != "map" && options.poses.empty() && !transform.empty())
    return in_frame(std::move(recording), required_pose(transform), "map",
                    fmt::format("poses were moved to the map by {}", transform.string()));
  if (keep || (automatic && recording->info().levelled)) return recording;
  const std::optional<Vector3d> up = automatic ? find_up(*recording) : std::optional(given);
  const std::string frame = recording->info().map_frame;
  if (!up)
    return in_frame(std::move(recording), Isometry3d::Identity(), frame,
                    "which way is up is not known: z of the poses is taken (choose with --up)");
  if (automatic && up->z() > kLevelEnough) return recording;
  return turned_upright(
      std::move(recording), *up, frame,
      fmt::format("the poses were turned upright: up was {:.2f} {:.2f} {:.2f}", up->x(), up->y(), up->z()));
}

}  // namespace

Json to_json(const RecordingInfo& info) {
  Json json;
  json["format"] = info.format;
  json["path"] = info.path;
  json["frames"] = info.frames;
  json["frames_with_pose"] = info.frames_with_pose;
  json["map_frame"] = info.map_frame.empty() ? Json(nullptr) : Json(info.map_frame);
  json["levelled"] = info.levelled;
  json["depth_unit_m"] = info.depth_unit_m;
  if (info.up_in_camera)
    json["up_in_camera"] = {info.up_in_camera->x(), info.up_in_camera->y(), info.up_in_camera->z()};
  json["first_time"] = format_time(info.first_time);
  json["last_time"] = format_time(info.last_time);
  json["time_assumed"] = info.time_assumed;
  if (!info.time_zone.empty()) json["time_zone"] = info.time_zone;
  if (!info.camera_names.empty()) json["camera_names"] = info.camera_names;
  json["cameras"]["depth"] = to_json(info.camera.depth);
  json["cameras"]["color"] = to_json(info.camera.color);
  json["cameras"]["color"]["depth_from_color"] = values_from_pose(info.camera.depth_from_color);
  json["guesses"] = info.guesses;
  json["problems"] = info.problems;
  return json;
}

void RecordingOptions::declare(OptionTable& table) {
  table.text("camera", camera,
             "Of a bag with several cameras: the name of one, as `info` lists them; empty takes the one with "
             "the most images.");
  table.text("topics", topics,
             "Of a bag: the topic of depth images, and with a comma that of colour images; empty chooses.");
  table.text("poses", poses,
             "File with the poses of the frames: TUM, KITTI, g2o, COLMAP's images.txt, trajectory.log.");
  table.text(
      "up", up,
      "What is up in the frame of the poses, or without poses in the first image: x, y, z, -x, -y, -z or "
      "three numbers; auto finds out where the format does not say, keep takes z.");
  table.number("color_delay_s", color_delay_s, "s", "How much later colour is stamped than depth.", -10, 10);
  table.number("seconds_apart", seconds_apart, "s",
               "Time between the frames of a recording without time stamps; 0 takes the usual rate.", 0, 1e6);
  table.text(
      "start", start,
      "Time of the first frame of a recording without time stamps, ISO 8601: 2026-05-01T08:30:00Z; empty "
      "takes 2000-01-01.");
}

std::unique_ptr<Recording> open_recording(const fs::path& path, const RecordingOptions& options,
                                          Progress* progress) {
  RecordingOptions checked = options;
  table_of(checked).validate({path.string(), 0, "recording"});
  if (!fs::exists(path)) throw Error("no such recording", {path.string(), 0, {}});
  std::unique_ptr<Recording> recording = open_format(path, options, progress);
  if (!options.camera.empty() && recording->info().camera_names.empty())
    throw Error(
        fmt::format("a recording of layout {} has one camera without a name", recording->info().format),
        {path.string(), 0, "--camera"});
  if (options.seconds_apart > 0) recording = seconds_apart(std::move(recording), options.seconds_apart);
  if (!options.start.empty()) recording = started_at(std::move(recording), parse_time(options.start));
  if (!options.poses.empty()) {
    auto poses = read_poses_for(*recording, options.poses);
    recording = with_poses(std::move(recording), std::move(poses), "world", false);
  }
  return levelled(std::move(recording), path, options);
}

}  // namespace loci::mapping
