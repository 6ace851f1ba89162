#include "mapping/recording/depth_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/load_symbol.h"
#include "mapping/base/text/text.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/depth/codecs.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

/// A decoder of the module: TIFF and OpenEXR bring libraries that most runs do not need.
DepthDecoder loaded_decoder(const char* symbol) {
  return reinterpret_cast<DepthDecoder>(load_symbol("loci_depth.so", symbol,
                                                    "depth as TIFF or OpenEXR cannot be read",
                                                    "install loci_depth.so, libtiff6 and libopenexr"));
}

DepthHeader decode_png_depth(const fs::path& path, cv::Mat* pixels) {
  if (pixels != nullptr) {
    *pixels = read_uint16(path);
    return {pixels->cols, pixels->rows, false};
  }
  const ImageHeader header = read_image_header(path);
  if (header.channels != 1 || header.bits != 16)
    throw Error(fmt::format("depth images are 16-bit grey PNG, this one has {} channels of {} bits",
                            header.channels, header.bits),
                {path.string(), 0, {}});
  return {header.width, header.height, false};
}

DepthDecoder decoder_of(const fs::path& path) {
  require_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  std::string head(8, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (head.starts_with("\x93NUMPY")) return decode_npy;
  if (head.starts_with(std::string("II*\0", 4)) || head.starts_with(std::string("MM\0*", 4)) ||
      head.starts_with(std::string("II+\0", 4)) || head.starts_with(std::string("MM\0+", 4))) {
    static const DepthDecoder tiff = loaded_decoder("loci_decode_tiff_depth");
    return tiff;
  }
  if (head.starts_with("\x76\x2f\x31\x01")) {
    static const DepthDecoder exr = loaded_decoder("loci_decode_exr_depth");
    return exr;
  }
  return decode_png_depth;  // It says what else is wrong.
}

}  // namespace

size_t depth_ending_of(const fs::path& path) {
  const std::string ending = lower_case(path.extension().string());
  return static_cast<size_t>(std::ranges::find(kDepthEndings, ending) - kDepthEndings.begin());
}

DepthHeader read_depth_header(const fs::path& path) {
  return decoder_of(path)(path, nullptr);
}

cv::Mat read_depth_image(const fs::path& path) {
  cv::Mat pixels;
  decoder_of(path)(path, &pixels);
  return pixels;
}

}  // namespace loci::mapping
