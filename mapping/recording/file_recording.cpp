#include "mapping/recording/file_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mapping/image/image_io.h"

namespace loci::mapping {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

void check_size(int width, int height, const PinholeCamera& camera, const char* kind,
                const std::filesystem::path& path) {
  if (width == camera.width && height == camera.height) return;
  throw Error(fmt::format("the image is {} x {}, the {} camera {} x {}", width, height, kind, camera.width,
                          camera.height),
              {path.string(), 0, {}},
              "depth and colour do not belong together, or the camera is described wrongly");
}

}  // namespace

FileRecording::FileRecording(FileRecordingContent content)
    : content_(std::move(content)), metres_from_raw_(size_t{1} << 16) {
  if (content_.frames.empty()) throw Error("the recording has no frames", {content_.info.path, 0, {}});
  for (size_t raw = 0; raw < metres_from_raw_.size(); ++raw)
    metres_from_raw_[raw] = static_cast<float>(static_cast<double>(raw) * content_.depth_scale);
  for (const int raw : content_.invalid_depth)
    metres_from_raw_.at(static_cast<size_t>(raw)) = std::numeric_limits<float>::quiet_NaN();
  check_images();
  complete_info(content_.info, content_.frames);
}

const FrameFiles& FileRecording::files(size_t i) const {
  if (i >= content_.frames.size())
    throw Error(fmt::format("frame {} was asked for, the recording has {}", i, content_.frames.size()),
                {content_.info.path, 0, {}});
  return content_.frames[i];
}

void FileRecording::check_images() const {
  for (const FrameFiles& frame : content_.frames) {
    const ImageHeader depth = read_image_header(frame.depth);
    if (depth.channels != 1 || depth.bits != 16)
      throw Error(fmt::format("depth images are 16-bit grey PNG, this one has {} channels of {} bits",
                              depth.channels, depth.bits),
                  {frame.depth.string(), 0, {}});
    check_size(depth.width, depth.height, content_.info.camera.depth, "depth", frame.depth);
    if (frame.color.empty()) continue;
    const ImageHeader color = read_image_header(frame.color);
    check_size(color.width, color.height, content_.info.camera.color, "colour", frame.color);
  }
}

void complete_info(RecordingInfo& info, std::vector<FrameFiles>& frames) {
  const auto earlier = [](const FrameFiles& a, const FrameFiles& b) { return a.time_ns < b.time_ns; };
  if (!std::is_sorted(frames.begin(), frames.end(), earlier)) {
    const auto late = std::is_sorted_until(frames.begin(), frames.end(), earlier);
    info.problems.push_back(
        fmt::format("{}: the stamps go back here; frames are taken in order of time", late->place.text()));
    std::stable_sort(frames.begin(), frames.end(), earlier);
  }
  for (size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].time_ns != frames[i - 1].time_ns) continue;
    info.problems.push_back(fmt::format("{}: the same stamp as the frame before", frames[i].place.text()));
    break;
  }
  info.frames = frames.size();
  info.frames_with_pose = static_cast<size_t>(std::count_if(
      frames.begin(), frames.end(), [](const FrameFiles& f) { return f.map_from_camera.has_value(); }));
  info.first_time = frames.front().time_ns;
  info.last_time = frames.back().time_ns;
  if (info.frames_with_pose == 0) {
    info.map_frame.clear();
    info.guesses.emplace_back("no poses: the camera is taken as fixed");
  } else if (info.frames_with_pose < info.frames) {
    info.problems.push_back(
        fmt::format("{} of {} frames have no pose", info.frames - info.frames_with_pose, info.frames));
  }
  const auto without_color =
      std::count_if(frames.begin(), frames.end(), [](const FrameFiles& f) { return f.color.empty(); });
  if (without_color > 0)
    info.problems.push_back(fmt::format("{} of {} frames have no colour", without_color, info.frames));
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
  const cv::Mat raw = read_uint16(from.depth);
  check_size(raw.cols, raw.rows, frame.camera.depth, "depth", from.depth);
  frame.depth.create(raw.rows, raw.cols, CV_32F);
  for (int v = 0; v < raw.rows; ++v)
    std::transform(raw.ptr<uint16_t>(v), raw.ptr<uint16_t>(v) + raw.cols, frame.depth.ptr<float>(v),
                   [&](uint16_t value) { return metres_from_raw_[value]; });
  if (!from.color.empty()) {
    frame.color = read_color(from.color);
    check_size(frame.color.cols, frame.color.rows, frame.camera.color, "colour", from.color);
  }
  return frame;
}

std::optional<int64_t> number_in_name(const std::filesystem::path& path) {
  const std::string name = frame_name(path);
  const auto last = std::find_if(name.rbegin(), name.rend(), is_digit);
  const auto first = std::find_if_not(last, name.rend(), is_digit);
  const std::string digits(first.base(), last.base());
  if (digits.empty() || digits.size() > 9) return std::nullopt;  // Longer ones are stamps, not numbers.
  return std::stoll(digits);
}

TimeNs assumed_time(int64_t number) {
  constexpr TimeNs year_2000 = 946'684'800 * kSecond;
  return year_2000 + number * kSecond / 30;
}

std::string frame_name(const std::filesystem::path& depth_file) {
  std::string name = depth_file.stem().string();
  for (const char* suffix : {".depth", "_depth", "-depth"})
    if (name.ends_with(suffix)) name.resize(name.size() - 6);
  return name;
}

}  // namespace loci::mapping
