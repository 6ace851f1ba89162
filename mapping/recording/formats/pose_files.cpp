// Poses of cameras in files of other programs.

#include <fmt/format.h>

#include <charconv>
#include <map>
#include <sstream>

#include "mapping/base/text/text.h"
#include "mapping/base/text/text_file.h"
#include "mapping/recording/formats/layouts.h"
#include "mapping/recording/posed_recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

struct PoseLine {
  std::vector<std::string> words;
  FileLocation location;

  template <class T = double>
  T number(size_t i) const {
    T value{};
    const std::string& word = words.at(i);
    const char* end = word.data() + word.size();
    if (const auto read = std::from_chars(word.data(), end, value); read.ec != std::errc() || read.ptr != end)
      throw Error(fmt::format("'{}' is not a {}number", word, std::is_integral_v<T> ? "whole " : ""),
                  location);
    return value;
  }
  template <size_t count>
  std::array<double, count> numbers(size_t from) const {
    std::array<double, count> values{};
    for (size_t i = 0; i < count; ++i) values[i] = number(from + i);
    return values;
  }
};

std::vector<PoseLine> lines_of(const fs::path& file, bool& colmap) {
  std::vector<PoseLine> lines;
  std::istringstream text(read_text(file));
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    if (line.find("IMAGE_ID") != std::string::npos) colmap = true;
    if (!line.starts_with('#')) lines.push_back({words_of(line), {file.string(), number, {}}});
  }
  while (!lines.empty() && lines.back().words.empty()) lines.pop_back();
  return lines;
}

std::vector<PoseLine> without_empty(std::vector<PoseLine> lines) {
  std::erase_if(lines, [](const PoseLine& line) { return line.words.empty(); });
  return lines;
}

using Poses = std::vector<std::optional<Isometry3d>>;

Error wrong_count(size_t poses, const Recording& recording, const fs::path& file) {
  return Error(fmt::format("{} poses for {} frames", poses, recording.size()), {file.string(), 0, {}},
               "this format has one for each frame, in their order");
}

Poses from_kitti(const std::vector<PoseLine>& lines, const Recording& recording, const fs::path& file) {
  if (lines.size() != recording.size()) throw wrong_count(lines.size(), recording, file);
  Poses poses;
  for (const PoseLine& line : lines) {
    const auto values = line.numbers<12>(0);
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 12; ++i) matrix(i / 4, i % 4) = values[static_cast<size_t>(i)];
    poses.push_back(pose_unless_lost(matrix, line.location));
  }
  return poses;
}

Poses from_g2o(const std::vector<PoseLine>& lines, const Recording& recording) {
  std::map<int64_t, std::optional<Isometry3d>> by_index;
  for (const PoseLine& line : lines)
    if (line.words[0] == "VERTEX_SE3:QUAT") {
      if (line.words.size() < 9) throw Error("a vertex has an index and 7 numbers", line.location);
      by_index[line.number<int64_t>(1)] = pose_unless_lost(line.numbers<7>(2), line.location);
    }
  Poses poses(recording.size());
  for (size_t i = 0; i < recording.size(); ++i)
    if (const auto found = by_index.find(recording.index_of(i)); found != by_index.end())
      poses[i] = found->second;
  return poses;
}

/// By the name of the image or of its depth, by its number, or by the stamp in its name.
Poses from_colmap(const std::vector<PoseLine>& lines, const Recording& recording) {
  std::map<std::string, Isometry3d> by_name;
  std::map<int64_t, Isometry3d> by_number;
  std::map<TimeNs, Isometry3d> by_time;
  // A line of the image and one of its points, which may be empty.
  for (size_t i = 0; i < lines.size(); i += 2) {
    const PoseLine& line = lines[i];
    if (line.words.size() < 10)
      throw Error("an image has id, quaternion, position, camera and name", line.location);
    const auto v = line.numbers<7>(1);
    const Isometry3d camera_from_world =
        pose_from_values({v[4], v[5], v[6], v[1], v[2], v[3], v[0]}, line.location);
    const std::string& image = line.words[9];
    by_name[frame_name(image)] = camera_from_world.inverse();
    if (const auto number = number_in_name(image)) by_number[*number] = camera_from_world.inverse();
    if (const auto time = time_in_name(image)) by_time[time->time_ns] = camera_from_world.inverse();
  }
  const Isometry3d color_from_depth = recording.info().camera.depth_from_color.inverse();
  std::vector<TimeNs> frame_times, times;
  for (size_t i = 0; i < recording.size(); ++i) frame_times.push_back(recording.time_of(i));
  for (const auto& [time, pose] : by_time) times.push_back(time);
  const auto nearest = nearest_in_time(frame_times, times);
  const auto pose_of = [&](size_t i) -> std::optional<Isometry3d> {
    for (const std::string& name : {recording.color_name_of(i), recording.name_of(i)})
      if (const auto named = by_name.find(name); named != by_name.end()) return named->second;
    // Of names without an ending a stamp's decimals would be one.
    const auto number = number_in_name(recording.name_of(i) + ".png");
    if (const auto numbered = number ? by_number.find(*number) : by_number.end(); numbered != by_number.end())
      return numbered->second;
    return nearest[i] ? std::optional(by_time.at(times[*nearest[i]])) : std::nullopt;
  };
  Poses poses;
  for (size_t i = 0; i < recording.size(); ++i) {
    poses.push_back(pose_of(i));
    if (poses.back()) poses.back() = *poses.back() * color_from_depth;
  }
  return poses;
}

}  // namespace

