#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr double kDepthScale = 0.001;

cv::Mat raw_from_depth(const cv::Mat& depth) {
  cv::Mat raw(depth.rows, depth.cols, CV_16UC1, cv::Scalar(0));
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const double units = std::round(static_cast<double>(depth.at<float>(v, u)) / kDepthScale);
      if (units > 0 && units < 65535) raw.at<uint16_t>(v, u) = static_cast<uint16_t>(units);  // NaN stays 0.
    }
  }
  return raw;
}

std::string camera_text(const PinholeCamera& camera) {
  return fmt::format("width: {}, height: {}, fx: {}, fy: {}, cx: {}, cy: {}", camera.width, camera.height,
                     camera.fx, camera.fy, camera.cx, camera.cy);
}

}  // namespace

RecordingWriter::RecordingWriter(fs::path folder, const RgbdCamera& camera, std::string map_frame,
                                 bool time_assumed)
    : folder_(std::move(folder)),
      partial_(folder_.lexically_normal()),
      camera_(camera),
      map_frame_(std::move(map_frame)),
      time_assumed_(time_assumed) {
  if (!partial_.has_filename()) partial_ = partial_.parent_path();  // "REC/" and "REC" are the same folder.
  folder_ = partial_;
  partial_ += ".partial";
  if (fs::exists(folder_) && !fs::is_directory(folder_))
    throw Error("a file is in the way of the recording's folder", {folder_.string(), 0, {}});
  if (fs::exists(folder_) && !fs::is_empty(folder_) && !fs::exists(folder_ / "recording.yaml"))
    throw Error("the folder is not empty and holds no recording", {folder_.string(), 0, {}},
                "choose another folder, or empty this one");
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
  make_folder(partial_ / "frames");
}

RecordingWriter::~RecordingWriter() {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

void RecordingWriter::add(const RgbdFrame& frame) {
  const std::string depth = fmt::format("frames/{:06}_depth.png", frame.index);
  write_image(partial_ / depth, raw_from_depth(frame.depth));
  std::string color;
  if (!frame.color.empty()) {
    color = fmt::format("frames/{:06}_color.png", frame.index);
    write_image(partial_ / color, frame.color);
  }
  frames_csv_ += fmt::format("{},{},{},{}", frame.index, frame.time_ns, color, depth);
  if (frame.map_from_camera) {
    for (const double value : values_from_pose(*frame.map_from_camera))
      frames_csv_ += fmt::format(",{:.9f}", value);
  } else {
    frames_csv_ += ",,,,,,,";
  }
  frames_csv_ += '\n';
  JointState joints = frame.joints;
  for (const auto& [name, position] : joints_) joints.try_emplace(name, 0);  // Not named any more: back at 0.
  for (const auto& [name, position] : joints) {
    const auto before = joints_.find(name);
    if (before != joints_.end() && before->second == position) continue;
    joints_csv_ += fmt::format("{},{},{:.6f}\n", frame.time_ns, name, position);
    joints_[name] = position;
  }
}

void RecordingWriter::add_file(const std::string& name, std::string_view bytes) {
  const fs::path file = partial_ / name;
  make_folder(file.parent_path());
  write_file_atomically(file, bytes);
}

void RecordingWriter::finish() {
  std::string yaml = fmt::format("version: 1\ndepth_scale: {}\ninvalid_depth: [0, 65535]\n", kDepthScale);
  if (time_assumed_) yaml += "time_assumed: true\n";
  if (!map_frame_.empty()) yaml += fmt::format("map_frame: {}\n", map_frame_);
  yaml += fmt::format("cameras:\n  depth: {{{}}}\n  color: {{{}, depth_from_color: [{}]}}\n",
                      camera_text(camera_.depth), camera_text(camera_.color),
                      fmt::join(values_from_pose(camera_.depth_from_color), ", "));
  add_file("recording.yaml", yaml);
  add_file("frames.csv", "index,time_ns,color,depth,x,y,z,qx,qy,qz,qw\n" + frames_csv_);
  if (!joints_csv_.empty()) add_file("joints.csv", "time_ns,joint,position\n" + joints_csv_);
  replace_folder();
}

void RecordingWriter::replace_folder() const {
  fs::path old = folder_;
  old += ".old";
  std::error_code code;
  fs::remove_all(old, code);
  const bool replaces = fs::exists(folder_);
  if (replaces) fs::rename(folder_, old, code);
  if (!code) {
    fs::rename(partial_, folder_, code);
    std::error_code ignored;
    if (code && replaces) fs::rename(old, folder_, ignored);
  }
  if (code)
    throw Error("the recording cannot be put in its place: " + code.message(), {folder_.string(), 0, {}},
                "what was there before is unchanged");
  fs::remove_all(old, code);
}

}  // namespace loci::mapping
