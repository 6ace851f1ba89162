// What apps on phones with a depth sensor export: nerfstudio's transforms.json (Polycam, Record3D), Stray
// Scanner.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "mapping/base/math/math.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/base/text/text_file.h"
#include "mapping/recording/depth_image.h"
#include "mapping/recording/formats/layouts.h"
#include "mapping/recording/video.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

/// x right, y up, z backwards (OpenGL) → x right, y down, z forward.
const Eigen::DiagonalMatrix<double, 4> kOpenGlFromOptical(1, -1, -1, 1);

/// ARKit's world has y up.
Isometry3d z_up_from_y_up() {
  return Isometry3d(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()));
}

/// The file that a path of transforms.json means: relative to the folder, and not out of it.
fs::path file_below(const fs::path& folder, const Json& frame, const char* key,
                    const FileLocation& location) {
  if (!frame.contains(key) || !frame[key].is_string()) return {};
  const fs::path relative = fs::path(frame[key].get<std::string>()).lexically_normal();
  if (relative.is_absolute() || (!relative.empty() && *relative.begin() == ".."))
    throw Error("a file outside of the folder is not read: " + relative.string(), location);
  return folder / relative;
}

/// Distortion of the frame, or else of all frames.
Distortion nerfstudio_distortion(const Json& json, const Json& frame, const FileLocation& location) {
  const Json named = member_of(json, "camera_model");
  if (!named.is_null() && !named.is_string())
    throw Error("the camera model is not a name", {location.file, 0, "camera_model"});
  const std::string model = named.is_string() ? named.get<std::string>() : "OPENCV";
  const auto k = [&](const char* key) {
    for (const Json* source : {&frame, &json})
      if (source->contains(key)) return number_of((*source)[key]);
    return 0.0;
  };
  if (model == "OPENCV_FISHEYE")
    return distortion_from("equidistant", {k("k1"), k("k2"), k("k3"), k("k4")}, location);
  if (model == "FULL_OPENCV")
    return distortion_from("rational_polynomial",
                           {k("k1"), k("k2"), k("p1"), k("p2"), k("k3"), k("k4"), k("k5"), k("k6")},
                           location);
  for (const char* known : {"OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "RADIAL", "SIMPLE_RADIAL"})
    if (model == known)
      return distortion_from("plumb_bob", {k("k1"), k("k2"), k("p1"), k("p2"), k("k3")}, location);
  throw Error(fmt::format("camera_model {} is not read", model), {location.file, 0, "camera_model"},
              "undistort the images and write PINHOLE");
}

/// Python writes numbers that JSON does not have: NaN and Infinity, of frames that were lost.
std::string null_for_nan(const std::string& text) {
  constexpr std::array<std::string_view, 3> kNumbers = {"NaN", "-Infinity", "Infinity"};
  std::string json;
  bool in_string = false;
  for (size_t i = 0; i < text.size();) {
    if (text[i] == '"' && (i == 0 || text[i - 1] != '\\')) in_string = !in_string;
    const std::string_view rest = std::string_view(text).substr(i);
    const auto word = std::ranges::find_if(
        kNumbers, [&](std::string_view each) { return !in_string && rest.starts_with(each); });
    if (word != kNumbers.end()) {
      json += "null";
      i += word->size();
      continue;
    }
    json += text[i++];
  }
  return json;
}

/// The value of a key in the frame, or else for all frames.
double camera_value(const Json& json, const Json& frame, const char* key, const FileLocation& location) {
  if (frame.contains(key)) return number_of(frame[key]);
  if (json.contains(key)) return number_of(json[key]);
  throw Error("the camera is not described", {location.file, 0, key},
              "fl_x, fl_y, cx, cy, w and h are needed");
}

PinholeCamera nerfstudio_camera(const Json& json, const Json& frame, const FileLocation& location) {
  const auto value = [&](const char* key) { return camera_value(json, frame, key, location); };
  // COLMAP's and ARKit's pixels have their centres at halves.
  return checked_camera({pixels_of(value("w")), pixels_of(value("h")), value("fl_x"), value("fl_y"),
                         value("cx") - 0.5, value("cy") - 0.5},
                        location);
}

/// The camera of the first frame is that of the recording; others of a phone differ a little by autofocus.
void set_nerfstudio_cameras(const Json& json, const std::vector<const Json*>& frames,
                            const FileLocation& location, FileRecordingContent& content) {
  const auto there =
      std::ranges::find_if(content.frames, [](const FrameFiles& frame) { return fs::exists(frame.depth); });
  const fs::path& first = there == content.frames.end() ? content.frames[0].depth : there->depth;
  refuse_foreign_format(first);
  const DepthHeader depth = read_depth_header(first);
  RgbdCamera& camera = content.info.camera;
  camera.color = nerfstudio_camera(json, *frames[0], location);
  camera.depth = scaled_camera(camera.color, depth.width, depth.height);
  content.color_distortion = content.depth_distortion = nerfstudio_distortion(json, *frames[0], location);
  size_t others = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    RgbdCamera lens = camera;
    lens.color = nerfstudio_camera(json, *frames[i], content.frames[i].location);
    if (lens.color == camera.color) continue;
    if (lens.color.width != camera.color.width || lens.color.height != camera.color.height)
      throw Error(fmt::format("the images have {} x {} pixels, those of the first frame {} x {}",
                              lens.color.width, lens.color.height, camera.color.width, camera.color.height),
                  content.frames[i].location, "export images of one size");
    lens.depth = scaled_camera(lens.color, depth.width, depth.height);
    content.frames[i].lens = lens;
    ++others;
  }
  if (others > 0)
    content.info.guesses.push_back(
        fmt::format("{} with a focal length or centre of their own are brought to the camera of the first",
                    counted(others, "frame")));
}

}  // namespace

