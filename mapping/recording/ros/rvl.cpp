#include "mapping/recording/ros/rvl.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace loci::mapping {
namespace {

/// Numbers of a variable count of groups: three bits each, lowest first, and one that says whether more
/// follow.
class Groups {
 public:
  Groups(std::string_view code, const FileLocation& location) : code_(code), location_(location) {}

  uint32_t number() {
    uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 3) {
      const uint32_t group = next();
      value |= (group & 7U) << shift;
      if ((group & 8U) == 0) return value;
    }
    throw Error("RVL has a number of more than 32 bits", location_);
  }

 private:
  uint32_t next() {
    if (left_ == 0) {
      if (code_.size() < sizeof word_) throw Error("RVL ends before the image is full", location_);
      std::memcpy(&word_, code_.data(), sizeof word_);
      code_.remove_prefix(sizeof word_);
      left_ = 8;
    }
    return word_ >> (4 * --left_) & 15U;
  }

  std::string_view code_;
  const FileLocation& location_;
  uint32_t word_ = 0;
  int left_ = 0;  ///< groups of the word
};

}  // namespace

cv::Mat decode_rvl(std::string_view bytes, const FileLocation& location, uint64_t max_pixels) {
  std::array<uint32_t, 2> size{};
  if (bytes.size() < sizeof size) throw Error("RVL ends before the image begins", location);
  std::memcpy(size.data(), bytes.data(), sizeof size);
  const auto [width, height] = size;
  if (width == 0 || height == 0 || width > max_pixels / height)
    throw Error(fmt::format("an image of {} x {} pixels is not read", width, height), location);
  cv::Mat depth(static_cast<int>(height), static_cast<int>(width), CV_16UC1, cv::Scalar(0));
  auto* pixel = depth.ptr<uint16_t>();
  size_t left = depth.total();
  Groups groups(bytes.substr(sizeof size), location);
  const auto run = [&] {
    const size_t length = groups.number();
    if (length > left) throw Error("RVL has a run beyond the image", location);
    left -= length;
    return length;
  };
  int64_t value = 0;
  while (left > 0) {
    pixel += run();
    for (size_t measured = run(); measured > 0; --measured) {
      const uint32_t zigzag = groups.number();
      value += static_cast<int64_t>(zigzag >> 1) ^ -static_cast<int64_t>(zigzag & 1U);
      if (value < 0 || value > std::numeric_limits<uint16_t>::max())
        throw Error("RVL has a value of more than 16 bits", location);
      *pixel++ = static_cast<uint16_t>(value);
    }
  }
  return depth;
}

}  // namespace loci::mapping
