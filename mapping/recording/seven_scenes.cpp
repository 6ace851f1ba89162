#include "mapping/recording/seven_scenes.h"

#include <fmt/format.h>

#include <map>

#include "mapping/base/files.h"
#include "mapping/recording/loci_layout.h"
#include "mapping/sensor/kinect.h"

namespace loci {
namespace {

namespace fs = std::filesystem;

/// The files of one frame, by the name they share ("frame-000012").
struct Parts {
  fs::path depth, color, pose;
};

std::map<std::string, Parts> find_parts(const fs::path& folder) {
  std::map<std::string, Parts> frames;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    if (file.ends_with(".depth.png"))
      frames[file.substr(0, file.size() - 10)].depth = entry.path();
    else if (const size_t at = file.rfind(".color."); at != std::string::npos)
      frames[file.substr(0, at)].color = entry.path();
    else if (file.ends_with(".pose.txt"))
      frames[file.substr(0, file.size() - 9)].pose = entry.path();
  }
  return frames;
}

/// A part must be there for all frames, or (depth excepted) for none.
void check_complete(const std::map<std::string, Parts>& frames, const fs::path& folder) {
  size_t depths = 0, colors = 0, poses = 0;
  for (const auto& [name, parts] : frames) {
    depths += parts.depth.empty() ? 0 : 1;
    colors += parts.color.empty() ? 0 : 1;
    poses += parts.pose.empty() ? 0 : 1;
  }
  for (const auto& [name, parts] : frames) {
    if (parts.depth.empty())
      throw Error(fmt::format("{} has a {} file and no depth ({} depth, {} colour files)", name,
                              parts.color.empty() ? "pose" : "colour", depths, colors),
                  {folder.string(), 0, {}}, "depth and colour do not belong together");
    if (colors > 0 && parts.color.empty())
      throw Error(fmt::format("{} has no colour picture ({} depth, {} colour files)", name, depths, colors),
                  {folder.string(), 0, {}}, "depth and colour do not belong together");
    if (poses > 0 && parts.pose.empty())
      throw Error(fmt::format("{} has no pose ({} frames, {} poses)", name, depths, poses),
                  {folder.string(), 0, {}}, "give a .pose.txt for every frame, or none");
  }
}

Isometry3d read_matrix(const fs::path& path) {
  const std::string text = read_file(path);
  Eigen::Matrix4d matrix;
  const char* at = text.c_str();
  for (int i = 0; i < 16; ++i) {
    char* end = nullptr;
    matrix(i / 4, i % 4) = std::strtod(at, &end);  // Reads "nan" too, which the pose check then names.
    if (end == at)
      throw Error(fmt::format("a pose is 16 numbers, this file has {}", i), {path.string(), 0, {}});
    at = end;
  }
  return pose_from_matrix(matrix, {path.string(), 0, {}});
}

/// A file beside the pictures or one folder above; empty when there is none.
fs::path beside_or_above(const fs::path& folder, const char* name) {
  const fs::path absolute = fs::absolute(folder).lexically_normal();
  const fs::path clean = absolute.has_filename() ? absolute : absolute.parent_path();
  for (const fs::path& place : {clean, clean.parent_path()})
    if (fs::is_regular_file(place / name)) return place / name;
  return {};
}

void read_cameras(const fs::path& path, FileRecordingContent& content) {
  const Config config = Config::read(path);
  const Config depth = config.map("depth");
  content.info.camera.depth = read_pinhole(depth);
  content.depth_scale = depth.get<double>("unit_m", 0.001);
  content.invalid_depth = depth.get<std::vector<int>>("invalid", {0, 65535});
  for (const int raw : content.invalid_depth)
    if (raw < 0 || raw > 65535) throw Error("depth values are 0 to 65535", depth.place("invalid"));
  depth.finish();
  const Config color = config.map("color");
  content.info.camera.color = config.has("color") ? read_pinhole(color) : content.info.camera.depth;
  color.finish();
  if (config.has("color_from_depth")) {
    const Config transform = config.map("color_from_depth");
    const auto r = transform.require<std::array<double, 9>>("R");
    const auto t = transform.require<std::array<double, 3>>("t");
    transform.finish();
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = r[static_cast<size_t>(i)];
    for (int i = 0; i < 3; ++i) matrix(i, 3) = t[static_cast<size_t>(i)];
    content.info.camera.depth_from_color =
        pose_from_matrix(matrix, config.place("color_from_depth")).inverse();
  }
  config.finish();
}

}  // namespace

bool is_seven_scenes(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename().string().ends_with(".depth.png")) return true;
  return false;
}

FileRecordingContent read_seven_scenes(const fs::path& folder) {
  FileRecordingContent content;
  content.info.format = "7-scenes";
  content.info.path = folder.string();
  content.info.time_assumed = true;
  content.info.guesses.emplace_back(
      "no time stamps: 30 Hz from 2000-01-01T00:00:00Z by the number in the name");
  content.invalid_depth = {0, 65535};

  const auto frames = find_parts(folder);
  check_complete(frames, folder);
  if (const fs::path cameras = beside_or_above(folder, "cameras.yaml"); !cameras.empty()) {
    read_cameras(cameras, content);
  } else {
    content.info.camera = kinect_camera();
    content.info.guesses.emplace_back("no cameras.yaml: the cameras of a Kinect v1 are assumed");
  }
  Isometry3d map_from_world = Isometry3d::Identity();
  content.info.map_frame = "world";
  if (const fs::path transform = beside_or_above(folder, "world_to_map.txt"); !transform.empty()) {
    map_from_world = read_matrix(transform);
    content.info.map_frame = "map";
  } else {
    content.info.guesses.emplace_back("no world_to_map.txt: the map frame is the world frame of the poses");
  }
  for (const auto& [name, parts] : frames) {
    FrameFiles frame;
    frame.index = static_cast<int64_t>(content.frames.size());
    frame.depth = parts.depth;
    frame.color = parts.color;
    frame.place = {parts.depth.string(), 0, {}};
    frame.time_ns = assumed_time(number_in_name(parts.depth).value_or(frame.index));
    if (!parts.pose.empty()) frame.map_from_camera = map_from_world * read_matrix(parts.pose);
    content.frames.push_back(std::move(frame));
  }
  return content;
}

}  // namespace loci
