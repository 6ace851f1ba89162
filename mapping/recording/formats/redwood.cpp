// Folders of images, as Open3D, Redwood and exports of ScanNet have them.

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

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

/// Colour images.
std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<fs::path> files = visible_files(folder);
  std::erase_if(files, [](const fs::path& file) {
    const std::string ending = lower_case(file.extension().string());
    return ending != ".png" && ending != ".jpg" && ending != ".jpeg";
  });
  sort_by_name(files);
  return files;
}

fs::path color_folder(const fs::path& folder) {
  for (const char* name : kColorFolders)
    if (!images_in(folder / name).empty()) return folder / name;
  return {};
}

/// The numbers of a matrix, flat or row by row.
std::vector<double> flat_numbers(const Json& matrix) {
  std::vector<double> numbers;
  for (const Json& each : matrix.is_array() ? matrix : Json::array())
    for (const Json& value : each.is_array() ? each : Json::array({each}))
      numbers.push_back(number_of(value));
  return numbers;
}

/// Open3D writes the matrix column by column, others row by row or as a list of rows.
PinholeCamera camera_of_matrix(const Json& matrix, int width, int height, const FileLocation& location) {
  std::vector<double> m = flat_numbers(matrix);
  if (m.size() != 9) throw Error("an intrinsic_matrix has 3 x 3 numbers", location);
  const bool is_by_rows = m[6] == 0 && m[7] == 0;
  const double cx = is_by_rows ? m[2] : m[6], cy = is_by_rows ? m[5] : m[7];
  return checked_camera({width, height, m[0], m[4], cx, cy}, location);
}

std::optional<PinholeCamera> open3d_camera(const fs::path& folder, FileRecordingContent& content) {
  for (const char* name :
       {"camera_intrinsic.json", "intrinsic.json", "camera.json", "camera_primesense.json"}) {
    const fs::path file = beside_or_above(folder, name);
    if (file.empty()) continue;
    Json json = read_json(file);
    if (const Json inner = member_of(json, "intrinsic"); inner.is_object()) json = inner;
    const Json matrix = member_of(json, "intrinsic_matrix");
    if (!matrix.is_array()) {
      content.info.problems.push_back(fmt::format("{} has no intrinsic_matrix and is not used", name));
      continue;
    }
    const auto size = [&](const char* key, int usual) {
      return json.contains(key) ? pixels_of(number_of(json[key])) : usual;
    };
    return camera_of_matrix(matrix, size("width", 640), size("height", 480),
                            {file.string(), 0, "intrinsic_matrix"});
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

void set_cameras_of_folder(const fs::path& folder, FileRecordingContent& content) {
  const fs::path depth = content.frames[0].depth, color = content.frames[0].color;
  RgbdCamera& camera = content.info.camera;
  const auto scannet = scannet_camera(folder / "intrinsic/intrinsic_depth.txt", depth);
  const auto open3d = scannet ? scannet : open3d_camera(folder, content);
  camera.depth = open3d.value_or(PinholeCamera{640, 480, 525, 525, 319.5, 239.5});
  const auto scannet_color =
      color.empty() ? std::nullopt : scannet_camera(folder / "intrinsic/intrinsic_color.txt", color);
  camera.color = scannet_color.value_or(camera.depth);
  const fs::path cameras = beside_or_above(folder, "cameras.yaml");
  if (!cameras.empty() && read_cameras(cameras, content)) return;
  if (cameras.empty()) content.info.guesses.emplace_back("no cameras.yaml: depth is taken as millimetres");
  content.camera_assumed = !open3d;
  if (!open3d)
    content.info.guesses.emplace_back(
        "no camera_intrinsic.json: f 525, centre 319.5 239.5 as PrimeSense has it");
  if (!scannet) fit_cameras_to_images(content);
}

/// Files that may hold the poses: trajectory.log, Redwood's NAME_trajectory.log, Open3D's trajectory.json.
std::vector<fs::path> trajectories_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& place : {folder, folder / "scene"}) {
    std::vector<fs::path> named = visible_files(place);
    std::erase_if(named, [](const fs::path& file) {
      const std::string name = lower_case(file.filename().string());
      return !name.ends_with("trajectory.log") && !name.ends_with("trajectory.json");
    });
    std::ranges::sort(named, std::ranges::greater());  // .log before .json
    files.insert(files.end(), named.begin(), named.end());
  }
  return files;
}

