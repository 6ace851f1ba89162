#include "mapping/recording/formats/layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/config.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/time_zone.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 7> kPoseColumns = {"x", "y", "z", "qx", "qy", "qz", "qw"};

/// `distortion: {model: plumb_bob, coefficients: [...]}` of a camera.
Distortion read_distortion(const Config& camera) {
  if (!camera.has("distortion")) return {};
  const Config distortion = camera.map("distortion");
  distortion.refuse_other_keys({"model", "coefficients"});
  return distortion_from(distortion.require<std::string>("model"),
                         distortion.require<std::vector<double>>("coefficients"),
                         camera.location("distortion"));
}

void read_cameras(const Config& cameras, FileRecordingContent& content) {
  RecordingInfo& info = content.info;
  const Config depth = cameras.map("depth");
  if (!cameras.has("depth")) throw Error("the depth camera is missing", cameras.location());
  depth.refuse_other_keys({"width", "height", "fx", "fy", "cx", "cy", "distortion"});
  info.camera.depth = read_pinhole(depth);
  content.depth_distortion = read_distortion(depth);
  if (cameras.has("color")) {
    const Config color = cameras.map("color");
    color.refuse_other_keys({"width", "height", "fx", "fy", "cx", "cy", "depth_from_color", "distortion"});
    info.camera.color = read_pinhole(color);
    content.color_distortion = read_distortion(color);
    if (color.has("depth_from_color"))
      info.camera.depth_from_color = pose_from_values(
          color.require<std::array<double, 7>>("depth_from_color"), color.location("depth_from_color"));
  } else {
    info.camera.color = info.camera.depth;
    content.color_distortion = content.depth_distortion;
    info.guesses.emplace_back("no colour camera described: colour is taken as registered with depth");
  }
  for (const std::string& key : cameras.keys())  // Further images per frame are listed, not read.
    if (key.starts_with("color")) cameras.node(key);
  cameras.finish();
}

void read_description(const fs::path& path, FileRecordingContent& content) {
  const Config config = Config::read(path);
  config.refuse_other_keys({"version", "depth_scale", "float_depth_scale", "depth_along_rays",
                            "invalid_depth", "time_assumed", "time_zone", "map_frame", "cameras"});
  const int version = config.get<int>("version", 1);
  if (version != 1)
    throw Error(fmt::format("this recording has version {}, version 1 is read", version),
                config.location("version"));
  content.depth_scale = config.get<double>("depth_scale", 0.001);
  if (!(content.depth_scale > 0 && content.depth_scale < 1))
    throw Error("depth_scale is out of bounds", config.location("depth_scale"),
                "it is metres per unit, e.g. 0.001");
  content.float_depth_scale = float_scale_of(config, "float_depth_scale");
  content.depth_along_rays = config.get<bool>("depth_along_rays", false);
  content.invalid_depth = config.get<std::vector<int>>("invalid_depth", {0});
  for (const int raw : content.invalid_depth)
    if (raw < 0 || raw > 65535) throw Error("depth values are 0 to 65535", config.location("invalid_depth"));
  content.info.time_assumed = config.get<bool>("time_assumed", false);
  content.info.time_zone = config.get<std::string>("time_zone", "");
  if (!content.info.time_zone.empty()) TimeZone::named(content.info.time_zone, config.location("time_zone"));
  content.info.map_frame = config.get<std::string>("map_frame", "map");
  if (!config.has("cameras")) throw Error("the key 'cameras' is missing", config.location());
  read_cameras(config.map("cameras"), content);
}

bool is_not_finite(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  return *end == '\0' && !cell.empty() && !std::isfinite(value);
}

