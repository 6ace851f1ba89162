// Depth as TIFF: one channel of uint16 or float32 in strips.

#include <fmt/format.h>
#include <tiffio.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <memory>
#include <string>

#include "mapping/base/error.h"
#include "mapping/recording/depth/codecs.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr tmsize_t kMaxAllocation = tmsize_t{1} << 30;  ///< bytes at once
constexpr const char* kHint =
    "write one channel of uint16 or float32: cv2.imwrite(\"NAME.tiff\", depth.astype(\"float32\"))";

/// Keeps the first error that libtiff reports about a file.
int keep_error(TIFF* /*file*/, void* message, const char* /*module*/, const char* format, va_list values) {
  auto* text = static_cast<std::string*>(message);
  std::array<char, 200> line{};
  std::vsnprintf(line.data(), line.size(), format, values);
  if (text->empty()) *text = line.data();
  return 1;
}

int drop_warning(TIFF* /*file*/, void* /*message*/, const char* /*module*/, const char* /*format*/,
                 va_list /*values*/) {
  return 1;
}

class TiffReader {
 public:
  explicit TiffReader(const fs::path& path) : path_(path) {
    const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                               TIFFOpenOptionsFree);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMaxAllocation);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_error, &message_);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), drop_warning, nullptr);
    // Not mapped into memory: a file that is cut off meanwhile would end the program.
    file_.reset(TIFFOpenExt(path.c_str(), "rm", options.get()));
    if (!file_) throw damaged();
    TIFFGetField(file_.get(), TIFFTAG_IMAGEWIDTH, &width_);
    TIFFGetField(file_.get(), TIFFTAG_IMAGELENGTH, &height_);
    require_depth_size(width_, height_, path);
    check_kind();
    check_strips();
  }

  DepthHeader header() const { return {static_cast<int>(width_), static_cast<int>(height_), is_float_}; }

  cv::Mat pixels() {
    cv::Mat image(static_cast<int>(height_), static_cast<int>(width_), is_float_ ? CV_32FC1 : CV_16UC1);
    if (TIFFScanlineSize64(file_.get()) != image.cols * image.elemSize()) throw damaged();
    for (uint32_t row = 0; row < height_; ++row)
      if (TIFFReadScanline(file_.get(), image.ptr(static_cast<int>(row)), row, 0) != 1) throw damaged();
    return image;
  }

 private:
  struct Closer {
    void operator()(TIFF* file) const { TIFFClose(file); }
  };

  Error damaged() const { return damaged_depth(message_.empty() ? "TIFF" : message_, path_); }

  uint16_t value_of(uint32_t tag) {
    uint16_t value = 0;
    TIFFGetFieldDefaulted(file_.get(), tag, &value);
    return value;
  }

  void check_kind() {
    const int bits = value_of(TIFFTAG_BITSPERSAMPLE), samples = value_of(TIFFTAG_SAMPLESPERPIXEL),
              format = value_of(TIFFTAG_SAMPLEFORMAT);
    is_float_ = format == SAMPLEFORMAT_IEEEFP && bits == 32;
    const bool is_uint16 = format == SAMPLEFORMAT_UINT && bits == 16;
    if (samples != 1 || (!is_float_ && !is_uint16))
      throw Error(
          fmt::format("a TIFF image of {} channels of {} bits ({}) is not read as depth", samples, bits,
                      format == SAMPLEFORMAT_IEEEFP ? "floating-point"
                      : format == SAMPLEFORMAT_INT  ? "signed"
                                                    : "unsigned"),
          {path_.string(), 0, {}}, kHint);
    const int photometric = value_of(TIFFTAG_PHOTOMETRIC), orientation = value_of(TIFFTAG_ORIENTATION);
    if (TIFFIsTiled(file_.get()) != 0 || photometric != PHOTOMETRIC_MINISBLACK ||
        orientation != ORIENTATION_TOPLEFT)
      throw Error("a TIFF image in tiles, inverted or turned is not read as depth", {path_.string(), 0, {}},
                  kHint);
    const int compression = value_of(TIFFTAG_COMPRESSION);
    for (const int known : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_DEFLATE,
                            COMPRESSION_PACKBITS, COMPRESSION_ZSTD, COMPRESSION_LZMA})
      if (compression == known) return;
    throw Error(fmt::format("compression {} of TIFF is not read", compression), {path_.string(), 0, {}},
                kHint);
  }

  /// All strips are in the file.
  void check_strips() {
    const uint64_t size = fs::file_size(path_);
    for (uint32_t strip = 0; strip < TIFFNumberOfStrips(file_.get()); ++strip) {
      const uint64_t at = TIFFGetStrileOffset(file_.get(), strip),
                     bytes = TIFFGetStrileByteCount(file_.get(), strip);
      if (!message_.empty()) throw damaged();
      if (bytes == 0 || at > size || bytes > size - at) throw truncated_depth(path_);
    }
  }

  fs::path path_;
  std::string message_;
  std::unique_ptr<TIFF, Closer> file_;
  uint32_t width_ = 0, height_ = 0;
  bool is_float_ = false;
};

}  // namespace
}  // namespace loci::mapping

extern "C" loci::mapping::DepthHeader loci_decode_tiff_depth(const std::filesystem::path& path,
                                                             cv::Mat* pixels) {
  loci::mapping::TiffReader reader(path);
  if (pixels != nullptr) *pixels = reader.pixels();
  return reader.header();
}
