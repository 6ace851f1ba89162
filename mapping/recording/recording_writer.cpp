#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>

#include "mapping/base/files.h"
#include "mapping/base/output_file.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/text.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/file_recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

std::string camera_text(const PinholeCamera& camera) {
  return fmt::format("width: {}, height: {}, fx: {}, fy: {}, cx: {}, cy: {}", camera.width, camera.height,
                     camera.fx, camera.fy, camera.cx, camera.cy);
}

/// Refuses a folder that is there and holds anything but what a RecordingWriter wrote; by force only what is
/// not a recording.
void require_own_or_empty(const fs::path& folder, bool force) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (!fs::is_directory(folder))
    throw Error("a file is in the way of the recording's folder", {folder.string(), 0, {}});
  if (fs::is_empty(folder)) return;
  const bool is_recording = fs::exists(folder / "recording.yaml");
  if (force && is_recording) return;
  const char* by_force = is_recording ? ", or replace it by --force" : "";
  if (!fs::exists(folder / kRecordingManifest))
    throw Error("the folder is not empty, and loci did not write it", {folder.string(), 0, {}},
                fmt::format("choose another folder, or empty this one{}", by_force));
  std::set<std::string> own = {kRecordingManifest};
  for (const std::string& name : split(read_file(folder / kRecordingManifest), '\n')) own.insert(name);
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory() && !entry.is_symlink()) continue;
    if (!own.contains(entry.path().lexically_relative(folder).string()))
      throw Error("this file is not part of the recording that would be replaced",
                  {entry.path().string(), 0, {}},
                  fmt::format("move it, or choose another folder{}", by_force));
  }
}

}  // namespace

cv::Mat raw_from_depth(const cv::Mat& depth, double unit_m) {
  cv::Mat raw(depth.rows, depth.cols, CV_16UC1, cv::Scalar(0));
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const double units = std::round(static_cast<double>(depth.at<float>(v, u)) / unit_m);
      if (units > 0 && units < 65535) raw.at<uint16_t>(v, u) = static_cast<uint16_t>(units);  // NaN stays 0.
    }
  }
  return raw;
}

RecordingWriter::RecordingWriter(const fs::path& folder, const RgbdCamera& camera, std::string map_frame,
                                 RecordingWriterOptions options)
    : folder_(folder), camera_(camera), map_frame_(std::move(map_frame)), options_(std::move(options)) {
  refuse_inputs(folder_, options_.inputs);
  require_own_or_empty(folder_, options_.force);
  partial_ = make_partial_folder(folder_);
  make_folder(partial_ / "frames");
}

RecordingWriter::~RecordingWriter() {
  std::error_code ignored;
  if (!partial_.empty()) fs::remove_all(partial_, ignored);
}

void RecordingWriter::add(const RgbdFrame& frame) {
  const std::string depth = fmt::format("frames/{:06}_depth.png", frame.index);
  write_image(partial_ / depth, raw_from_depth(frame.depth, options_.depth_unit_m));
  files_.push_back(depth);
  std::string color;
  if (!frame.color.empty()) {
    color = fmt::format("frames/{:06}_color.png", frame.index);
    write_image(partial_ / color, frame.color);
    files_.push_back(color);
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
  files_.push_back(fs::path(name).lexically_normal().string());
}

void RecordingWriter::finish() {
  std::string yaml =
      fmt::format("version: 1\ndepth_scale: {}\ninvalid_depth: [0, 65535]\n", options_.depth_unit_m);
  if (options_.time_assumed) yaml += "time_assumed: true\n";
  if (!options_.time_zone.empty()) yaml += fmt::format("time_zone: {}\n", options_.time_zone);
  if (!map_frame_.empty()) yaml += fmt::format("map_frame: {}\n", map_frame_);
  yaml += fmt::format("cameras:\n  depth: {{{}}}\n  color: {{{}, depth_from_color: [{}]}}\n",
                      camera_text(camera_.depth), camera_text(camera_.color),
                      fmt::join(values_from_pose(camera_.depth_from_color), ", "));
  add_file("recording.yaml", yaml);
  add_file("frames.csv", "index,time_ns,color,depth,x,y,z,qx,qy,qz,qw\n" + frames_csv_);
  if (!joints_csv_.empty()) add_file("joints.csv", "time_ns,joint,position\n" + joints_csv_);
  add_file(kRecordingManifest, joined(files_, "\n") + "\n");
  replace_folder();
}

void RecordingWriter::replace_folder() {
  require_own_or_empty(folder_, options_.force);  // Again: writing took its time.
  commit_partial_folder(partial_, folder_);
  partial_.clear();
}

}  // namespace loci::mapping
