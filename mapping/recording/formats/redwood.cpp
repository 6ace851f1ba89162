// Folders of images, as Open3D, Redwood and exports of ScanNet have them.

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/depth_image.h"
#include "mapping/recording/formats/layouts.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr size_t kPngEnding = kDepthEndings.size() - 1;  ///< of depth_ending_of(); colour has it, too
constexpr std::array<const char*, 3> kColorFolders = {"color", "image", "rgb"};

/// "2.png" comes before "10.png".
void sort_by_number(std::vector<fs::path>& files) {
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    const auto number_a = number_in_name(a), number_b = number_in_name(b);
    return number_a && number_b && number_a != number_b ? *number_a < *number_b : a < b;
  });
}

/// Colour images.
std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string ending = lower_case(entry.path().extension().string());
    if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") files.push_back(entry.path());
  }
  sort_by_number(files);
  return files;
}

fs::path color_folder(const fs::path& folder) {
  for (const char* name : kColorFolders)
    if (!images_in(folder / name).empty()) return folder / name;
  return {};
}

/// Microseconds behind a dash, as Redwood's recordings have them: "0000012-000000400417.jpg".
std::optional<TimeNs> microseconds_in_name(const fs::path& path) {
  const std::vector<std::string> parts = split(path.stem().string(), '-');
  if (parts.size() != 2 || parts[1].size() != 12 || !std::all_of(parts[1].begin(), parts[1].end(), is_digit))
    return std::nullopt;
  return assumed_time(0) + 1000 * std::stoll(parts[1]);
}

std::optional<PinholeCamera> open3d_camera(const fs::path& folder) {
  for (const char* name :
       {"camera_intrinsic.json", "intrinsic.json", "camera.json", "camera_primesense.json"}) {
    const fs::path file = beside_or_above(folder, name);
    if (file.empty()) continue;
    const Json json = read_json(file);
    const Json matrix = member_of(json, "intrinsic_matrix");
    if (!matrix.is_array() || matrix.size() != 9) continue;
    const auto size = [&](const char* key, int usual) {
      return json.contains(key) ? pixels_of(number_of(json[key])) : usual;
    };
    return checked_camera({size("width", 640), size("height", 480), number_of(matrix[0]),
                           number_of(matrix[4]), number_of(matrix[6]), number_of(matrix[7])},
                          {file.string(), 0, {}});
  }
  return std::nullopt;
}

std::pair<int, int> image_size(const fs::path& image) {
  if (depth_ending_of(image) < kPngEnding) {
    const DepthHeader header = read_depth_header(image);
    return {header.width, header.height};
  }
  const ImageHeader header = read_image_header(image);
  return {header.width, header.height};
}

/// ScanNet's intrinsic/intrinsic_depth.txt: a 4 x 4 matrix.
std::optional<PinholeCamera> scannet_camera(const fs::path& file, const fs::path& image) {
  if (!fs::exists(file)) return std::nullopt;
  const std::vector<double> m = numbers_in(file, 16);
  const auto [width, height] = image_size(image);
  return checked_camera({width, height, m[0], m[5], m[2], m[6]}, {file.string(), 0, {}});
}

void set_cameras_of_folder(const fs::path& folder, const fs::path& depth, const fs::path& color,
                           FileRecordingContent& content) {
  if (const fs::path cameras = beside_or_above(folder, "cameras.yaml"); !cameras.empty())
    return read_cameras(cameras, content);
  content.info.guesses.emplace_back("no cameras.yaml: depth is taken as millimetres");
  RgbdCamera& camera = content.info.camera;
  const auto scannet = scannet_camera(folder / "intrinsic/intrinsic_depth.txt", depth);
  const auto open3d = scannet ? scannet : open3d_camera(folder);
  if (!open3d)
    content.info.guesses.emplace_back(
        "no camera_intrinsic.json: f 525, centre 319.5 239.5 as PrimeSense has it");
  camera.depth = open3d.value_or(PinholeCamera{640, 480, 525, 525, 319.5, 239.5});
  const auto scannet_color =
      color.empty() ? std::nullopt : scannet_camera(folder / "intrinsic/intrinsic_color.txt", color);
  camera.color = scannet_color.value_or(camera.depth);
}

