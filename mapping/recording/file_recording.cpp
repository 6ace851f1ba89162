#include "mapping/recording/file_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/text/text.h"
#include "mapping/base/text/text_file.h"
#include "mapping/base/time_limits.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/clock.h"
#include "mapping/recording/depth_image.h"
#include "mapping/recording/formats/layouts.h"

namespace loci::mapping {

namespace fs = std::filesystem;

namespace {

void check_size(int width, int height, const PinholeCamera& camera, bool is_assumed, const char* kind,
                const std::filesystem::path& path) {
  if (width == camera.width && height == camera.height) return;
  throw Error(
      fmt::format("the image is {} x {}, the {} camera {} x {}{}", width, height, kind, camera.width,
                  camera.height, is_assumed ? " as nothing describes it" : ""),
      {path.string(), 0, {}},
      is_assumed
          ? fmt::format("write a cameras.yaml beside the images: 'depth: {{width: {}, height: {}, fx: …, "
                        "fy: …, cx: …, cy: …}}', and 'color: {{…}}' if its camera is another one",
                        width, height)
          : "they do not belong together, or recording.yaml, cameras.yaml or the like describes another "
            "camera");
}

}  // namespace

FileRecording::FileRecording(FileRecordingContent content)
    : content_(std::move(content)), metres_from_raw_(size_t{1} << 16) {
  if (content_.frames.empty()) throw Error("the recording has no frames", {content_.info.path, 0, {}});
  for (size_t raw = 0; raw < metres_from_raw_.size(); ++raw)
    metres_from_raw_[raw] = static_cast<float>(static_cast<double>(raw) * content_.depth_scale);
  for (const int raw : content_.invalid_depth)
    metres_from_raw_.at(static_cast<size_t>(raw)) = std::numeric_limits<float>::quiet_NaN();
  content_.info.depth_unit_m = content_.depth_scale;  // check_images() knows better where depth is floats.
  check_images();
  complete_info(content_.info, content_.frames);
  set_correction();
}

const FrameFiles& FileRecording::files(size_t i) const {
  if (i >= content_.frames.size())
    throw Error(fmt::format("frame {} was asked for, the recording has {}", i, content_.frames.size()),
                {content_.info.path, 0, {}});
  return content_.frames[i];
}

void FileRecording::check_images() {
  std::vector<size_t> damaged;
  std::optional<Error> first;
  bool any_float = false;
  const auto header_of = [&](const auto& read_header, const fs::path& image, size_t i) {
    std::optional<decltype(read_header(image))> header;
    try {
      header = read_header(image);
    } catch (const Error& error) {
      if (!first) first = error;
      if (damaged.empty() || damaged.back() != i) damaged.push_back(i);
    }
    return header;
  };
  for (size_t i = 0; i < content_.frames.size(); ++i) {
    const FrameFiles& frame = content_.frames[i];
    if (const auto depth = header_of(read_depth_header, frame.depth, i)) {
      any_float = any_float || depth->is_float;
      check_size(depth->width, depth->height, content_.info.camera.depth, content_.camera_assumed, "depth",
                 frame.depth);
    }
    if (frame.color.empty() || frame.video_frame) continue;  // A video is of one size, known to its reader.
    if (const auto color = header_of(read_image_header, frame.color, i))
      check_size(color->width, color->height, content_.info.camera.color, content_.camera_assumed, "colour",
                 frame.color);
  }
  if (damaged.size() == content_.frames.size()) throw Error(*first);
  if (first)
    content_.info.problems.push_back(fmt::format("{} of {} frames have images that cannot be read ({})",
                                                 damaged.size(), content_.frames.size(), first->what()));
  constexpr double kUnitForFloats = 1.0 / 5000;  // 16 bits then hold 13 m, in steps below any sensor's noise.
  if (any_float) content_.info.depth_unit_m = kUnitForFloats;
  if (any_float)
    content_.info.guesses.push_back(
        content_.float_depth_scale == 1
            ? "floating-point depth is taken as metres"
            : fmt::format("floating-point depth is taken in units of {} m", content_.float_depth_scale));
}

FileRecordingContent content_in_world(const std::string& format, const std::filesystem::path& folder,
                                      bool time_assumed) {
  FileRecordingContent content;
  content.info.format = format;
  content.info.path = folder.string();
  content.info.map_frame = "world";
  content.info.levelled = false;
  content.info.time_assumed = time_assumed;
  return content;
}

namespace {

/// A line for the problems where some frames lack something, with the first of them.
void note_frames_without(const char* part, const std::vector<FrameFiles>& frames,
                         const std::function<bool(const FrameFiles&)>& lacks, RecordingInfo& info) {
  const auto count = std::ranges::count_if(frames, lacks);
  if (count == 0) return;
  std::string text = fmt::format("{} of {} frames have no {}", count, frames.size(), part);
  if (static_cast<size_t>(count) < frames.size())
    text += fmt::format(", the first is {}", std::ranges::find_if(frames, lacks)->location.text());
  info.problems.push_back(std::move(text));
}

}  // namespace

void complete_info(RecordingInfo& info, std::vector<FrameFiles>& frames) {
  for (const FrameFiles& frame : frames)
    if (!is_within_limits(frame.time_ns))
      throw Error("the time stamp is too far off", frame.location,
                  "stamps are nanoseconds since 1970, from 1824 to 2115");
  order_by_time(frames, info);
  for (size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].time_ns != frames[i - 1].time_ns) continue;
    info.problems.push_back(fmt::format("{}: the same stamp as the frame before", frames[i].location.text()));
    break;
  }
  info.frames = frames.size();
  info.frames_with_pose = static_cast<size_t>(std::count_if(
      frames.begin(), frames.end(), [](const FrameFiles& f) { return f.map_from_camera.has_value(); }));
  info.first_time = frames.front().time_ns;
  info.last_time = frames.back().time_ns;
  // Stamps that were made up come back from layouts that cannot say so.
  if (!info.time_assumed && info.first_time >= assumed_time(0) && info.first_time < assumed_time(0) + kDay) {
    info.time_assumed = true;
    info.guesses.emplace_back("no time stamps: those of 2000-01-01 are taken as made up");
  }
  if (info.frames_with_pose == 0) {
    info.map_frame.clear();
    info.guesses.emplace_back("no poses: fuse, track and run estimate them");
  } else {
    note_frames_without(
        "pose", frames, [](const FrameFiles& f) { return !f.map_from_camera; }, info);
  }
  note_frames_without(
      "colour", frames, [](const FrameFiles& f) { return f.color.empty(); }, info);
}

