#include "mapping/recording/ros_messages.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <limits>

#include "mapping/base/error.h"
#include "mapping/image/image_io.h"

namespace loci::mapping {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Reads what ROS serialised: little endian, without padding, lengths before texts and arrays.
class Bytes {
 public:
  Bytes(std::string_view bytes, std::string where) : bytes_(bytes), where_(std::move(where)) {}

  template <typename T>
  T take() {
    T value{};
    std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view text() { return next(take<uint32_t>()); }
  TimeNs time() {
    const auto seconds = take<uint32_t>();
    return static_cast<TimeNs>(seconds) * kSecond + static_cast<TimeNs>(take<uint32_t>());
  }
  RosHeader header() {
    take<uint32_t>();  // seq
    RosHeader header;
    header.stamp_ns = time();
    header.frame = frame();
    return header;
  }
  std::string frame() {
    std::string_view name = text();
    if (name.starts_with('/')) name.remove_prefix(1);
    return std::string(name);
  }
  const std::string& where() const { return where_; }
  FileLocation location() const { return {where_, 0, {}}; }

 private:
  std::string_view next(size_t count) {
    if (count > bytes_.size() - at_) throw Error("the message is too short", location());
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }

  std::string_view bytes_;
  size_t at_ = 0;
  std::string where_;
};

/// sensor_msgs/Image.
struct RawImage {
  RosHeader header;
  int height = 0, width = 0;
  std::string encoding;
  bool big_endian = false;
  size_t step = 0;
  std::string_view data;

  explicit RawImage(Bytes bytes) {
    header = bytes.header();
    height = static_cast<int>(bytes.take<uint32_t>());
    width = static_cast<int>(bytes.take<uint32_t>());
    encoding = bytes.text();
    big_endian = bytes.take<uint8_t>() != 0;
    step = bytes.take<uint32_t>();
    data = bytes.text();
  }

  /// The rows, which stay where they are.
  cv::Mat pixels(int type, const FileLocation& location) const {
    const size_t row = static_cast<size_t>(width) * CV_ELEM_SIZE(type);
    if (height < 1 || width < 1 || height > 1 << 15 || width > 1 << 15 || step < row ||
        data.size() < step * static_cast<size_t>(height - 1) + row)
      throw Error(fmt::format("{} x {} pixels in {} bytes do not fit", width, height, data.size()), location);
    if (big_endian && CV_ELEM_SIZE1(type) > 1)
      throw Error("pixels are big endian, which is not read", location);
    return {height, width, type, const_cast<char*>(data.data()), step};
  }
};

/// sensor_msgs/CompressedImage.
struct CompressedImage {
  RosHeader header;
  std::string format;
  std::string_view data;