bool is_nerfstudio(const fs::path& folder) {
  return fs::is_regular_file(folder / "transforms.json");
}

FileRecordingContent read_nerfstudio(const fs::path& folder) {
  FileRecordingContent content = content_in_world("nerfstudio", folder, true);
  const FileLocation location{(folder / "transforms.json").string(), 0, {}};
  const Json json = parse_json(null_for_nan(read_text(location.file)), location.file);
  const Json frames = member_of(json, "frames");
  if (!frames.is_array()) throw Error("'frames' is a list", location);
  if (json.contains("depth_unit_scale_factor"))
    content.depth_scale = number_of(json["depth_unit_scale_factor"]);
  if (!(content.depth_scale > 0 && content.depth_scale <= 1))
    throw Error("depth_unit_scale_factor is metres per unit, e.g. 0.001", location);
  content.float_depth_scale = content.depth_scale;  // nerfstudio multiplies any image by it.
  std::vector<const Json*> used;                    // Those with depth.
  for (const Json& each : frames) {
    FrameFiles frame;
    frame.depth = file_below(folder, each, "depth_file_path", location);
    if (frame.depth.empty()) continue;
    frame.color = file_below(folder, each, "file_path", location);
    frame.index = static_cast<int64_t>(content.frames.size());
    frame.location = {location.file, 0, frame.depth.filename().string()};
    std::vector<double> m;
    const Json matrix = member_of(each, "transform_matrix");
    for (const Json& row : matrix)
      for (const Json& value : row.is_array() ? row : Json::array()) m.push_back(number_of(value));
    if (matrix.is_null()) m.assign(16, std::numeric_limits<double>::quiet_NaN());
    if (m.size() != 12 && m.size() != 16) throw Error("transform_matrix has 4 x 4 numbers", frame.location);
    if (m.size() == 12) m.insert(m.end(), {0, 0, 0, 1});
    if (std::optional<Isometry3d> pose = pose_from_rows(m, frame.location)) {
      pose->matrix() = pose->matrix() * kOpenGlFromOptical;
      frame.map_from_camera = pose;
    }
    content.frames.push_back(std::move(frame));
    used.push_back(&each);
  }
  if (content.frames.empty())
    throw Error("transforms.json names no depth images", location,
                "export with depth: frames need depth_file_path beside file_path");
  set_nerfstudio_cameras(json, used, location, content);
  set_times_by_name(content.info, content.frames);
  return content;
}

