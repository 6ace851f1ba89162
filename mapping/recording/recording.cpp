#include "mapping/recording/recording.h"

#include <fmt/format.h>

#include "mapping/base/json.h"
#include "mapping/recording/bag_recording.h"
#include "mapping/recording/layouts.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

Json to_json(const PinholeCamera& camera) {
  return {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy}};
}

/// A folder or bag below that could have been meant, for the hint.
std::string recording_below(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    const bool fits = entry.is_directory() ? fs::exists(path / "recording.yaml") || is_seven_scenes(path) ||
                                                 is_tum(path) || is_pcd_series(path)
                                           : path.extension() == ".bag" && is_ros_bag(path);
    if (fits) return path.string();
  }
  return {};
}

Error nothing_fits(const fs::path& folder) {
  const std::string below = recording_below(folder);
  return Error(fs::is_empty(folder) ? "the folder is empty" : "the folder holds no recording",
               {folder.string(), 0, {}},
               below.empty() ? "a recording has recording.yaml and frames.csv, *.depth.png as in 7-Scenes, "
                               "depth.txt and rgb.txt as TUM's, or *.pcd"
                             : fmt::format("did you mean '{}'?", below));
}

}  // namespace

Json to_json(const RecordingInfo& info) {
  Json json;
  json["format"] = info.format;
  json["path"] = info.path;
  json["frames"] = info.frames;
  json["frames_with_pose"] = info.frames_with_pose;
  json["map_frame"] = info.map_frame.empty() ? Json(nullptr) : Json(info.map_frame);
  json["first_time"] = format_time(info.first_time);
  json["last_time"] = format_time(info.last_time);
  json["time_assumed"] = info.time_assumed;
  json["cameras"]["depth"] = to_json(info.camera.depth);
  json["cameras"]["color"] = to_json(info.camera.color);
  json["cameras"]["color"]["depth_from_color"] = values_from_pose(info.camera.depth_from_color);
  json["guesses"] = info.guesses;
  json["problems"] = info.problems;
  return json;
}

std::unique_ptr<Recording> open_recording(const fs::path& path) {
  if (!fs::exists(path)) throw Error("no such recording", {path.string(), 0, {}});
  const fs::path folder = path.filename() == "recording.yaml"
                              ? (path.has_parent_path() ? path.parent_path() : fs::path("."))
                              : path;
  if (!fs::is_directory(folder)) {
    if (is_ros_bag(folder) || folder.extension() == ".bag") return std::make_unique<BagRecording>(folder);
    if (is_pcd_series(folder)) return std::make_unique<PcdSeries>(folder);
    throw Error("this file is no recording", {path.string(), 0, {}},
                "a recording is a folder, a ROS 1 bag or an organised PCD");
  }
  if (fs::exists(folder / "recording.yaml")) return std::make_unique<FileRecording>(read_loci_layout(folder));
  if (is_seven_scenes(folder)) return std::make_unique<FileRecording>(read_seven_scenes(folder));
  if (is_tum(folder)) return std::make_unique<FileRecording>(read_tum(folder));
  if (is_pcd_series(folder)) return std::make_unique<PcdSeries>(folder);
  throw nothing_fits(folder);
}

}  // namespace loci::mapping
