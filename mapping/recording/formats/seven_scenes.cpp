#include "mapping/recording/formats/layouts.h"

#include <fmt/format.h>

#include <map>

#include "mapping/recording/depth_image.h"
#include "mapping/sensor/kinect.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

/// The files of one frame, by the name they share ("frame-000012").
struct Parts {
  fs::path depth, color, pose;
};

/// "frame-000012" of "frame-000012.depth.png" or of another kind of depth; empty for other files.
std::string frame_of_depth(const fs::path& file) {
  const std::string name = file.stem().string();
  return depth_ending_of(file) < kDepthEndings.size() && name.ends_with(".depth")
             ? name.substr(0, name.size() - 6)
             : std::string();
}

std::map<std::string, Parts> find_parts(const fs::path& folder) {
  std::map<std::string, Parts> frames;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    if (const std::string frame = frame_of_depth(entry.path()); !frame.empty()) {
      fs::path& depth = frames[frame].depth;
      if (depth.empty() || depth_ending_of(entry.path()) < depth_ending_of(depth)) depth = entry.path();
    } else if (const size_t at = file.rfind(".color."); at != std::string::npos) {
      frames[file.substr(0, at)].color = entry.path();
    } else if (file.ends_with(".pose.txt")) {
      frames[file.substr(0, file.size() - 9)].pose = entry.path();
    }
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
      throw Error(fmt::format("{} has no colour image ({} depth, {} colour files)", name, depths, colors),
                  {folder.string(), 0, {}}, "depth and colour do not belong together");
    if (poses > 0 && parts.pose.empty())
      throw Error(fmt::format("{} has no pose ({} frames, {} poses)", name, depths, poses),
                  {folder.string(), 0, {}}, "give a .pose.txt for every frame, or none");
  }
}

}  // namespace

bool is_seven_scenes(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (!frame_of_depth(entry.path()).empty()) return true;
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
  content.info.map_frame = "world";
  content.info.levelled = false;
  for (const auto& [name, parts] : frames) {
    FrameFiles frame;
    frame.index = static_cast<int64_t>(content.frames.size());
    frame.depth = parts.depth;
    frame.color = parts.color;
    frame.location = {parts.depth.string(), 0, {}};
    frame.time_ns = assumed_time(number_in_name(parts.depth).value_or(frame.index));
    if (!parts.pose.empty()) frame.map_from_camera = read_pose_file(parts.pose);
    content.frames.push_back(std::move(frame));
  }
  return content;
}

}  // namespace loci::mapping