void read_images(RgbdFrame& frame, const std::function<cv::Mat()>& depth,
                 const std::function<cv::Mat()>& color) {
  const auto read_or_note = [&](const std::function<cv::Mat()>& read) -> cv::Mat {
    try {
      return read();
    } catch (const Error& error) {
      if (frame.damage.empty()) frame.damage = Error(error.message(), error.location()).what();
      return {};
    }
  };
  frame.depth = read_or_note(depth);
  if (frame.depth.empty())
    frame.depth = cv::Mat(frame.camera.depth.height, frame.camera.depth.width, CV_32F,
                          cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  frame.color = read_or_note(color);
}

RgbdFrame FileRecording::frame(size_t i) const {
  const FrameFiles& from = files(i);
  RgbdFrame frame;
  frame.index = from.index;
  frame.name = frame_name(from.depth);
  frame.time_ns = from.time_ns;
  frame.camera = content_.info.camera;
  frame.map_from_camera = from.map_from_camera;
  frame.joints = from.joints;
  read_images(
      frame, [&] { return depth_of(from); },
      [&]() -> cv::Mat {
        if (from.color.empty()) return {};
        cv::Mat color = from.video_frame ? content_.video->frame(*from.video_frame) : read_color(from.color);
        check_size(color.cols, color.rows, frame.camera.color, content_.camera_assumed, "colour", from.color);
        return color;
      });
  correction_of(from).apply(frame);
  return frame;
}

ImageCorrection FileRecording::correction_of(const FrameFiles& from) const {
  if (!from.lens) return correction_;
  const RgbdCamera& camera = content_.info.camera;
  return {Rectifier(camera.depth, content_.depth_distortion, from.lens->depth),
          Rectifier(camera.color, content_.color_distortion, from.lens->color), correction_.z_of_distance,
          correction_.close_grid_holes};
}

cv::Mat FileRecording::depth_of(const FrameFiles& from) const {
  const cv::Mat raw = read_depth_image(from.depth);
  check_size(raw.cols, raw.rows, content_.info.camera.depth, content_.camera_assumed, "depth", from.depth);
  cv::Mat depth(raw.rows, raw.cols, CV_32F);
  const auto scale = static_cast<float>(content_.float_depth_scale);
  for (int v = 0; v < raw.rows; ++v) {
    if (raw.type() == CV_16UC1)
      std::transform(raw.ptr<uint16_t>(v), raw.ptr<uint16_t>(v) + raw.cols, depth.ptr<float>(v),
                     [&](uint16_t value) { return metres_from_raw_[value]; });
    else
      std::transform(raw.ptr<float>(v), raw.ptr<float>(v) + raw.cols, depth.ptr<float>(v),
                     [&](float value) { return metres_or_nan(value * scale); });
  }
  if (from.confidence.empty()) return depth;
  const std::string bytes = read_file(from.confidence);
  const cv::Mat confidence = decode_image({bytes.begin(), bytes.end()}, from.confidence.string());
  if (confidence.type() != CV_8UC1 || confidence.size() != depth.size())
    throw Error("a confidence image has 8 bits and the size of the depth image",
                {from.confidence.string(), 0, {}});
  depth.setTo(std::numeric_limits<float>::quiet_NaN(), confidence < content_.min_confidence);
  return depth;
}

void FileRecording::set_correction() {
  const auto set = [&](const PinholeCamera& camera, const Distortion& distortion, Rectifier& rectifier,
                       const char* kind) {
    if (distortion.model == Distortion::Model::none) return;
    rectifier = Rectifier(camera, distortion);
    content_.info.guesses.push_back(fmt::format("{} images are undistorted on reading", kind));
  };
  set(content_.info.camera.depth, content_.depth_distortion, correction_.depth, "depth");
  set(content_.info.camera.color, content_.color_distortion, correction_.color, "colour");
  if (content_.depth_along_rays) {
    correction_.z_of_distance = z_along_rays(content_.info.camera.depth);
    content_.info.guesses.emplace_back("depth along rays is turned into z on reading");
  }
  const std::optional<cv::Mat> depth = first_depth();
  if (!depth) return;
  if (const std::string why = implausible_because(*depth); !why.empty())
    content_.info.problems.push_back(why);
  // Depth in the colour camera was warped there.
  correction_.close_grid_holes =
      content_.info.camera.depth == content_.info.camera.color && has_grid_holes(*depth);
  if (correction_.close_grid_holes)
    content_.info.guesses.emplace_back("depth was warped to the colour camera: the grid of holes is closed");
}

std::optional<cv::Mat> FileRecording::first_depth() const {
  for (const FrameFiles& frame : content_.frames) {
    try {
      return depth_of(frame);
    } catch (const Error&) {  // frame() names it.
    }
  }
  return std::nullopt;
}

std::string implausible_because(const cv::Mat& depth) {
  constexpr double kMin = 0.1, kMax = 8;
  std::vector<float> measured;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      if (const float z = depth.at<float>(v, u); z > 0) measured.push_back(z);
  if (measured.empty()) return {};
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  const auto median = static_cast<double>(*middle);
  if (median > kMin && median < kMax) return {};
  return fmt::format(
      "the median depth of the first frame is {:.3g} m: check its unit (depth_scale, "
      "unit_m; of floating-point depth float_depth_scale, float_unit_m)",
      median);
}

std::optional<Isometry3d> pose_unless_lost(const Eigen::Matrix4d& matrix, const FileLocation& location) {
  const bool is_lost = !matrix.allFinite() || matrix.topLeftCorner<3, 3>().isZero(0);
  return is_lost ? std::nullopt : std::optional(pose_from_matrix(matrix, location));
}

std::optional<Isometry3d> pose_unless_lost(const std::array<double, 7>& values,
                                           const FileLocation& location) {
  const Eigen::Map<const Eigen::Matrix<double, 7, 1>> all(values.data());
  const bool is_lost = !all.allFinite() || all.tail<4>().isZero(0);
  return is_lost ? std::nullopt : std::optional(pose_from_values(values, location));
}

std::optional<Isometry3d> read_pose_file(const fs::path& path) {
  const std::string text = read_text(path);
  std::vector<double> values;
  for (const char* at = text.c_str(); values.size() < 16;) {
    char* end = nullptr;
    values.push_back(std::strtod(at, &end));  // Reads "nan" and "-inf" of lost frames, too.
    if (end == at)
      throw Error(fmt::format("a pose is 16 numbers, this file has {}", values.size() - 1),
                  {path.string(), 0, {}});
    at = end;
  }
  return pose_from_rows(values, {path.string(), 0, {}});
}

std::optional<Isometry3d> pose_from_rows(const std::vector<double>& rows, const FileLocation& location) {
  if (rows.size() != 16) throw Error("a pose is 16 numbers", location);
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = rows[static_cast<size_t>(i)];
  return pose_unless_lost(matrix, location);
}

bool is_usable(const PinholeCamera& camera) {
  constexpr int kMaxSide = 1 << 15;
  constexpr int64_t kMaxPixels = int64_t{1} << 26;  // Images that cannot be read are of as many.
  return camera.width >= 1 && camera.height >= 1 && camera.width <= kMaxSide && camera.height <= kMaxSide &&
         int64_t{camera.width} * camera.height <= kMaxPixels &&
         std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy) && camera.fx > 0 && camera.fy > 0;
}

