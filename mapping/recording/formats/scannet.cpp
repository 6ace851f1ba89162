#include "mapping/recording/formats/scannet.h"

#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/image/image_io.h"
#include "mapping/recording/compression.h"
#include "mapping/recording/formats/layouts.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kSensVersion = 4;
constexpr uint64_t kMaxSensorName = 1024;
constexpr uint64_t kMaxImageBytes = uint64_t{1} << 28;
constexpr uint32_t kMaxImageSide = 1 << 14;

template <typename T>
T number_at(std::string_view bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

}  // namespace

bool is_sens(const fs::path& path) {
  if (path.extension() != ".sens" || !fs::is_regular_file(path)) return false;
  std::ifstream file(path, std::ios::binary);
  uint32_t version = 0;
  return file.read(reinterpret_cast<char*>(&version), sizeof version) && version == kSensVersion;
}

std::string SensRecording::read(uint64_t at, uint64_t count) const {
  const std::lock_guard lock(mutex_);
  if (at > file_size_ || count > file_size_ - at)
    throw Error("the file is truncated", {path_.string(), 0, {}});
  std::string bytes(count, '\0');
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(at));
  if (!file_.read(bytes.data(), static_cast<std::streamsize>(count)))
    throw Error("reading failed", {path_.string(), 0, {}});
  return bytes;
}

template <typename T>
T SensRecording::take() {
  const T value = number_at<T>(read(at_, sizeof(T)));
  at_ += sizeof(T);
  return value;
}

SensRecording::SensRecording(const fs::path& path) : path_(path), file_(path, std::ios::binary) {
  file_size_ = fs::file_size(path);
  info_.format = "scannet";
  info_.path = path.string();
  info_.map_frame = "world";
  info_.levelled = false;
  read_header();
  for (uint64_t i = 0; i < frames_claimed_; ++i)
    if (!read_frame(static_cast<int64_t>(i))) {
      info_.problems.push_back(
          fmt::format("{}: truncated: {} of {} frames are whole", path_.string(), i, frames_claimed_));
      break;
    }
  if (frames_.empty()) throw Error("no frame of this file is whole", {path_.string(), 0, {}});
  if (info_.time_assumed)
    info_.guesses.emplace_back("no date in the stamps: they begin at 2000-01-01T00:00:00Z");
  complete_info(info_, frames_);
}

void SensRecording::read_header() {
  const FileLocation location{path_.string(), 0, "header"};
  take<uint32_t>();  // version, as is_sens() saw
  const auto name = take<uint64_t>();
  if (name > kMaxSensorName) throw Error("the name of the sensor is too long", location);
  at_ += name;
  std::array<std::array<float, 16>, 4> matrices{};  // intrinsics and extrinsics of colour, then of depth
  for (auto& matrix : matrices)
    for (float& value : matrix) value = take<float>();
  const auto color = take<int32_t>(), depth = take<int32_t>();
  raw_color_ = color == 0;
  has_color_ = raw_color_ || color == 1 || color == 2;
  zlib_depth_ = depth == 1;
  if (depth != 0 && depth != 1)
    throw Error(fmt::format("depth of compression {} is not read", depth), location);
  if (!has_color_)
    info_.problems.emplace_back("colour images are neither raw, PNG nor JPEG and are not read");
  std::array<uint32_t, 4> size{};  // colour width and height, depth width and height
  for (uint32_t& value : size) {
    value = take<uint32_t>();
    if (value < 1 || value > kMaxImageSide) throw Error("an image size is out of bounds", location);
  }
  depth_shift_ = take<float>();
  if (!(depth_shift_ >= 1 && depth_shift_ <= 1e6F)) throw Error("the depth shift is out of bounds", location);
  info_.depth_unit_m = 1 / static_cast<double>(depth_shift_);
  const auto camera = [&](const std::array<float, 16>& k, uint32_t width, uint32_t height) {
    return checked_camera({int(width), int(height), double(k[0]), double(k[5]), double(k[2]), double(k[6])},
                          location);
  };
  info_.camera.color = camera(matrices[0], size[0], size[1]);
  info_.camera.depth = camera(matrices[2], size[2], size[3]);
  frames_claimed_ = take<uint64_t>();
}