std::string range_of(const std::vector<StampedPose>& poses) {
  return poses.empty() ? std::string()
                       : fmt::format("the poses go from {} to {}, ", format_time(poses.front().time_ns),
                                     format_time(poses.back().time_ns));
}

std::vector<NumberedPose> read_trajectory_log(const fs::path& file) {
  bool ignored = false;
  const std::vector<PoseLine> lines = without_empty(lines_of(file, ignored));
  std::vector<NumberedPose> poses;
  for (size_t i = 0; i + 4 < lines.size(); i += 5) {
    Eigen::Matrix4d matrix;
    for (int row = 0; row < 4; ++row) {
      const PoseLine& line = lines[i + 1 + static_cast<size_t>(row)];
      if (line.words.size() != 4) throw Error("a row of a pose has 4 numbers", line.location);
      const auto values = line.numbers<4>(0);
      for (int column = 0; column < 4; ++column) matrix(row, column) = values[static_cast<size_t>(column)];
    }
    poses.push_back({lines[i].number<int64_t>(0), pose_unless_lost(matrix, lines[i].location)});
  }
  if (lines.size() % 5 != 0)
    throw Error("a pose is a line of numbers and four rows of a matrix; the last one is not complete",
                {file.string(), 0, {}});
  return poses;
}

std::optional<Poses> poses_in_order(const std::vector<NumberedPose>& numbered, size_t count) {
  Poses poses(count);
  const bool is_complete = numbered.size() == count;
  for (size_t i = 0; i < numbered.size(); ++i) {
    const int64_t number = is_complete ? static_cast<int64_t>(i) : numbered[i].number;
    const bool ascends = is_complete || i == 0 || number > numbered[i - 1].number;
    if (!ascends || number < 0 || number >= static_cast<int64_t>(count)) return std::nullopt;
    poses[static_cast<size_t>(number)] = numbered[i].pose;
  }
  return poses;
}

std::vector<std::optional<Isometry3d>> read_poses_for(const Recording& recording, const fs::path& file) {
  bool colmap = false;
  std::vector<PoseLine> lines = lines_of(file, colmap);
  if (lines.empty()) throw Error("the file has no poses", {file.string(), 0, {}});
  const size_t words = lines[0].words.size();
  Poses poses;
  std::string range;
  if (colmap || words == 10) {
    poses = from_colmap(lines, recording);
  } else if (lines = without_empty(std::move(lines));
             lines[0].words[0].starts_with("VERTEX_") || lines[0].words[0].starts_with("EDGE_")) {
    poses = from_g2o(lines, recording);
  } else if (words == 12) {
    poses = from_kitti(lines, recording, file);
  } else if (words == 8) {
    const std::vector<StampedPose> stamped = read_tum_poses(file);
    for (size_t i = 0; i < recording.size(); ++i) poses.push_back(pose_at(stamped, recording.time_of(i)));
    range = range_of(stamped);
  } else if (words == 3) {
    const std::vector<NumberedPose> log = read_trajectory_log(file);
    const auto in_order = poses_in_order(log, recording.size());
    if (!in_order) throw wrong_count(log.size(), recording, file);
    poses = *in_order;
  } else {
    throw Error("no poses of a known format", lines[0].location,
                "TUM has 8 numbers in a line, KITTI 12, g2o VERTEX_SE3:QUAT, COLMAP is images.txt");
  }
  if (std::none_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); }))
    throw Error(kNoPoseHere, {file.string(), 0, {}},
                fmt::format("{}the frames go from {} to {}, the first is {}", range,
                            format_time(recording.info().first_time), format_time(recording.info().last_time),
                            recording.name_of(0)));
  return poses;
}

}  // namespace loci::mapping
