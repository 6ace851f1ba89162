#include <fmt/format.h>
#include <png.h>

#include <csetjmp>
#include <cstring>

#include "mapping/base/error.h"
#include "mapping/image/codecs.h"

namespace loci::mapping {
namespace {

constexpr int kZlibDefaultStrategy = 0;  ///< libpng's own choice for photographs makes larger files of depth
constexpr int kCompression = 3;          ///< of zlib: half the time of the default for files 5 % larger
/// Deflate packs at most 1032 bytes into one: an image that claims more is not in the file.
constexpr uint64_t kMaxDeflateRatio = 1032;

/// libpng reports errors by longjmp: functions that call it hold nothing that has a destructor.
struct PngStream {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string_view input;
  std::vector<unsigned char> output;
  bool truncated = false;
  char message[128] = "out of memory";
};

void on_error(png_structp png, png_const_charp text) {
  auto* stream = static_cast<PngStream*>(png_get_error_ptr(png));
  std::strncpy(stream->message, text, sizeof stream->message - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp /*png*/, png_const_charp /*text*/) {}

void read_bytes(png_structp png, png_bytep target, size_t count) {
  auto* stream = static_cast<PngStream*>(png_get_io_ptr(png));
  if (count > stream->input.size()) {
    stream->truncated = true;
    png_error(png, "the data end too early");
  }
  std::memcpy(target, stream->input.data(), count);
  stream->input.remove_prefix(count);
}

void write_bytes(png_structp png, png_bytep bytes, size_t count) {
  auto* stream = static_cast<PngStream*>(png_get_io_ptr(png));
  stream->output.insert(stream->output.end(), bytes, bytes + count);
}

void flush_nothing(png_structp /*png*/) {}

class PngReader {
 public:
  explicit PngReader(std::string_view bytes) {
    stream_.input = bytes;
    stream_.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &stream_, on_error, on_warning);
    if (stream_.png != nullptr) stream_.info = png_create_info_struct(stream_.png);
  }
  ~PngReader() { png_destroy_read_struct(&stream_.png, &stream_.info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  const PngStream& stream() const { return stream_; }
  uint32_t width() const { return png_get_image_width(stream_.png, stream_.info); }
  uint32_t height() const { return png_get_image_height(stream_.png, stream_.info); }
  int bits() const { return png_get_bit_depth(stream_.png, stream_.info); }
  uint64_t raw_bytes() const {
    return uint64_t{height()} * (1 + png_get_rowbytes(stream_.png, stream_.info));
  }

  bool read_header() {
    if (stream_.info == nullptr || setjmp(png_jmpbuf(stream_.png)) != 0) return false;
    png_set_read_fn(stream_.png, &stream_, read_bytes);
    png_set_crc_action(stream_.png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_read_info(stream_.png, stream_.info);
    return true;
  }

  /// Type of the decoded image.
  int type(PixelFormat format) const {
    if (format == PixelFormat::bgr) return CV_8UC3;
    const int color = png_get_color_type(stream_.png, stream_.info);
    const bool transparent =
        (color & PNG_COLOR_MASK_COLOR) != 0 && png_get_valid(stream_.png, stream_.info, PNG_INFO_tRNS) != 0;
    const int channels = (color & PNG_COLOR_MASK_ALPHA) != 0 || transparent ? 4
                         : (color & PNG_COLOR_MASK_COLOR) != 0              ? 3
                                                                            : 1;
    return CV_MAKETYPE(bits() == 16 ? CV_16U : CV_8U, channels);
  }

  bool read_pixels(int type, png_bytepp rows, size_t row_bytes) {
    png_structp png = stream_.png;
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    const int color = png_get_color_type(png, stream_.info);
    if (bits() == 16) CV_MAT_DEPTH(type) == CV_8U ? png_set_strip_16(png) : png_set_swap(png);
    CV_MAT_CN(type) < 4 ? png_set_strip_alpha(png) : png_set_tRNS_to_alpha(png);
    if (color == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
    const bool grey = (color & PNG_COLOR_MASK_COLOR) == 0;
    if (grey && bits() < 8) png_set_expand_gray_1_2_4_to_8(png);
    if (CV_MAT_CN(type) > 1) grey ? png_set_gray_to_rgb(png) : png_set_bgr(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, stream_.info);
    if (png_get_rowbytes(png, stream_.info) != row_bytes)
      png_error(png, "an unknown combination of channels");
    png_read_image(png, rows);
    png_read_end(png, stream_.info);
    return true;
  }

 private:
  PngStream stream_;
};

class PngWriter {
 public:
  PngWriter() {
    stream_.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &stream_, on_error, on_warning);
    if (stream_.png != nullptr) stream_.info = png_create_info_struct(stream_.png);
  }
  ~PngWriter() { png_destroy_write_struct(&stream_.png, &stream_.info); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  const char* message() const { return stream_.message; }
  std::vector<unsigned char> take() { return std::move(stream_.output); }

  bool write(const cv::Mat& image, png_bytepp rows) {
    png_structp png = stream_.png;
    if (stream_.info == nullptr || setjmp(png_jmpbuf(png)) != 0) return false;
    const int color = image.channels() == 1   ? PNG_COLOR_TYPE_GRAY
                      : image.channels() == 3 ? PNG_COLOR_TYPE_RGB
                                              : PNG_COLOR_TYPE_RGBA;
    png_set_write_fn(png, &stream_, write_bytes, flush_nothing);
    png_set_compression_level(png, kCompression);
    png_set_compression_strategy(png, kZlibDefaultStrategy);
    png_set_IHDR(png, stream_.info, static_cast<png_uint_32>(image.cols),
                 static_cast<png_uint_32>(image.rows), image.depth() == CV_16U ? 16 : 8, color,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, stream_.info);
    png_set_bgr(png);
    if (image.depth() == CV_16U) png_set_swap(png);
    png_write_image(png, rows);
    png_write_end(png, stream_.info);
    return true;
  }

 private:
  PngStream stream_;
};

std::vector<png_bytep> rows_of(const cv::Mat& image) {
  std::vector<png_bytep> rows;
  for (int v = 0; v < image.rows; ++v) rows.push_back(const_cast<png_bytep>(image.ptr(v)));
  return rows;
}

}  // namespace

cv::Mat decode_png(std::string_view bytes, PixelFormat format, const std::string& name, uint64_t max_pixels) {
  PngReader reader(bytes);
  const auto failed = [&] {
    const char* hint = "copy or record the file again";
    if (reader.stream().truncated) return Error("the image is truncated", {name, 0, {}}, hint);
    return Error(fmt::format("the image is damaged ({})", reader.stream().message), {name, 0, {}}, hint);
  };
  if (!reader.read_header()) throw failed();
  require_decodable_size(reader.width(), reader.height(), max_pixels, name);
  if (reader.raw_bytes() > kMaxDeflateRatio * bytes.size())
    throw Error("the image is damaged (more pixels than data)", {name, 0, {}});
  cv::Mat image(static_cast<int>(reader.height()), static_cast<int>(reader.width()), reader.type(format));
  std::vector<png_bytep> rows = rows_of(image);
  if (!reader.read_pixels(image.type(), rows.data(), static_cast<size_t>(image.cols) * image.elemSize()))
    throw failed();
  return image;
}

std::vector<unsigned char> encode_png(const cv::Mat& image) {
  const bool supported = (image.depth() == CV_8U || image.depth() == CV_16U) &&
                         (image.channels() == 1 || image.channels() == 3 || image.channels() == 4);
  if (image.empty() || !supported)
    throw Error("the image cannot be encoded as .png", {}, "8 or 16 bits, and 1, 3 or 4 channels are needed");
  PngWriter writer;
  std::vector<png_bytep> rows = rows_of(image);
  if (!writer.write(image, rows.data()))
    throw Error(fmt::format("the image cannot be encoded as .png: {}", writer.message()));
  return writer.take();
}

}  // namespace loci::mapping