/// Open3D's PinholeCameraTrajectory: camera from world, column by column.
std::vector<NumberedPose> read_trajectory_json(const fs::path& file) {
  std::vector<NumberedPose> poses;
  const Json parameters = member_of(read_json(file), "parameters");
  for (const Json& each : parameters.is_array() ? parameters : Json::array()) {
    const FileLocation location{file.string(), 0, fmt::format("parameters[{}].extrinsic", poses.size())};
    std::vector<double> columns;
    for (const Json& value : member_of(each, "extrinsic")) columns.push_back(number_of(value));
    if (columns.size() != 16) throw Error("an extrinsic has 16 numbers", location);
    std::vector<double> rows(16);
    for (size_t i = 0; i < 16; ++i) rows[4 * (i % 4) + i / 4] = columns[i];
    const std::optional<Isometry3d> camera_from_world = pose_from_rows(rows, location);
    poses.push_back({-1, camera_from_world ? std::optional(camera_from_world->inverse()) : std::nullopt});
  }
  return poses;
}

/// What the two images of a frame share: the name, or else the number, of Redwood that before the stamp.
std::string shared_name(const fs::path& file) {
  return frame_name(file);
}
std::string shared_number(const fs::path& file) {
  const std::string name = frame_name(file);
  const size_t dash = time_in_name(file) ? name.find('-') : std::string::npos;
  const auto number = number_in_name(dash == std::string::npos ? file : fs::path(name.substr(0, dash)));
  return number ? std::to_string(*number) : std::string();
}

/// For each depth image its colour image, by what the names share, or by the stamps in them. Unset when fewer
/// than half of either find one.
using Partners = std::vector<std::optional<size_t>>;
std::optional<Partners> partners_by(const std::function<std::string(const fs::path&)>& shared,
                                    const std::vector<fs::path>& depths,
                                    const std::vector<fs::path>& colors) {
  std::map<std::string, size_t> by_name;
  for (size_t i = 0; i < colors.size(); ++i) by_name[shared(colors[i])] = i;
  Partners partners;
  size_t count = 0;
  for (const fs::path& depth : depths) {
    const auto found = by_name.find(shared(depth));
    const bool is_found = found != by_name.end() && !found->first.empty();
    partners.push_back(is_found ? std::optional(found->second) : std::nullopt);
    count += is_found ? 1 : 0;
  }
  return by_name.size() == colors.size() && 2 * count >= std::max(depths.size(), colors.size())
             ? std::optional(partners)
             : std::nullopt;
}
std::optional<Partners> partners_by_time(const std::vector<fs::path>& depths,
                                         const std::vector<fs::path>& colors) {
  const auto times_of = [](const std::vector<fs::path>& files) {
    std::vector<TimeNs> times;
    for (const fs::path& file : files)
      if (const auto time = time_in_name(file)) times.push_back(time->time_ns);
    return times;
  };
  const std::vector<TimeNs> depth_times = times_of(depths), color_times = times_of(colors);
  if (depth_times.size() != depths.size() || color_times.size() != colors.size()) return std::nullopt;
  Partners partners = nearest_in_time(depth_times, color_times);
  const auto count = std::ranges::count_if(partners, [](const auto& each) { return each.has_value(); });
  return 2 * static_cast<size_t>(count) > depths.size() ? std::optional(std::move(partners)) : std::nullopt;
}

/// As many of both belong together in their order where their names do not say it.
Partners partners_of(const std::vector<fs::path>& depths, const std::vector<fs::path>& colors,
                     const fs::path& folder) {
  if (colors.empty()) return Partners(depths.size());
  for (const auto shared : {shared_name, shared_number})
    if (auto partners = partners_by(shared, depths, colors)) return *partners;
  if (auto partners = partners_by_time(depths, colors)) return *partners;
  if (depths.size() != colors.size())
    throw Error(
        fmt::format("{} depth and {} colour images do not belong together", depths.size(), colors.size()),
        {folder.string(), 0, {}}, "their names share neither a number nor a time");
  Partners partners(depths.size());
  for (size_t i = 0; i < partners.size(); ++i) partners[i] = i;
  return partners;
}

