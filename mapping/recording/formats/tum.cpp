#include "mapping/recording/formats/layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/time_limits.h"
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
  std::istringstream text(read_file(path));
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
    poses.push_back({row.time_ns, pose_from_values(values, row.location)});
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

void set_cameras(const fs::path& folder, FileRecordingContent& content) {
  content.depth_scale = 1.0 / 5000;
  content.invalid_depth = {0};
  if (const fs::path cameras = beside_or_above(folder, "cameras.yaml"); !cameras.empty())
    return read_cameras(cameras, content);
  for (const KinectOfBenchmark& kinect : kKinects) {
    if (fs::absolute(folder).lexically_normal().string().find(kinect.name) == std::string::npos) continue;
    content.info.camera.depth = content.info.camera.color = kinect.camera;
    content.color_distortion = content.depth_distortion =
        distortion_from("plumb_bob", {kinect.distortion.begin(), kinect.distortion.end()}, {});
    content.info.guesses.push_back(
        fmt::format("no cameras.yaml: the benchmark's calibration of {}, depth in 1/5000 m", kinect.name));
    return;
  }
  content.info.camera.depth = content.info.camera.color = {640, 480, 525, 525, 319.5, 239.5};
  content.info.guesses.emplace_back(
      "no cameras.yaml: f 525, centre 319.5 239.5, depth in 1/5000 m, as the benchmark recommends");
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
  const bool has_depth = fs::is_regular_file(folder / "depth.txt");
  return (has_depth &&
          (fs::is_regular_file(folder / "rgb.txt") || fs::is_regular_file(folder / "groundtruth.txt"))) ||
         !associations_in(folder).empty();
}

FileRecordingContent read_tum(const fs::path& folder, double color_delay_s) {
  FileRecordingContent content = content_in_world("tum", folder, false);
  set_cameras(folder, content);
  const auto [depths, colors] = read_lists(folder);
  const std::vector<StampedPose> poses = fs::is_regular_file(folder / "groundtruth.txt")
                                             ? poses_in(folder / "groundtruth.txt")
                                             : std::vector<StampedPose>();
  const std::vector<TimeNs> depth_times = times_of(depths), color_times = times_of(colors, color_delay_s);
  const auto matches = nearest_in_time(depth_times, color_times);
  if (const std::string why = unmatched_because(depth_times, color_times); !why.empty())
    content.info.problems.push_back(why);
  for (size_t i = 0; i < depths.size(); ++i) {
    FrameFiles frame;
    frame.index = static_cast<int64_t>(i);
    frame.time_ns = depths[i].time_ns;
    frame.depth = folder / depths[i].words[0];
    if (matches[i]) frame.color = folder / colors[*matches[i]].words[0];
    frame.map_from_camera = pose_at(poses, frame.time_ns);
    frame.location = depths[i].location;
    content.frames.push_back(std::move(frame));
  }
  return content;
}

}  // namespace loci::mapping