PinholeCamera scaled_camera(const PinholeCamera& camera, int width, int height) {
  const double x = double(width) / camera.width, y = double(height) / camera.height;
  return {
      width, height, camera.fx * x, camera.fy * y, (camera.cx + 0.5) * x - 0.5, (camera.cy + 0.5) * y - 0.5};
}

void fit_cameras_to_images(FileRecordingContent& content) {
  const auto fit = [&](PinholeCamera& camera, int width, int height, const char* kind) {
    const bool same_aspect = int64_t{width} * camera.height == int64_t{height} * camera.width;
    if (width == camera.width || width < 1 || !same_aspect) return;
    camera = scaled_camera(camera, width, height);
    content.info.guesses.push_back(
        fmt::format("the {} camera was scaled to its images, {} x {}", kind, width, height));
  };
  try {
    const FrameFiles& first = content.frames.at(0);
    const DepthHeader depth = read_depth_header(first.depth);
    fit(content.info.camera.depth, depth.width, depth.height, "depth");
    if (first.color.empty()) return;
    const ImageHeader color = read_image_header(first.color);
    fit(content.info.camera.color, color.width, color.height, "colour");
  } catch (const Error&) {
    // What cannot be read is named when all images are checked.
  }
}

PinholeCamera checked_camera(const PinholeCamera& camera, const FileLocation& location) {
  if (!is_usable(camera))
    throw Error("a camera has positive sizes and focal lengths (pixels)", location,
                "up to 67 million pixels are read");
  const auto is_central = [](double centre, int size) {
    return centre > 0.25 * size && centre < 0.75 * size;
  };
  if (!is_central(camera.cx, camera.width) || !is_central(camera.cy, camera.height))
    throw Error(fmt::format("the principal point {:g} {:g} is far from the middle of {} x {} pixels",
                            camera.cx, camera.cy, camera.width, camera.height),
                location, "check the order of the matrix and the size of the images");
  return camera;
}

