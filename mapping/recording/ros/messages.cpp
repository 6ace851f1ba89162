#include "mapping/recording/ros/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/depth_image.h"
#include "mapping/recording/formats/layouts.h"
#include "mapping/recording/ros/rvl.h"

namespace loci::mapping {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr uint32_t kMaxSide = (1U << 15) + 1;  ///< larger images are refused

/// Reads the fields of a message. ROS 1: little endian without padding. CDR, as ROS 2 has it: a head of four
/// bytes with the byte order, numbers aligned to their size from there, texts with a zero at their end.
class Fields {
 public:
  explicit Fields(const RosMessage& message)
      : bytes_(message.bytes), cdr_(message.serialization == Serialization::cdr), where_(message.where) {
    if (message.serialization == Serialization::other)
      throw Error("the message is neither of ROS 1 nor CDR", location());
    if (!cdr_) return;
    const auto kind = static_cast<uint8_t>(next(4)[1]);
    if (kind != 0 && kind != 1 && kind != 6 && kind != 7)
      throw Error(fmt::format("CDR of kind {} is not read", kind), location());
    swapped_ = kind % 2 == 0;
    max_alignment_ = kind >= 6 ? 4 : 8;
    bytes_.remove_prefix(4);
    at_ = 0;
  }

  template <typename T>
  T take() {
    static_assert(std::is_arithmetic_v<T>);
    if (cdr_) {
      const size_t alignment = std::min(sizeof(T), max_alignment_);
      next((alignment - at_ % alignment) % alignment);
    }
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), next(sizeof(T)).data(), sizeof(T));
    if (swapped_) std::reverse(raw.begin(), raw.end());
    T value{};
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  template <size_t count>
  std::array<double, count> take_doubles() {
    std::array<double, count> values{};
    for (double& value : values) value = take<double>();
    return values;
  }
  std::vector<double> doubles() {
    const auto count = take<uint32_t>();
    if (count > bytes_.size() / sizeof(double)) throw Error("the message is too short", location());
    std::vector<double> values(count);
    for (double& value : values) value = take<double>();
    return values;
  }
  std::string_view data() { return next(take<uint32_t>()); }
  std::string_view text() {
    std::string_view characters = data();
    if (cdr_ && !characters.empty() && characters.back() == '\0') characters.remove_suffix(1);
    return characters;
  }
  RosHeader header() {
    if (!cdr_) take<uint32_t>();  // seq
    RosHeader header;
    const TimeNs seconds = cdr_ ? TimeNs{take<int32_t>()} : TimeNs{take<uint32_t>()};
    header.stamp_ns = seconds * kSecond + TimeNs{take<uint32_t>()};
    header.frame = frame();
    return header;
  }
  std::string frame() {
    std::string_view name = text();
    if (name.starts_with('/')) name.remove_prefix(1);
    return std::string(name);
  }
  bool swapped() const { return swapped_; }
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
  bool cdr_ = false;
  bool swapped_ = false;
  size_t max_alignment_ = 8;
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

  explicit RawImage(Fields bytes) {
    header = bytes.header();
    height = static_cast<int>(std::min(bytes.take<uint32_t>(), kMaxSide));
    width = static_cast<int>(std::min(bytes.take<uint32_t>(), kMaxSide));
    encoding = bytes.text();
    big_endian = bytes.take<uint8_t>() != 0;
    step = bytes.take<uint32_t>();
    data = bytes.data();
  }

  /// The rows, which stay where they are; swapped in a copy where they are big endian.
  cv::Mat pixels(int type, const FileLocation& location) const {
    const size_t row = static_cast<size_t>(width) * CV_ELEM_SIZE(type);
    if (height < 1 || width < 1 || height >= int(kMaxSide) || width >= int(kMaxSide) || step < row ||
        data.size() < step * static_cast<size_t>(height - 1) + row)
      throw Error(fmt::format("{} x {} pixels in {} bytes do not fit", width, height, data.size()), location);
    const cv::Mat rows(height, width, type, const_cast<char*>(data.data()), step);
    if (!big_endian || CV_ELEM_SIZE1(type) == 1) return rows;
    cv::Mat swapped = rows.clone();
    const size_t size = CV_ELEM_SIZE1(type);
    for (uchar* value = swapped.data; value < swapped.dataend; value += size)
      std::reverse(value, value + size);
    return swapped;
  }
  /// NV12 and NV21: half as many rows again hold the chroma.
  cv::Mat with_chroma_rows(const FileLocation& location) const {
    RawImage whole = *this;
    whole.height += height / 2;
    return whole.pixels(CV_8UC1, location);
  }
};