/// Poses in the order of the depth images, or of the colour images; else by the numbers in the names of the
/// depth images, or by their order, as far as there are poses. Unset when they are neither.
std::optional<std::vector<std::optional<Isometry3d>>> poses_of_frames(const std::vector<NumberedPose>& poses,
                                                                      const std::vector<FrameFiles>& frames,
                                                                      const Partners& partners,
                                                                      size_t colors) {
  const bool by_color = poses.size() != frames.size() && poses.size() == colors;
  const bool ascend = std::ranges::is_sorted(poses, std::ranges::less_equal(), &NumberedPose::number);
  const bool by_number =
      !by_color && !poses.empty() && ascend && poses.front().number >= 0 &&
      (poses.size() > frames.size() || number_in_name(frames.front().depth) == poses.front().number);
  if (poses.size() == frames.size() || !(by_color || by_number)) return poses_in_order(poses, frames.size());
  std::vector<std::optional<Isometry3d>> of_frames(frames.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    if (by_color && partners[i]) of_frames[i] = poses[*partners[i]].pose;
    if (!by_number) continue;
    const auto numbered =
        std::ranges::find(poses, number_in_name(frames[i].depth).value_or(-1), &NumberedPose::number);
    if (numbered != poses.end()) of_frames[i] = numbered->pose;
  }
  return of_frames;
}

void set_poses(const fs::path& folder, const Partners& partners, size_t colors,
               FileRecordingContent& content) {
  std::vector<FrameFiles>& frames = content.frames;
  for (FrameFiles& frame : frames) {
    const fs::path file = folder / "pose" / (frame_name(frame.depth) + ".txt");
    if (!fs::exists(file)) continue;
    frame.map_from_camera = pose_from_rows(numbers_in(file, 16), {file.string(), 0, {}});
  }
  for (const fs::path& file : trajectories_in(folder)) {
    const std::vector<NumberedPose> poses =
        file.extension() == ".json" ? read_trajectory_json(file) : read_trajectory_log(file);
    const auto of_frames = poses_of_frames(poses, frames, partners, colors);
    if (!of_frames) {
      content.info.problems.push_back(fmt::format("{} has {} poses for {} frames and is not used",
                                                  file.filename().string(), poses.size(), frames.size()));
      continue;
    }
    for (size_t i = 0; i < frames.size(); ++i) frames[i].map_from_camera = (*of_frames)[i];
    return;
  }
}

}  // namespace

std::vector<fs::path> depth_images_in(const fs::path& folder, size_t count, const std::string& begin) {
  std::array<std::vector<fs::path>, kDepthEndings.size()> kinds;
  for (const fs::path& file : visible_files(folder))
    if (const size_t kind = depth_ending_of(file);
        kind < kinds.size() && file.filename().string().starts_with(begin))
      kinds[kind].push_back(file);
  std::vector<fs::path>& files = *std::ranges::max_element(kinds, {}, [&](const auto& of_kind) {
    return std::pair(count > 0 && of_kind.size() == count, of_kind.size());
  });
  sort_by_name(files);
  return files;
}

bool is_redwood(const fs::path& folder) {
  return !depth_images_in(folder / "depth", 0).empty();
}

FileRecordingContent read_redwood(const fs::path& folder) {
  FileRecordingContent content = content_in_world("redwood", folder, false);
  const fs::path of_colors = color_folder(folder);
  const std::vector<fs::path> colors = of_colors.empty() ? std::vector<fs::path>() : images_in(of_colors),
                              depths = depth_images_in(folder / "depth", colors.size());
  const Partners partners = partners_of(depths, colors, folder);
  std::set<size_t> paired;
  for (size_t i = 0; i < depths.size(); ++i) {
    FrameFiles frame;
    frame.index = static_cast<int64_t>(i);
    frame.depth = depths[i];
    if (partners[i]) frame.color = colors[*partners[i]];
    if (partners[i]) paired.insert(*partners[i]);
    frame.location = {depths[i].string(), 0, {}};
    content.frames.push_back(std::move(frame));
  }
  for (size_t i = 0; i < colors.size() && paired.size() < colors.size(); ++i)
    if (!paired.contains(i)) {
      content.info.problems.push_back(
          fmt::format("{} of {} colour images have no depth image, the first is {}",
                      colors.size() - paired.size(), colors.size(), colors[i].string()));
      break;
    }
  set_times_by_name(content.info, content.frames);
  set_cameras_of_folder(folder, content);
  set_poses(folder, partners, colors.size(), content);
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
    const Json json = read_json(file), nested = member_of(json, "camera");
    const Json& camera = nested.is_object() ? nested : json;
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
    frame.location = {depth.string(), 0, {}};
    const size_t at = 16 * content.frames.size();
    if (at + 16 <= values.size())
      frame.map_from_camera =
          pose_from_rows({values.begin() + std::ptrdiff_t(at), values.begin() + std::ptrdiff_t(at) + 16},
                         {(folder / "traj.txt").string(), static_cast<int>(at / 16) + 1, {}});
    content.frames.push_back(std::move(frame));
  }
  set_times_by_name(content.info, content.frames);
  return content;
}

}  // namespace loci::mapping