/// The pose in a row; unset when all its cells are empty, or the frame was lost.
std::optional<Isometry3d> read_pose(const CsvTable& table, size_t row) {
  std::array<double, 7> values{};
  size_t empty = 0;
  bool is_lost = false;
  for (size_t i = 0; i < values.size(); ++i) {
    const size_t column = table.require_column(kPoseColumns[i]);
    if (table.cell(row, column).empty())
      ++empty;
    else if (is_not_finite(table.cell(row, column)))
      is_lost = true;
    else
      values[i] = table.number(row, column);
  }
  if (is_lost) return std::nullopt;
  if (empty == values.size()) return std::nullopt;
  if (empty > 0)
    throw Error("the pose is not complete", table.location(row), "give all of x y z qx qy qz qw, or none");
  return pose_unless_lost(values, table.location(row));
}

void check_columns(const CsvTable& table, const std::set<std::string>& known, RecordingInfo& info) {
  for (const std::string& name : table.header()) {
    if (known.contains(name)) continue;
    info.problems.push_back(name.starts_with("color")
                                ? fmt::format("the images of column '{}' are not read", name)
                                : fmt::format("frames.csv: the column '{}' is not known", name));
  }
}

/// A line for the problems where the stamps are not nanoseconds: as such, no camera is as fast.
std::string unit_of_stamps_because(const std::vector<FrameFiles>& frames) {
  constexpr TimeNs kMinApart = 100'000;
  if (frames.size() < 2) return {};
  const auto [first, last] = std::ranges::minmax(frames, {}, &FrameFiles::time_ns);
  const TimeNs apart = (last.time_ns - first.time_ns) / static_cast<TimeNs>(frames.size() - 1);
  if (apart == 0 || apart >= kMinApart) return {};
  constexpr TimeNs kYear2000 = 946'684'800, kYear2100 = 4'102'444'800;  // s
  for (const auto& [per_second, name] :
       {std::pair(TimeNs{1}, "seconds"), std::pair(TimeNs{1000}, "milliseconds"),
        std::pair(TimeNs{1'000'000}, "microseconds")})
    if (first.time_ns / per_second > kYear2000 && first.time_ns / per_second < kYear2100)
      return fmt::format(
          "frames.csv: as nanoseconds frames are {} ns apart: the stamps look like {}, multiply them by {}",
          apart, name, kSecond / per_second);
  return fmt::format("frames.csv: as nanoseconds frames are {} ns apart: check time_ns", apart);
}

/// Gives frames without a stamp one between those of their neighbours, in the order of the rows. `stamped`:
/// the frames that have one, at least one. Error where that cannot be.
void interpolate_stamps(const std::vector<size_t>& stamped, FileRecordingContent& content) {
  std::vector<FrameFiles>& frames = content.frames;
  if (stamped.size() == frames.size()) return;
  const char* hint = "give all frames a time_ns, or none";
  if (stamped.size() < 2) throw Error("only one frame has a time stamp", frames[stamped[0]].location, hint);
  for (size_t k = 1; k < stamped.size(); ++k)
    if (frames[stamped[k]].time_ns < frames[stamped[k - 1]].time_ns)
      throw Error("the stamps go back here, and other frames have none", frames[stamped[k]].location, hint);
  const auto on_line = [&](size_t a, size_t b, size_t i) {
    const double apart =
        static_cast<double>(frames[b].time_ns - frames[a].time_ns) / static_cast<double>(b - a);
    return frames[a].time_ns + static_cast<TimeNs>(apart * (static_cast<double>(i) - static_cast<double>(a)));
  };
  size_t first = frames.size();
  for (size_t i = 0, next = 0; i < frames.size(); ++i) {
    if (next < stamped.size() && stamped[next] == i) {
      ++next;
      continue;
    }
    first = std::min(first, i);
    const size_t after = std::clamp<size_t>(next, 1, stamped.size() - 1);
    frames[i].time_ns = on_line(stamped[after - 1], stamped[after], i);
  }
  content.info.problems.push_back(fmt::format(
      "{} of {} frames have no time stamp, the first is {}: theirs are taken between their neighbours'",
      frames.size() - stamped.size(), frames.size(), frames[first].location.text()));
}