/// sensor_msgs/CompressedImage.
struct CompressedImage {
  RosHeader header;
  std::string format;
  std::string_view data;

  explicit CompressedImage(Fields bytes) {
    header = bytes.header();
    format = bytes.text();
    data = bytes.data();
  }
  std::string_view without_head(size_t size) const { return data.substr(std::min(size, data.size())); }
  cv::Mat decode(size_t head, const std::string& where) const {
    const std::string_view image = without_head(head);
    return decode_image({image.begin(), image.end()}, where);
  }
};

cv::Mat metres_from(const cv::Mat& raw, double unit_m, const FileLocation& location) {
  cv::Mat depth(raw.size(), CV_32F);
  if (raw.type() != CV_16UC1 && raw.type() != CV_32FC1)
    throw Error("depth images have one channel of 16-bit millimetres or 32-bit metres", location);
  for (int v = 0; v < raw.rows; ++v)
    for (int u = 0; u < raw.cols; ++u) {
      float metres = kNan;
      if (raw.type() == CV_32FC1) {
        std::memcpy(&metres, raw.ptr(v, u), 4);
      } else {
        uint16_t millimetres = 0;
        std::memcpy(&millimetres, raw.ptr(v, u), 2);
        if (millimetres != 0 && millimetres != 65535)
          metres = static_cast<float>(unit_m * static_cast<double>(millimetres));
      }
      depth.at<float>(v, u) = metres_or_nan(metres);
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

/// The head of compressedDepth before its image: how 32FC1 was quantised.
struct DepthQuantisation {
  float a = 0, b = 0;
  static constexpr size_t kSize = 12;

  explicit DepthQuantisation(std::string_view data) {
    if (data.size() < kSize) return;
    std::memcpy(&a, data.data() + 4, 4);
    std::memcpy(&b, data.data() + 8, 4);
  }
  /// 32FC1 is stored as inverse depth.
  cv::Mat metres(const cv::Mat& raw, const FileLocation& location) const {
    if (raw.type() != CV_16UC1) throw Error("quantised depth has 16 bits", location);
    cv::Mat depth(raw.size(), CV_32F);
    for (int v = 0; v < raw.rows; ++v)
      for (int u = 0; u < raw.cols; ++u) {
        const uint16_t value = raw.at<uint16_t>(v, u);
        const float z = a / (static_cast<float>(value) - b);
        depth.at<float>(v, u) = value != 0 && z > 0 && z < 1e3F ? z : kNan;
      }
    return depth;
  }
};

/// The upper eight of sixteen bits.
cv::Mat shortened(const cv::Mat& pixels) {
  cv::Mat bytes;
  pixels.convertTo(bytes, CV_8U, 1.0 / 257);
  return bytes;
}

/// Whole-channel encodings: OpenCV's type and where blue, green and red are.
struct ChannelEncoding {
  int type;
  std::array<int, 3> order;
};
std::optional<ChannelEncoding> channels_of(const std::string& encoding) {
  static const std::map<std::string, ChannelEncoding> kEncodings = {
      {"bgr8", {CV_8UC3, {0, 1, 2}}},   {"8UC3", {CV_8UC3, {0, 1, 2}}},    {"rgb8", {CV_8UC3, {2, 1, 0}}},
      {"rgba8", {CV_8UC4, {2, 1, 0}}},  {"bgra8", {CV_8UC4, {0, 1, 2}}},   {"8UC4", {CV_8UC4, {0, 1, 2}}},
      {"mono8", {CV_8UC1, {0, 0, 0}}},  {"8UC1", {CV_8UC1, {0, 0, 0}}},    {"rgb16", {CV_16UC3, {2, 1, 0}}},
      {"bgr16", {CV_16UC3, {0, 1, 2}}}, {"rgba16", {CV_16UC4, {2, 1, 0}}}, {"bgra16", {CV_16UC4, {0, 1, 2}}},
      {"mono16", {CV_16UC1, {0, 0, 0}}}};
  const auto found = kEncodings.find(encoding);
  return found == kEncodings.end() ? std::nullopt : std::optional(found->second);
}

/// BGR of encodings that OpenCV converts; unset for others.
std::optional<int> conversion_to_bgr(const std::string& encoding) {
  static const std::map<std::string, int> kCodes = {
      {"yuv422", cv::COLOR_YUV2BGR_UYVY},      {"uyvy", cv::COLOR_YUV2BGR_UYVY},
      {"yuv422_yuy2", cv::COLOR_YUV2BGR_YUYV}, {"yuyv", cv::COLOR_YUV2BGR_YUYV},
      {"nv21", cv::COLOR_YUV2BGR_NV21},        {"nv12", cv::COLOR_YUV2BGR_NV12},
      {"bayer_rggb8", cv::COLOR_BayerBG2BGR},  {"bayer_bggr8", cv::COLOR_BayerRG2BGR},
      {"bayer_gbrg8", cv::COLOR_BayerGR2BGR},  {"bayer_grbg8", cv::COLOR_BayerGB2BGR}};
  const auto found = kCodes.find(encoding);
  return found == kCodes.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

RosHeader read_ros_header(const RosMessage& message) {
  return Fields(message).header();
}

std::string read_ros_encoding(const RosMessage& message, bool compressed) {
  const Fields bytes(message);
  return compressed ? CompressedImage(bytes).format : RawImage(bytes).encoding;
}

bool is_depth_encoding(const std::string& encoding) {
  return encoding.starts_with("16UC1") || encoding.starts_with("32FC1") || encoding == "mono16" ||
         encoding.find("compressedDepth") != std::string::npos;
}

cv::Mat read_ros_depth(const RosMessage& message, bool compressed, double unit_m) {
  const Fields bytes(message);
  if (compressed) {
    const CompressedImage image(bytes);
    const bool is_rvl = image.format.find("rvl") != std::string::npos;
    // The transport for colour packs 16UC1 as PNG, too, without a head.
    const bool has_head = is_rvl || image.format.find("compressedDepth") != std::string::npos;
    const size_t head = has_head ? DepthQuantisation::kSize : 0;
    const cv::Mat raw =
        is_rvl ? decode_rvl(image.without_head(head), bytes.location()) : image.decode(head, bytes.where());
    if (has_head && image.format.starts_with("32FC1"))
      return DepthQuantisation(image.data).metres(raw, bytes.location());
    return metres_from(raw, unit_m, bytes.location());
  }
  const RawImage image(bytes);
  return metres_from(image.pixels(image.encoding == "32FC1" ? CV_32FC1 : CV_16UC1, bytes.location()), unit_m,
                     bytes.location());
}

cv::Mat read_ros_color(const RosMessage& message, bool compressed) {
  const Fields bytes(message);
  if (compressed) {
    const cv::Mat pixels = CompressedImage(bytes).decode(0, bytes.where());
    if (pixels.depth() != CV_8U) throw Error("colour images have 8 bits per channel", bytes.location());
    return pixels.channels() == 3   ? pixels
           : pixels.channels() == 4 ? picked(pixels, {0, 1, 2})
                                    : picked(pixels, {0, 0, 0});
  }
  const RawImage image(bytes);
  const std::string& encoding = image.encoding;
  if (const auto channels = channels_of(encoding)) {
    const cv::Mat pixels = image.pixels(channels->type, bytes.location());
    return picked(pixels.depth() == CV_8U ? pixels : shortened(pixels), channels->order);
  }
  if (const auto code = conversion_to_bgr(encoding)) {
    const bool bayer = encoding.starts_with("bayer"), planes = encoding.starts_with("nv");
    if (image.width % 2 != 0 || image.height % 2 != 0)
      throw Error(fmt::format("{} images have even sizes", encoding), bytes.location());
    cv::Mat color;
    const cv::Mat pixels = planes ? image.with_chroma_rows(bytes.location())
                                  : image.pixels(bayer ? CV_8UC1 : CV_8UC2, bytes.location());
    cv::cvtColor(pixels, color, *code);
    return color;
  }
  throw Error(fmt::format("colour images of encoding '{}' are not read", encoding), bytes.location());
}

RosCamera read_ros_camera(const RosMessage& message) {
  Fields bytes(message);
  RosCamera camera;
  camera.frame = bytes.header().frame;
  camera.raw.height = static_cast<int>(std::min(bytes.take<uint32_t>(), kMaxSide));
  camera.raw.width = static_cast<int>(std::min(bytes.take<uint32_t>(), kMaxSide));
  const std::string model(bytes.text());
  const std::vector<double> coefficients = bytes.doubles();
  const auto k = bytes.take_doubles<9>();
  bytes.take_doubles<9>();  // R
  const auto p = bytes.take_doubles<12>();
  camera.rectified.width = camera.raw.width;
  camera.rectified.height = camera.raw.height;
  const auto set = [](PinholeCamera& pinhole, double fx, double fy, double cx, double cy) {
    pinhole.fx = fx;
    pinhole.fy = fy;
    pinhole.cx = cx;
    pinhole.cy = cy;
  };
  const bool has_p = p[0] > 0 && p[5] > 0, has_k = k[0] > 0 && k[4] > 0;
  set(camera.raw, has_k ? k[0] : p[0], has_k ? k[4] : p[5], has_k ? k[2] : p[2], has_k ? k[5] : p[6]);
  set(camera.rectified, has_p ? p[0] : k[0], has_p ? p[5] : k[4], has_p ? p[2] : k[2], has_p ? p[6] : k[5]);
  for (const PinholeCamera& c : {camera.raw, camera.rectified})
    if (!is_usable(c)) throw Error("the camera is not calibrated", bytes.location());
  try {
    camera.distortion = distortion_from(model, coefficients, bytes.location());
  } catch (const Error& error) {  // Focal length and centre are worth more than the rest.
    camera.distortion_problem = error.what();
  }
  return camera;
}

std::vector<RosTransform> read_ros_transforms(const RosMessage& message) {
  Fields bytes(message);
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
    transform.parent_from_child = pose_from_values(bytes.take_doubles<7>(), location);
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

Isometry3d read_ros_transform(const RosMessage& message) {
  Fields bytes(message);
  return pose_from_values(bytes.take_doubles<7>(), bytes.location());
}

RosJoints read_ros_joints(const RosMessage& message) {
  Fields bytes(message);
  RosJoints joints;
  joints.stamp_ns = bytes.header().stamp_ns;
  const auto count = bytes.take<uint32_t>();
  std::vector<std::string> names;
  for (uint32_t i = 0; i < count; ++i) names.emplace_back(bytes.text());
  const std::vector<double> positions = bytes.doubles();
  for (size_t i = 0; i < std::min(names.size(), positions.size()); ++i)
    if (std::isfinite(positions[i])) joints.positions[names[i]] = positions[i];
  return joints;
}

RosAcceleration read_ros_acceleration(const RosMessage& message) {
  Fields bytes(message);
  RosAcceleration measured;
  measured.header = bytes.header();
  bytes.take_doubles<4>();  // orientation
  bytes.take_doubles<9>();
  bytes.take_doubles<3>();  // angular velocity
  bytes.take_doubles<9>();
  const auto values = bytes.take_doubles<3>();
  measured.acceleration = {values[0], values[1], values[2]};
  return measured;
}

float read_ros_float(const RosMessage& message) {
  return Fields(message).take<float>();
}

}  // namespace loci::mapping