/// Files that may hold the poses: trajectory.log, Redwood's NAME_trajectory.log, Open3D's trajectory.json.
std::vector<fs::path> trajectories_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& place : {folder, folder / "scene"}) {
    if (!fs::is_directory(place)) continue;
    std::vector<fs::path> named;
    for (const auto& entry : fs::directory_iterator(place)) {
      const std::string name = lower_case(entry.path().filename().string());
      if (name.ends_with("trajectory.log") || name.ends_with("trajectory.json"))
        named.push_back(entry.path());
    }
    std::ranges::sort(named, std::ranges::greater());  // .log before .json
    files.insert(files.end(), named.begin(), named.end());
  }
  return files;
}

/// Open3D's PinholeCameraTrajectory: camera from world, column by column.
std::vector<Isometry3d> read_trajectory_json(const fs::path& file) {
  std::vector<Isometry3d> poses;
  const Json parameters = member_of(read_json(file), "parameters");
  for (const Json& each : parameters.is_array() ? parameters : Json::array()) {
    const FileLocation location{file.string(), 0, fmt::format("parameters[{}].extrinsic", poses.size())};
    std::vector<double> columns;
    for (const Json& value : member_of(each, "extrinsic")) columns.push_back(number_of(value));
    if (columns.size() != 16) throw Error("an extrinsic has 16 numbers", location);
    std::vector<double> rows(16);
    for (size_t i = 0; i < 16; ++i) rows[4 * (i % 4) + i / 4] = columns[i];
    poses.push_back(pose_from_rows(rows, location).inverse());
  }
  return poses;
}

void set_poses(const fs::path& folder, FileRecordingContent& content) {
  std::vector<FrameFiles>& frames = content.frames;
  for (FrameFiles& frame : frames) {
    const fs::path file = folder / "pose" / (frame_name(frame.depth) + ".txt");
    if (!fs::exists(file)) continue;
    const std::vector<double> m = numbers_in(file, 16);
    // Lost frames have -inf.
    if (std::all_of(m.begin(), m.end(), [](double x) { return std::isfinite(x); }))
      frame.map_from_camera = pose_from_rows(m, {file.string(), 0, {}});
  }
  for (const fs::path& file : trajectories_in(folder)) {
    const std::vector<Isometry3d> poses =
        file.extension() == ".json" ? read_trajectory_json(file) : read_trajectory_log(file);
    if (poses.size() != frames.size()) {
      content.info.problems.push_back(fmt::format("{} has {} poses for {} frames and is not used",
                                                  file.filename().string(), poses.size(), frames.size()));
      continue;
    }
    for (size_t i = 0; i < frames.size(); ++i) frames[i].map_from_camera = poses[i];
    return;
  }
}

}  // namespace

std::vector<fs::path> depth_images_in(const fs::path& folder, size_t count, const std::string& begin) {
  std::array<std::vector<fs::path>, kDepthEndings.size()> kinds;
  if (!fs::is_directory(folder)) return {};
  for (const auto& entry : fs::directory_iterator(folder))
    if (const size_t kind = depth_ending_of(entry.path());
        kind < kinds.size() && entry.path().filename().string().starts_with(begin))
      kinds[kind].push_back(entry.path());
  std::vector<fs::path>& files = *std::ranges::max_element(kinds, {}, [&](const auto& of_kind) {
    return std::pair(count > 0 && of_kind.size() == count, of_kind.size());
  });
  sort_by_number(files);
  return files;
}

bool is_redwood(const fs::path& folder) {
  return !color_folder(folder).empty() && !depth_images_in(folder / "depth", 0).empty();
}

