#include "mapping/recording/formats/layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "mapping/base/text/text_file.h"
#include "mapping/base/time_limits.h"
#include "mapping/recording/depth_image.h"
#include "mapping/recording/stamped_poses.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

/// A line of one of the lists: "1305031102.160407 depth/1305031102.160407.png".
struct Row {
  TimeNs time_ns = 0;
  std::vector<std::string> words;  ///< behind the stamp
  FileLocation location;
};

/// Seconds as written, without the loss that a double would bring.
std::optional<TimeNs> parse_seconds(std::string_view text) {
  const size_t dot = std::min(text.find('.'), text.size());
  std::string digits(text.substr(dot == text.size() ? dot : dot + 1));
  if (digits.size() > 9) digits.resize(9);
  digits.resize(9, '0');
  int64_t seconds = 0, part = 0;
  const auto whole = std::from_chars(text.data(), text.data() + dot, seconds);
  const auto rest = std::from_chars(digits.data(), digits.data() + digits.size(), part);
  if (whole.ec != std::errc() || whole.ptr != text.data() + dot || rest.ec != std::errc() ||
      rest.ptr != digits.data() + digits.size() || seconds < 0 || seconds >= kMaxTime / kSecond)
    return std::nullopt;
  return seconds * kSecond + part;
}

std::vector<Row> read_list(const fs::path& path, size_t words) {
  std::vector<Row> rows;
  std::istringstream text(read_text(path));
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    std::istringstream columns(line);
    std::string stamp;
    if (!(columns >> stamp) || stamp.starts_with('#')) continue;
    Row row;
    row.location = {path.string(), number, {}};
    const std::optional<TimeNs> time = parse_seconds(stamp);
    if (!time) throw Error(fmt::format("'{}' is not a stamp in seconds", stamp), row.location);
    row.time_ns = *time;
    for (std::string word; columns >> word;) row.words.push_back(word);
    if (row.words.size() < words)
      throw Error(fmt::format("{} values are needed behind the stamp, there are {}", words, row.words.size()),
                  row.location);
    rows.push_back(std::move(row));
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.time_ns < b.time_ns; });
  return rows;
}

std::vector<StampedPose> poses_in(const fs::path& path) {
  std::vector<StampedPose> poses;
  for (const Row& row : read_list(path, 7)) {
    std::array<double, 7> values{};
    for (size_t i = 0; i < values.size(); ++i) {
      const std::string& word = row.words[i];
      const auto end = std::from_chars(word.data(), word.data() + word.size(), values[i]);
      if (end.ec != std::errc() || end.ptr != word.data() + word.size())
        throw Error(fmt::format("'{}' is not a number", word), row.location);
    }
    if (const auto pose = pose_unless_lost(values, row.location)) poses.push_back({row.time_ns, *pose});
  }
  return poses;
}

std::vector<TimeNs> times_of(const std::vector<Row>& rows, double delay_s = 0) {
  const auto delay = static_cast<TimeNs>(delay_s * static_cast<double>(kSecond));
  std::vector<TimeNs> times;
  for (const Row& row : rows) times.push_back(row.time_ns - delay);
  return times;
}

/// Colour cameras of the benchmark as its authors calibrated them; depth is registered with colour.
struct KinectOfBenchmark {
  const char* name;  ///< in the names of its sequences
  PinholeCamera camera;
  std::array<double, 5> distortion;  ///< plumb_bob; images of the third were undistorted by the authors
};
constexpr std::array<KinectOfBenchmark, 3> kKinects = {{
    {"freiburg1", {640, 480, 517.3, 516.5, 318.6, 255.3}, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}},
    {"freiburg2", {640, 480, 520.9, 521.0, 325.1, 249.7}, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}},
    {"freiburg3", {640, 480, 535.4, 539.2, 320.1, 247.6}, {}},
}};

/// A line for the problems where depth is in millimetres rather than in the unit of the benchmark: no room is
/// as small as this unit would make it. What was millimetres before, as cameras measure them, are multiples
/// of five in it.
std::string millimetres_because(const std::vector<FrameFiles>& frames) {
  constexpr uint16_t kMaxMillimetres = 10'000;  ///< of cameras that see a room
  constexpr size_t kFrames = 8;
  constexpr double kMinMultiples = 0.9, kMaxBeyond = 0.001;
  size_t measured = 0, multiples = 0, beyond = 0;
  uint16_t greatest = 0;
  for (size_t i = 0; i < frames.size(); i += std::max<size_t>(1, frames.size() / kFrames)) {
    cv::Mat raw;
    try {
      raw = read_depth_image(frames[i].depth);
    } catch (const Error&) {
      continue;  // It is named when all images are checked.
    }
    if (raw.type() != CV_16UC1) return {};
    std::for_each(raw.begin<uint16_t>(), raw.end<uint16_t>(), [&](uint16_t value) {
      if (value == 0 || value == 65535) return;
      ++measured;
      if (value % 5 == 0) ++multiples;
      if (value > kMaxMillimetres)
        ++beyond;
      else
        greatest = std::max(greatest, value);
    });
  }
  const auto share = [&](size_t count) { return static_cast<double>(count) / static_cast<double>(measured); };
  if (measured == 0 || share(beyond) > kMaxBeyond || share(multiples) > kMinMultiples) return {};
  return fmt::format(
      "raw depth goes to {}, which is {:.2g} m in the benchmark's unit: if it is in millimetres, write a "
      "cameras.yaml with 'depth: {{unit_m: 0.001}}'",
      greatest, greatest / 5000.0);
}