double number_of(const Json& json) {
  return json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Json member_of(const Json& json, const char* key) {
  return json.is_object() ? json.value(key, Json()) : Json();
}

int pixels_of(double number) {
  return number >= 0 && number <= std::numeric_limits<int>::max() ? static_cast<int>(number) : 0;
}

std::vector<double> numbers_in(const fs::path& path, size_t min_count) {
  std::vector<double> numbers;
  for (const std::string& word : words_of(read_text(path), " ,;\t\r\n")) {
    char* end = nullptr;
    numbers.push_back(std::strtod(word.c_str(), &end));  // "-inf" marks frames without pose.
    if (*end != '\0') throw Error(fmt::format("'{}' is not a number", word), {path.string(), 0, {}});
  }
  if (numbers.size() < min_count)
    throw Error(fmt::format("{} numbers are needed, there are {}", min_count, numbers.size()),
                {path.string(), 0, {}});
  return numbers;
}

fs::path beside_or_above(const fs::path& folder, const char* name) {
  const fs::path absolute = fs::absolute(folder).lexically_normal();
  const fs::path clean = absolute.has_filename() ? absolute : absolute.parent_path();
  for (const fs::path& place : {clean, clean.parent_path()})
    if (fs::is_regular_file(place / name)) return place / name;
  return {};
}

double float_scale_of(const Config& config, const char* key) {
  const double scale = config.get<double>(key, 1);
  if (!(scale > 0 && scale <= 1))
    throw Error("the unit of floating-point depth is out of bounds", config.location(key),
                "it is metres per unit: 1, or 0.001 for millimetres");
  return scale;
}

bool read_cameras(const fs::path& path, FileRecordingContent& content) {
  const Config config = Config::read(path);
  const Config depth = config.map("depth");
  if (depth.has("depth_scale"))
    throw Error("unknown key 'depth_scale'", depth.location("depth_scale"),
                "it is unit_m here, metres per unit: 0.001 for millimetres");
  RgbdCamera& camera = content.info.camera;
  const bool has_camera = camera.depth.width == 0 || depth.has("width") || depth.has("fx");
  if (has_camera) {
    camera.depth = read_pinhole(depth);
    content.depth_distortion = content.color_distortion = {};
  }
  content.depth_scale = depth.get<double>("unit_m", 0.001);
  if (!(content.depth_scale > 0 && content.depth_scale < 1))
    throw Error("unit_m is out of bounds", depth.location("unit_m"),
                "it is metres per unit, e.g. 0.001 for millimetres");
  content.float_depth_scale = float_scale_of(depth, "float_unit_m");
  content.invalid_depth = depth.get<std::vector<int>>("invalid", {0, 65535});
  for (const int raw : content.invalid_depth)
    if (raw < 0 || raw > 65535) throw Error("depth values are 0 to 65535", depth.location("invalid"));
  content.depth_along_rays = depth.get<bool>("along_rays", false);
  depth.finish();
  const Config color = config.map("color");
  if (config.has("color"))
    camera.color = read_pinhole(color);
  else if (has_camera)
    camera.color = camera.depth;
  color.finish();
  RecordingInfo& info = content.info;
  if (has_camera && !config.has("color_from_depth")) {  // Not that of the camera that was assumed.
    camera.depth_from_color = Isometry3d::Identity();
    info.guesses.emplace_back(config.has("color")
                                  ? "cameras.yaml has no color_from_depth: colour is taken as seen from the "
                                    "depth camera's place"
                                  : "no colour camera described: colour is taken as registered with depth");
  }
  if (config.has("color_from_depth")) {
    const Config transform = config.map("color_from_depth");
    const auto r = transform.require<std::array<double, 9>>("R");
    const auto t = transform.require<std::array<double, 3>>("t");
    transform.finish();
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = r[static_cast<size_t>(i)];
    for (int i = 0; i < 3; ++i) matrix(i, 3) = t[static_cast<size_t>(i)];
    camera.depth_from_color = pose_from_matrix(matrix, config.location("color_from_depth")).inverse();
  }
  config.finish();
  return has_camera;
}

}  // namespace loci::mapping
