#include "mapping/recording/formats/layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

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
  for (const fs::path& path : visible_files(folder)) {
    const std::string file = path.filename().string();
    if (const std::string frame = frame_of_depth(path); !frame.empty()) {
      fs::path& depth = frames[frame].depth;
      if (depth.empty() || depth_ending_of(path) < depth_ending_of(depth)) depth = path;
    } else if (const size_t at = file.rfind(".color."); at != std::string::npos) {
      frames[file.substr(0, at)].color = path;
    } else if (file.ends_with(".pose.txt")) {
      frames[file.substr(0, file.size() - 9)].pose = path;
    }
  }
  return frames;
}

/// Frames without depth are left out, and named. Error when colour or poses are of other frames altogether.
std::vector<fs::path> frames_with_depth(const std::map<std::string, Parts>& frames, const fs::path& folder,
                                        RecordingInfo& info) {
  size_t colors = 0, colored = 0, poses = 0, posed = 0;
  std::vector<fs::path> depths;
  std::vector<std::string> without;
  for (const auto& [name, parts] : frames) {
    const bool has_depth = !parts.depth.empty();
    colors += parts.color.empty() ? 0 : 1;
    poses += parts.pose.empty() ? 0 : 1;
    colored += has_depth && !parts.color.empty() ? 1 : 0;
    posed += has_depth && !parts.pose.empty() ? 1 : 0;
    if (has_depth)
      depths.push_back(parts.depth);
    else
      without.push_back(name);
  }
  for (const auto& [count, shared, kind] :
       {std::tuple(colors, colored, "colour images"), std::tuple(poses, posed, "poses")})
    if (count > 0 && shared == 0)
      throw Error(
          fmt::format("{} depth images and {} {} have no names in common", depths.size(), count, kind),
          {folder.string(), 0, {}}, "depth and colour do not belong together");
  if (!without.empty())
    info.problems.push_back(fmt::format("{} of {} frames have no depth image, the first is {}",
                                        without.size(), frames.size(), without.front()));
  sort_by_name(depths);
  return depths;
}

}  // namespace

bool is_seven_scenes(const fs::path& folder) {
  return std::ranges::any_of(visible_files(folder),
                             [](const fs::path& file) { return !frame_of_depth(file).empty(); });
}

FileRecordingContent read_seven_scenes(const fs::path& folder) {
  FileRecordingContent content = content_in_world("7-scenes", folder, true);
  content.invalid_depth = {0, 65535};
  const auto frames = find_parts(folder);
  for (const fs::path& depth : frames_with_depth(frames, folder, content.info)) {
    const Parts& parts = frames.at(frame_of_depth(depth));
    FrameFiles frame;
    frame.index = static_cast<int64_t>(content.frames.size());
    frame.depth = depth;
    frame.color = parts.color;
    frame.location = {depth.string(), 0, {}};
    if (!parts.pose.empty()) frame.map_from_camera = read_pose_file(parts.pose);
    content.frames.push_back(std::move(frame));
  }
  set_times_by_name(content.info, content.frames);
  content.info.camera = kinect_camera();
  if (const fs::path cameras = beside_or_above(folder, "cameras.yaml"); !cameras.empty()) {
    read_cameras(cameras, content);
  } else {
    content.camera_assumed = true;
    content.info.guesses.emplace_back("no cameras.yaml: the cameras of a Kinect v1 are assumed");
  }
  return content;
}

}  // namespace loci::mapping