void read_frames(const fs::path& folder, FileRecordingContent& content) {
  const CsvTable table = CsvTable::read(folder / "frames.csv");
  check_columns(table, {"index", "time_ns", "color", "depth", "x", "y", "z", "qx", "qy", "qz", "qw"},
                content.info);
  const int index = table.column("index");
  const int time = table.column("time_ns");
  const int color = table.column("color");
  const size_t depth = table.require_column("depth");
  const bool posed = std::any_of(kPoseColumns.begin(), kPoseColumns.end(),
                                 [&](const char* name) { return table.column(name) >= 0; });
  std::set<int64_t> indices;
  std::vector<size_t> stamped;
  for (size_t row = 0; row < table.rows(); ++row) {
    FrameFiles frame;
    frame.location = table.location(row);
    if (table.cell(row, depth).empty()) throw Error("this frame has no depth image", frame.location);
    frame.depth = folder / table.cell(row, depth);
    if (color >= 0 && !table.cell(row, static_cast<size_t>(color)).empty())
      frame.color = folder / table.cell(row, static_cast<size_t>(color));
    frame.index = index >= 0 ? table.integer(row, static_cast<size_t>(index)) : static_cast<int64_t>(row);
    if (!indices.insert(frame.index).second)
      throw Error(fmt::format("the index {} is there twice", frame.index), frame.location);
    if (time >= 0 && !table.cell(row, static_cast<size_t>(time)).empty()) {
      frame.time_ns = table.integer(row, static_cast<size_t>(time));
      stamped.push_back(row);
    }
    if (posed) frame.map_from_camera = read_pose(table, row);
    content.frames.push_back(std::move(frame));
  }
  if (stamped.empty()) return set_times_by_name(content.info, content.frames);
  interpolate_stamps(stamped, content);
  if (content.info.time_assumed) content.info.guesses.emplace_back("the time stamps were made up");
  if (const std::string why = unit_of_stamps_because(content.frames); !why.empty())
    content.info.problems.push_back(why);
}

/// Gives each frame the joint positions that were latest at its time.
void read_joints(const fs::path& path, std::vector<FrameFiles>& frames) {
  if (!fs::exists(path)) return;
  const CsvTable table = CsvTable::read(path);
  const size_t time = table.require_column("time_ns");
  const size_t joint = table.require_column("joint");
  const size_t position = table.require_column("position");
  std::map<std::string, std::map<TimeNs, double>> tracks;
  for (size_t row = 0; row < table.rows(); ++row)
    tracks[table.cell(row, joint)][table.integer(row, time)] = table.number(row, position);
  for (FrameFiles& frame : frames) {
    for (const auto& [name, track] : tracks) {
      const auto after = track.upper_bound(frame.time_ns);
      if (after != track.begin()) frame.joints[name] = std::prev(after)->second;
    }
  }
}

/// Transforms are kept for programs that want them; a broken one is told when the recording is opened.
void check_transforms(const fs::path& path) {
  if (!fs::exists(path)) return;
  const CsvTable table = CsvTable::read(path);
  for (const char* name : {"time_ns", "parent", "child"}) table.require_column(name);
  for (size_t row = 0; row < table.rows(); ++row)
    if (!read_pose(table, row)) throw Error("a transform needs a pose", table.location(row));
}

}  // namespace

PinholeCamera read_pinhole(const Config& config) {
  PinholeCamera camera;
  camera.width = config.require<int>("width");
  camera.height = config.require<int>("height");
  camera.fx = config.require<double>("fx");
  camera.fy = config.require<double>("fy");
  camera.cx = config.require<double>("cx");
  camera.cy = config.require<double>("cy");
  return checked_camera(camera, config.location());
}

FileRecordingContent read_loci_layout(const fs::path& folder) {
  FileRecordingContent content;
  content.info.format = "loci";
  content.info.path = folder.string();
  read_description(folder / "recording.yaml", content);
  read_frames(folder, content);
  read_joints(folder / "joints.csv", content.frames);
  check_transforms(folder / "transforms.csv");
  return content;
}

}  // namespace loci::mapping