  explicit CompressedImage(Bytes bytes) {
    header = bytes.header();
    format = bytes.text();
    data = bytes.text();
  }
  cv::Mat decode(size_t skipped, const std::string& where) const {
    const std::string_view image = data.substr(std::min(skipped, data.size()));
    return decode_image({image.begin(), image.end()}, where);
  }
};

cv::Mat metres_from(const cv::Mat& raw, const FileLocation& location) {
  cv::Mat depth(raw.size(), CV_32F);
  if (raw.type() != CV_16UC1 && raw.type() != CV_32FC1)
    throw Error("depth images have one channel of 16-bit millimetres or 32-bit metres", location);
  for (int v = 0; v < raw.rows; ++v)
    for (int u = 0; u < raw.cols; ++u) {
      float metres = kNan;
      if (raw.type() == CV_32FC1) {
        std::memcpy(&metres, raw.ptr(v) + 4 * u, 4);
      } else {
        uint16_t millimetres = 0;
        std::memcpy(&millimetres, raw.ptr(v) + 2 * u, 2);
        if (millimetres != 0 && millimetres != 65535)
          metres = static_cast<float>(0.001 * static_cast<double>(millimetres));
      }
      depth.at<float>(v, u) = metres > 0 && metres < std::numeric_limits<float>::infinity() ? metres : kNan;
    }
  return depth;
}

/// BGR from channels in the order of `order`, e.g. {2, 1, 0} for rgb.
cv::Mat picked(const cv::Mat& pixels, std::array<int, 3> order) {
  cv::Mat color(pixels.size(), CV_8UC3);
  const int channels = pixels.channels();
  for (int v = 0; v < pixels.rows; ++v)
    for (int u = 0; u < pixels.cols; ++u)
      for (int c = 0; c < 3; ++c)
        color.at<cv::Vec3b>(v, u)[c] = pixels.ptr(v)[channels * u + order[static_cast<size_t>(c)]];
  return color;
}

}  // namespace

RosHeader read_ros_header(std::string_view message, const std::string& where) {
  return Bytes(message, where).header();
}

std::string read_ros_encoding(std::string_view message, bool compressed, const std::string& where) {
  const Bytes bytes(message, where);
  return compressed ? CompressedImage(bytes).format : RawImage(bytes).encoding;
}

bool is_depth_encoding(const std::string& encoding) {
  return encoding.starts_with("16UC1") || encoding.starts_with("32FC1") || encoding == "mono16" ||
         encoding.find("compressedDepth") != std::string::npos;
}

cv::Mat read_ros_depth(std::string_view message, bool compressed, const std::string& where) {
  const Bytes bytes(message, where);
  if (compressed) {
    const CompressedImage image(bytes);
    if (image.format.starts_with("32FC1"))
      throw Error("compressedDepth of 32FC1 is quantised inverse depth, which is not read", bytes.location());
    // Twelve bytes of compressedDepth's own header stand before the PNG.
    return metres_from(image.decode(12, where), bytes.location());
  }
  const RawImage image(bytes);
  return metres_from(image.pixels(image.encoding == "32FC1" ? CV_32FC1 : CV_16UC1, bytes.location()),
                     bytes.location());
}

cv::Mat read_ros_color(std::string_view message, bool compressed, const std::string& where) {
  const Bytes bytes(message, where);
  if (compressed) {
    const cv::Mat pixels = CompressedImage(bytes).decode(0, where);
    if (pixels.depth() != CV_8U) throw Error("colour images have 8 bits per channel", bytes.location());
    return pixels.channels() == 3   ? pixels
           : pixels.channels() == 4 ? picked(pixels, {0, 1, 2})
                                    : picked(pixels, {0, 0, 0});
  }
  const RawImage image(bytes);
  if (image.encoding == "bgr8") return image.pixels(CV_8UC3, bytes.location()).clone();
  if (image.encoding == "rgb8") return picked(image.pixels(CV_8UC3, bytes.location()), {2, 1, 0});
  if (image.encoding == "rgba8") return picked(image.pixels(CV_8UC4, bytes.location()), {2, 1, 0});
  if (image.encoding == "bgra8") return picked(image.pixels(CV_8UC4, bytes.location()), {0, 1, 2});
  if (image.encoding == "mono8") return picked(image.pixels(CV_8UC1, bytes.location()), {0, 0, 0});
  throw Error(fmt::format("colour images of encoding '{}' are not read", image.encoding), bytes.location());
}

PinholeCamera read_ros_camera(std::string_view message, const std::string& where) {
  Bytes bytes(message, where);
  bytes.header();
  PinholeCamera camera;
  camera.height = static_cast<int>(bytes.take<uint32_t>());
  camera.width = static_cast<int>(bytes.take<uint32_t>());
  bytes.text();  // distortion model
  const auto coefficients = bytes.take<uint32_t>();
  for (uint32_t i = 0; i < coefficients; ++i) bytes.take<double>();
  const auto k = bytes.take<std::array<double, 9>>();
  bytes.take<std::array<double, 9>>();  // R
  const auto p = bytes.take<std::array<double, 12>>();
  const bool projected = p[0] > 0;
  camera.fx = projected ? p[0] : k[0];
  camera.cx = projected ? p[2] : k[2];
  camera.fy = projected ? p[5] : k[4];
  camera.cy = projected ? p[6] : k[5];
  if (camera.width < 1 || camera.height < 1 || !(camera.fx > 0) || !(camera.fy > 0))
    throw Error("the camera is not calibrated", bytes.location());
  return camera;
}

std::vector<RosTransform> read_ros_transforms(std::string_view message, const std::string& where) {
  Bytes bytes(message, where);
  std::vector<RosTransform> transforms;
  const auto count = bytes.take<uint32_t>();
  for (uint32_t i = 0; i < count; ++i) {
    RosTransform transform;
    const RosHeader header = bytes.header();
    transform.stamp_ns = header.stamp_ns;
    transform.parent = header.frame;
    transform.child = bytes.frame();
    FileLocation location = bytes.location();
    location.key = transform.child;
    transform.parent_from_child = pose_from_values(bytes.take<std::array<double, 7>>(), location);
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

}  // namespace loci::mapping
