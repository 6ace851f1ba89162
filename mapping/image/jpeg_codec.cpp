#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>  // jpeglib.h uses FILE without including it.
#include <cstdlib>

#include <jerror.h>
#include <jpeglib.h>

#include "mapping/base/error.h"
#include "mapping/image/codecs.h"

namespace loci::mapping {
namespace {

constexpr int kQuality = 95;
/// Progressive files repeat the whole image per scan; real ones have about ten.
constexpr int kMaxScans = 100;
/// A Huffman code has at least one bit for each block of 8 x 8 pixels: an image that claims more is not in
/// the file.
constexpr uint64_t kMaxPixelsPerByte = 512;
/// What the decoder of a progressive image may take: 16-bit coefficients of four channels at full resolution.
constexpr uint64_t kBytesPerPixel = 8;
constexpr uint64_t kFixedBytes = uint64_t{16} << 20;
/// Webcams leave a few bytes before the end marker; more of them are the rest of a cut image.
constexpr int kMaxExtraneousBytes = 16;

/// libjpeg reports errors by longjmp: functions that call it hold nothing that has a destructor.
struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf jump;
  bool truncated = false;
  bool damaged = false;
  char message[JMSG_LENGTH_MAX] = "";
};

JpegErrors& errors_of(j_common_ptr codec) {
  return *reinterpret_cast<JpegErrors*>(codec->err);
}

[[noreturn]] void on_error(j_common_ptr codec) {
  JpegErrors& errors = errors_of(codec);
  codec->err->format_message(codec, errors.message);
  std::longjmp(errors.jump, 1);
}

/// Whether a warning means that blocks of the image are missing or made up. libjpeg fills them with grey.
bool is_damage(const jpeg_error_mgr& manager) {
  switch (manager.msg_code) {
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_MUST_RESYNC:
      return true;
    case JWRN_EXTRANEOUS_DATA:
      return manager.msg_parm.i[0] > kMaxExtraneousBytes;
    default:
      return false;
  }
}

void on_message(j_common_ptr codec, int level) {
  JpegErrors& errors = errors_of(codec);
  if (level >= 0) return;  // a trace
  if (codec->err->msg_code == JWRN_JPEG_EOF) errors.truncated = true;
  if (errors.damaged || !is_damage(*codec->err)) return;
  errors.damaged = true;
  codec->err->format_message(codec, errors.message);
}

void on_progress(j_common_ptr codec) {
  if (codec->is_decompressor != 0 && reinterpret_cast<j_decompress_ptr>(codec)->input_scan_number > kMaxScans)
    ERREXIT(codec, JERR_BAD_PROGRESSION);
}

void set_up(JpegErrors& errors) {
  jpeg_std_error(&errors.manager);
  errors.manager.error_exit = on_error;
  errors.manager.emit_message = on_message;
}

class JpegReader {
 public:
  JpegReader() {
    set_up(errors_);
    codec_.err = &errors_.manager;
  }
  ~JpegReader() { jpeg_destroy_decompress(&codec_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  const JpegErrors& errors() const { return errors_; }
  uint32_t width() const { return codec_.image_width; }
  uint32_t height() const { return codec_.image_height; }
  bool is_cmyk() const { return codec_.num_components == 4; }
  bool is_grey() const { return codec_.num_components == 1; }
  bool is_arithmetic() const { return codec_.arith_code != 0; }
  void limit_memory(uint64_t bytes) { codec_.mem->max_memory_to_use = static_cast<long>(bytes); }

  bool read_header(std::string_view bytes) {
    if (setjmp(errors_.jump) != 0) return false;
    jpeg_create_decompress(&codec_);
    codec_.progress = &progress_;
    progress_.progress_monitor = on_progress;
    jpeg_mem_src(&codec_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&codec_, TRUE);
    return true;
  }

  bool read_pixels(J_COLOR_SPACE space, unsigned char* pixels, size_t row_bytes) {
    if (setjmp(errors_.jump) != 0) return false;
    codec_.out_color_space = space;
    jpeg_start_decompress(&codec_);
    while (codec_.output_scanline < codec_.output_height) {
      JSAMPROW row = pixels + codec_.output_scanline * row_bytes;
      jpeg_read_scanlines(&codec_, &row, 1);
    }
    jpeg_finish_decompress(&codec_);
    return !errors_.truncated && !errors_.damaged;
  }

 private:
  JpegErrors errors_;
  jpeg_progress_mgr progress_{};
  jpeg_decompress_struct codec_{};
};

class JpegWriter {
 public:
  JpegWriter() {
    set_up(errors_);
    codec_.err = &errors_.manager;
  }
  ~JpegWriter() {
    jpeg_destroy_compress(&codec_);
    std::free(bytes_);
  }
  JpegWriter(const JpegWriter&) = delete;
  JpegWriter& operator=(const JpegWriter&) = delete;

  const JpegErrors& errors() const { return errors_; }
  std::vector<unsigned char> bytes() const { return {bytes_, bytes_ + size_}; }

  bool write(const cv::Mat& image) {
    if (setjmp(errors_.jump) != 0) return false;
    jpeg_create_compress(&codec_);
    jpeg_mem_dest(&codec_, &bytes_, &size_);
    codec_.image_width = static_cast<JDIMENSION>(image.cols);
    codec_.image_height = static_cast<JDIMENSION>(image.rows);
    codec_.input_components = image.channels();
    codec_.in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
    jpeg_set_defaults(&codec_);
    jpeg_set_quality(&codec_, kQuality, TRUE);
    jpeg_start_compress(&codec_, TRUE);
    while (codec_.next_scanline < codec_.image_height) {
      auto* row = const_cast<JSAMPROW>(image.ptr(static_cast<int>(codec_.next_scanline)));
      jpeg_write_scanlines(&codec_, &row, 1);
    }
    jpeg_finish_compress(&codec_);
    return true;
  }

 private:
  JpegErrors errors_;
  jpeg_compress_struct codec_{};
  unsigned char* bytes_ = nullptr;
  unsigned long size_ = 0;
};

/// Of printers' files; inks are stored inverted.
cv::Mat bgr_from_cmyk(const cv::Mat& cmyk) {
  cv::Mat bgr(cmyk.size(), CV_8UC3);
  for (int v = 0; v < cmyk.rows; ++v)
    for (int u = 0; u < cmyk.cols; ++u) {
      const auto& ink = cmyk.at<cv::Vec4b>(v, u);
      const auto channel = [&](int i) { return static_cast<uchar>(ink[3] - ((255 - ink[i]) * ink[3] >> 8)); };
      bgr.at<cv::Vec3b>(v, u) = {channel(2), channel(1), channel(0)};
    }
  return bgr;
}

}  // namespace

cv::Mat decode_jpeg(std::string_view bytes, PixelFormat format, const std::string& name,
                    uint64_t max_pixels) {
  JpegReader reader;
  const auto failed = [&] {
    const char* hint = "copy or record the file again";
    if (reader.errors().truncated) return Error("the image is truncated", {name, 0, {}}, hint);
    return Error(fmt::format("the image is damaged ({})", reader.errors().message), {name, 0, {}}, hint);
  };
  if (!reader.read_header(bytes)) throw failed();
  require_decodable_size(reader.width(), reader.height(), max_pixels, name);
  if (reader.is_arithmetic())
    throw Error("the JPEG image is coded arithmetically, which is not read", {name, 0, {}},
                "save it as an ordinary JPEG or as PNG");
  const uint64_t pixels = uint64_t{reader.width()} * reader.height();
  if (pixels > kMaxPixelsPerByte * bytes.size())
    throw Error("the image is damaged (more pixels than data)", {name, 0, {}});
  reader.limit_memory(kFixedBytes + kBytesPerPixel * pixels);
  const bool grey = reader.is_grey() && format == PixelFormat::stored;
  const J_COLOR_SPACE space = reader.is_cmyk() ? JCS_CMYK : grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  cv::Mat image(static_cast<int>(reader.height()), static_cast<int>(reader.width()),
                reader.is_cmyk() ? CV_8UC4
                : grey           ? CV_8UC1
                                 : CV_8UC3);
  if (!reader.read_pixels(space, image.data, image.step)) throw failed();
  return reader.is_cmyk() ? bgr_from_cmyk(image) : image;
}

std::vector<unsigned char> encode_jpeg(const cv::Mat& image) {
  if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_8UC3))
    throw Error("the image cannot be encoded as .jpg", {}, "8 bits, and 1 or 3 channels are needed");
  JpegWriter writer;
  if (!writer.write(image))
    throw Error(fmt::format("the image cannot be encoded as .jpg: {}", writer.errors().message));
  return writer.bytes();
}

}  // namespace loci::mapping
