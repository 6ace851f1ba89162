#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <opencv2/core.hpp>

#include "mapping/base/error.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/depth_image.h"

namespace loci::mapping {

/// A decoder of depth images: the header, and where `pixels` is given, the image. Sizes are checked before
/// memory is taken.
using DepthDecoder = DepthHeader (*)(const std::filesystem::path& path, cv::Mat* pixels);

DepthHeader decode_npy(const std::filesystem::path& path, cv::Mat* pixels);

/// Error unless an image has 1 to kMaxImagePixels pixels.
inline void require_depth_size(uint64_t width, uint64_t height, const std::filesystem::path& path) {
  if (width > 0 && height > 0 && width <= kMaxImagePixels / height) return;
  throw Error(fmt::format("a depth image of {} x {} pixels is not read", width, height),
              {path.string(), 0, {}}, fmt::format("it has 1 to {} pixels", kMaxImagePixels));
}

inline Error truncated_depth(const std::filesystem::path& path) {
  return Error("the image is truncated", {path.string(), 0, {}}, "copy or record the file again");
}

/// `reason` is a library's.
inline Error damaged_depth(const std::string& reason, const std::filesystem::path& path) {
  return Error(fmt::format("the image is damaged ({})", reason.substr(0, 200)), {path.string(), 0, {}},
               "copy or record the file again");
}

}  // namespace loci::mapping