FileRecordingContent read_redwood(const fs::path& folder) {
  FileRecordingContent content = content_in_world("redwood", folder, false);
  const std::vector<fs::path> colors = images_in(color_folder(folder)),
                              depths = depth_images_in(folder / "depth", colors.size());
  if (depths.size() != colors.size())
    throw Error(
        fmt::format("{} depth and {} colour images do not belong together", depths.size(), colors.size()),
        {folder.string(), 0, {}});
  set_cameras_of_folder(folder, depths[0], colors[0], content);
  for (size_t i = 0; i < depths.size(); ++i) {
    FrameFiles frame;
    frame.index = static_cast<int64_t>(i);
    frame.depth = depths[i];
    frame.color = colors[i];
    frame.location = {depths[i].string(), 0, {}};
    const auto time = microseconds_in_name(depths[i]);
    frame.time_ns = time ? *time : assumed_time(number_in_name(depths[i]).value_or(frame.index));
    content.frames.push_back(std::move(frame));
  }
  content.info.time_assumed = true;
  content.info.guesses.emplace_back("no date in the stamps: they begin at 2000-01-01T00:00:00Z");
  set_poses(folder, content);
  return content;
}

bool is_replica(const fs::path& folder) {
  return fs::exists(folder / "traj.txt") && fs::is_directory(folder / "results");
}

FileRecordingContent read_replica(const fs::path& folder) {
  FileRecordingContent content = content_in_world("replica", folder, true);
  content.depth_scale = 1 / 6553.5;
  content.info.camera.depth = {1200, 680, 600, 600, 599.5, 339.5};
  if (const fs::path file = beside_or_above(folder, "cam_params.json"); !file.empty()) {
    const Json camera = member_of(read_json(file), "camera");
    const auto value = [&](const char* key) { return number_of(member_of(camera, key)); };
    content.info.camera.depth = checked_camera(
        {pixels_of(value("w")), pixels_of(value("h")), value("fx"), value("fy"), value("cx"), value("cy")},
        {file.string(), 0, "camera"});
    if (!(value("scale") >= 1 && value("scale") <= 1e6))
      throw Error("scale is values per metre", {file.string(), 0, "camera.scale"});
    content.depth_scale = 1 / value("scale");
  } else {
    content.info.guesses.emplace_back(
        "no cam_params.json: f 600, 1200 x 680, 6553.5 per metre as NICE-SLAM has it");
  }
  content.info.camera.color = content.info.camera.depth;
  const std::vector<double> values = numbers_in(folder / "traj.txt", 0);
  for (const fs::path& depth : depth_images_in(folder / "results", 0, "depth")) {
    FrameFiles frame;
    frame.index = number_in_name(depth).value_or(static_cast<int64_t>(content.frames.size()));
    frame.depth = depth;
    for (const char* ending : {".jpg", ".png"})
      if (const fs::path color = folder / "results" / ("frame" + depth.stem().string().substr(5) + ending);
          fs::exists(color))
        frame.color = color;
    frame.time_ns = assumed_time(frame.index);
    frame.location = {depth.string(), 0, {}};
    const size_t at = 16 * content.frames.size();
    if (at + 16 > values.size())
      throw Error(fmt::format("traj.txt has {} poses, there are more images", values.size() / 16),
                  {folder.string(), 0, {}});
    frame.map_from_camera =
        pose_from_rows({values.begin() + std::ptrdiff_t(at), values.begin() + std::ptrdiff_t(at) + 16},
                       {(folder / "traj.txt").string(), static_cast<int>(at / 16) + 1, {}});
    content.frames.push_back(std::move(frame));
  }
  content.info.guesses.emplace_back(
      "no time stamps: 30 Hz from 2000-01-01T00:00:00Z by the number in the name");
  return content;
}

}  // namespace loci::mapping