/// What the camera is taken as where nothing describes it.
std::string assume_camera(const fs::path& folder, FileRecordingContent& content) {
  RgbdCamera& camera = content.info.camera;
  for (const KinectOfBenchmark& kinect : kKinects) {
    if (fs::absolute(folder).lexically_normal().string().find(kinect.name) == std::string::npos) continue;
    camera.depth = camera.color = kinect.camera;
    content.color_distortion = content.depth_distortion =
        distortion_from("plumb_bob", {kinect.distortion.begin(), kinect.distortion.end()}, {});
    return fmt::format("the benchmark's calibration of {}", kinect.name);
  }
  camera.depth = camera.color = {640, 480, 525, 525, 319.5, 239.5};
  return "f 525, centre 319.5 239.5, as the benchmark recommends";
}

void set_cameras(const fs::path& folder, FileRecordingContent& content) {
  content.depth_scale = 1.0 / 5000;
  content.invalid_depth = {0};
  const std::string assumed = assume_camera(folder, content);
  const fs::path cameras = beside_or_above(folder, "cameras.yaml");
  if (!cameras.empty() && read_cameras(cameras, content)) return;
  content.camera_assumed = true;
  fit_cameras_to_images(content);
  content.info.guesses.push_back(cameras.empty()
                                     ? fmt::format("no cameras.yaml: {}, depth in 1/5000 m", assumed)
                                     : fmt::format("cameras.yaml describes no camera: {}", assumed));
  if (const std::string why = cameras.empty() ? millimetres_because(content.frames) : std::string();
      !why.empty())
    content.info.problems.push_back(why);
}

/// The file that lists both images of each frame, as ORB-SLAM takes it; empty where there is none.
fs::path associations_in(const fs::path& folder) {
  for (const char* name : {"associations.txt", "associated.txt", "associate.txt", "association.txt"})
    if (fs::is_regular_file(folder / name)) return folder / name;
  return {};
}

struct ImageLists {
  std::vector<Row> depths, colors;
};

/// "1305031102.175304 rgb/1305031102.175304.png 1305031102.160407 depth/1305031102.160407.png", or depth
/// first.
ImageLists read_associations(const fs::path& path) {
  ImageLists lists;
  for (const Row& row : read_list(path, 3)) {
    const std::optional<TimeNs> time = parse_seconds(row.words[1]);
    if (!time) throw Error(fmt::format("'{}' is not a stamp in seconds", row.words[1]), row.location);
    const Row first{row.time_ns, {row.words[0]}, row.location}, second{*time, {row.words[2]}, row.location};
    const bool is_first = row.words[0].find("depth") != std::string::npos;
    if (is_first == (row.words[2].find("depth") != std::string::npos))
      throw Error("which of the two images is depth is not clear", row.location,
                  "one of their paths has 'depth' in it");
    lists.depths.push_back(is_first ? first : second);
    lists.colors.push_back(is_first ? second : first);
  }
  for (std::vector<Row>* rows : {&lists.depths, &lists.colors})
    std::ranges::stable_sort(*rows, {}, &Row::time_ns);
  return lists;
}

ImageLists read_lists(const fs::path& folder) {
  if (!fs::is_regular_file(folder / "depth.txt")) return read_associations(associations_in(folder));
  ImageLists lists;
  lists.depths = read_list(folder / "depth.txt", 1);
  if (fs::is_regular_file(folder / "rgb.txt")) lists.colors = read_list(folder / "rgb.txt", 1);
  return lists;
}

}  // namespace

std::vector<StampedPose> read_tum_poses(const fs::path& path) {
  return poses_in(path);
}

bool is_tum(const fs::path& folder) {
  const auto has = [&](const char* name) { return fs::is_regular_file(folder / name); };
  return (has("depth.txt") &&
          (has("rgb.txt") || has("groundtruth.txt") || fs::is_directory(folder / "depth"))) ||
         !associations_in(folder).empty();
}

FileRecordingContent read_tum(const fs::path& folder, double color_delay_s) {
  FileRecordingContent content = content_in_world("tum", folder, false);
  const auto [depths, colors] = read_lists(folder);
  const fs::path truth = folder / "groundtruth.txt";
  const std::vector<StampedPose> poses =
      fs::is_regular_file(truth) ? poses_in(truth) : std::vector<StampedPose>();
  const std::vector<TimeNs> depth_times = times_of(depths), color_times = times_of(colors, color_delay_s);
  const auto matches = nearest_in_time(depth_times, color_times);
  if (const std::string why = unmatched_because(depth_times, color_times); !why.empty())
    content.info.problems.push_back(why);
  bool has_pose = false;
  for (size_t i = 0; i < depths.size(); ++i) {
    FrameFiles frame;
    frame.index = static_cast<int64_t>(i);
    frame.time_ns = depths[i].time_ns;
    frame.depth = folder / depths[i].words[0];
    if (matches[i]) frame.color = folder / colors[*matches[i]].words[0];
    frame.map_from_camera = pose_at(poses, frame.time_ns);
    has_pose = has_pose || frame.map_from_camera;
    frame.location = depths[i].location;
    content.frames.push_back(std::move(frame));
  }
  if (!poses.empty() && !has_pose && !depths.empty())
    content.info.problems.push_back(
        fmt::format("{}: {} ({}the frames from {} to {})", truth.string(), kNoPoseHere, range_of(poses),
                    format_time(depth_times.front()), format_time(depth_times.back())));
  set_cameras(folder, content);
  return content;
}

}  // namespace loci::mapping