bool is_stray_scanner(const fs::path& folder) {
  return fs::exists(folder / "odometry.csv") && fs::exists(folder / "camera_matrix.csv") &&
         fs::is_directory(folder / "depth");
}

FileRecordingContent read_stray_scanner(const fs::path& folder) {
  FileRecordingContent content;
  content.info.format = "stray-scanner";
  content.info.path = folder.string();
  content.info.map_frame = "world";
  content.info.time_assumed = true;
  const std::vector<double> k = numbers_in(folder / "camera_matrix.csv", 9);
  const CsvTable table = CsvTable::read(folder / "odometry.csv");
  const auto column = [&](const std::string& name) {
    for (const std::string& spelling : {name, " " + name})
      if (table.column(spelling) >= 0) return static_cast<size_t>(table.column(spelling));
    return table.require_column(name);
  };
  const size_t stamp = column("timestamp"), number = column("frame");
  std::array<size_t, 7> pose_columns{};
  for (size_t i = 0; i < 7; ++i)
    pose_columns[i] = column(std::array{"x", "y", "z", "qx", "qy", "qz", "qw"}[i]);
  const auto cell = [&](size_t row, size_t at) { return std::stod(trimmed(table.cell(row, at))); };
  const fs::path video = folder / "rgb.mp4";
  std::vector<std::string> without_depth;
  for (size_t row = 0; row < table.rows(); ++row) {
    FrameFiles frame;
    frame.location = table.location(row);
    try {
      frame.index = std::stoll(trimmed(table.cell(row, number)));
      const double seconds = cell(row, stamp);
      if (!(seconds >= 0 && seconds < 1e9)) throw Error("this stamp is not a time", frame.location);
      frame.time_ns = assumed_time(0) + static_cast<TimeNs>(seconds * 1e9);
      std::array<double, 7> values{};
      for (size_t i = 0; i < 7; ++i) values[i] = cell(row, pose_columns[i]);
      if (const auto pose = pose_unless_lost(values, frame.location))
        frame.map_from_camera = z_up_from_y_up() * *pose;
    } catch (const std::logic_error&) {
      throw Error("this row is not one of numbers", frame.location);
    }
    const std::string name = fmt::format("{:06}.png", frame.index);
    frame.depth = folder / "depth" / name;
    if (!fs::exists(frame.depth)) frame.depth.replace_extension(".npy");  // Old versions wrote that.
    if (!fs::exists(frame.depth)) {
      without_depth.push_back(fmt::format("{}: no depth image {}", frame.location.text(), name));
      continue;
    }
    if (fs::exists(folder / "confidence" / name)) frame.confidence = folder / "confidence" / name;
    if (fs::exists(video)) {
      frame.color = video;
      frame.video_frame = row;
    }
    content.frames.push_back(std::move(frame));
  }
  if (content.frames.empty()) throw Error("the recording has no frames", {folder.string(), 0, {}});
  if (!without_depth.empty())
    content.info.problems.push_back(fmt::format("{} of {} frames are left out, the first by {}",
                                                without_depth.size(), table.rows(), without_depth.front()));
  content.min_confidence = 1;  // ARKit: 0 low, 1 medium, 2 high.
  cv::Size size(1920, 1440);
  if (!fs::exists(video)) {
    content.info.guesses.emplace_back("no rgb.mp4: camera_matrix.csv is taken as that of 1920 x 1440 pixels");
  } else {
    content.video = std::make_shared<Video>(video);
    size = content.video->frame(0).size();
  }
  content.info.camera.color =
      checked_camera({size.width, size.height, k[0], k[4], k[2] - 0.5, k[5] - 0.5}, {folder.string(), 0, {}});
  const DepthHeader depth = read_depth_header(content.frames[0].depth);
  content.info.camera.depth = scaled_camera(content.info.camera.color, depth.width, depth.height);
  content.info.guesses.emplace_back("no date in the stamps: they begin at 2000-01-01T00:00:00Z");
  if (std::ranges::any_of(content.frames, [](const FrameFiles& each) { return !each.confidence.empty(); }))
    content.info.guesses.emplace_back("depth of low confidence is left out");
  return content;
}

}  // namespace loci::mapping