bool SensRecording::read_frame(int64_t index) {
  constexpr uint64_t kFrameHead = 16 * sizeof(float) + 4 * sizeof(uint64_t);
  if (at_ > file_size_ || kFrameHead > file_size_ - at_) return false;
  std::vector<double> matrix;
  for (int i = 0; i < 16; ++i) {
    matrix.push_back(static_cast<double>(take<float>()));
  }
  take<uint64_t>();  // stamp of colour
  const auto microseconds = take<uint64_t>();
  Images images;
  images.color_size = take<uint64_t>();
  images.depth_size = take<uint64_t>();
  if (images.color_size > kMaxImageBytes || images.depth_size > kMaxImageBytes ||
      images.color_size + images.depth_size > file_size_ - at_)
    return false;
  images.color_at = at_;
  images.depth_at = at_ + images.color_size;
  at_ = images.depth_at + images.depth_size;
  FrameFiles frame;
  frame.index = index;
  frame.location = {fmt::format("{}[{}]", path_.string(), index), 0, {}};
  frame.depth = path_;
  if (has_color_ && images.color_size > 0) frame.color = path_;
  const bool stamped = microseconds > 0 && microseconds < (uint64_t{1} << 51);
  frame.time_ns =
      assumed_time(stamped ? 0 : index) + (stamped ? static_cast<TimeNs>(1000 * microseconds) : 0);
  info_.time_assumed = true;
  frame.map_from_camera = pose_from_rows(matrix, frame.location);
  frames_.push_back(std::move(frame));
  images_.push_back(images);
  return true;
}

RgbdFrame SensRecording::frame(size_t i) const {
  const FrameFiles& from = frames_.at(i);
  const Images& images = images_.at(static_cast<size_t>(from.index));
  RgbdFrame frame;
  frame.index = from.index;
  frame.name = fmt::format("frame-{:06}", from.index);
  frame.time_ns = from.time_ns;
  frame.camera = info_.camera;
  frame.map_from_camera = from.map_from_camera;
  read_images(
      frame, [&] { return depth_image(images, from.location); },
      [&] { return from.color.empty() ? cv::Mat() : color_image(images, from.location); });
  return frame;
}

cv::Mat SensRecording::depth_image(const Images& images, const FileLocation& location) const {
  const PinholeCamera& camera = info_.camera.depth;
  const size_t bytes = 2 * static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  std::string raw = read(images.depth_at, images.depth_size);
  try {
    if (zlib_depth_) raw = decompress("zlib", raw, bytes);
  } catch (const Error& error) {
    throw Error(error.message(), location);
  }
  if (raw.size() != bytes) throw Error("the depth image has another size than its camera", location);
  cv::Mat depth(camera.height, camera.width, CV_32F);
  for (size_t p = 0; p < depth.total(); ++p) {
    const auto value = number_at<uint16_t>(std::string_view(raw).substr(2 * p));
    depth.ptr<float>()[p] = value == 0 || value == 65535 ? std::numeric_limits<float>::quiet_NaN()
                                                         : static_cast<float>(value) / depth_shift_;
  }
  return depth;
}

cv::Mat SensRecording::color_image(const Images& images, const FileLocation& location) const {
  std::string packed = read(images.color_at, images.color_size);
  const PinholeCamera& camera = info_.camera.color;
  cv::Mat color;
  if (!raw_color_)
    color = decode_image({packed.begin(), packed.end()}, location.text());
  else if (packed.size() ==
           size_t{3} * static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height))
    cv::cvtColor(cv::Mat(camera.height, camera.width, CV_8UC3, packed.data()), color, cv::COLOR_RGB2BGR);
  if (color.type() != CV_8UC3 || color.cols != camera.width || color.rows != camera.height)
    throw Error("the colour image is not what its camera takes", location);
  return color;
}

}  // namespace loci::mapping
