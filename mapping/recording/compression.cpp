#include "mapping/recording/compression.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <memory>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

constexpr size_t kPiece = size_t{1} << 16;

/// Collects what comes out of a decoder.
class Output {
 public:
  explicit Output(size_t max_size) : max_size_(max_size) {}
  void add(const char* data, size_t size) {
    if (size > max_size_ - bytes_.size())
      throw Error(fmt::format("unpacks to more than {} bytes, as many as are allowed here", max_size_));
    bytes_.append(data, size);
  }
  std::string take() { return std::move(bytes_); }

 private:
  size_t max_size_;
  std::string bytes_;
};

Error damaged() {
  return Error("the compressed bytes are damaged");
}

std::string from_zstd(std::string_view bytes, Output output) {
  const std::unique_ptr<ZSTD_DStream, size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                        ZSTD_freeDStream);
  ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax, 27);  // At most 128 MB for the window.
  std::array<char, kPiece> piece{};
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  size_t left = 1;
  while (true) {
    ZSTD_outBuffer out{piece.data(), piece.size(), 0};
    const size_t before = in.pos;
    left = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(left) != 0) throw damaged();
    output.add(piece.data(), out.pos);
    if (in.pos == in.size && out.pos < out.size) break;
    if (in.pos == before && out.pos == 0) break;
  }
  if (left != 0) throw damaged();
  return output.take();
}

std::string from_lz4(std::string_view bytes, Output output) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw damaged();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> owner(context,
                                                                           LZ4F_freeDecompressionContext);
  std::array<char, kPiece> piece{};
  size_t left = 1;
  for (size_t at = 0;;) {
    size_t produced = piece.size(), consumed = bytes.size() - at;
    left = LZ4F_decompress(context, piece.data(), &produced, bytes.data() + at, &consumed, nullptr);
    if (LZ4F_isError(left) != 0) throw damaged();
    output.add(piece.data(), produced);
    at += consumed;
    const bool idle = produced == 0 && consumed == 0, whole = left == 0 && at == bytes.size();
    if (idle || whole) break;
  }
  if (left != 0) throw damaged();
  return output.take();
}

std::string from_bz2(std::string_view bytes, Output output) {
  bz_stream stream{};
  if (bytes.size() > std::numeric_limits<unsigned>::max() || BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK)
    throw damaged();
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> owner(&stream, BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(bytes.data());
  stream.avail_in = static_cast<unsigned>(bytes.size());
  std::array<char, kPiece> piece{};
  int status = BZ_OK;
  while (status == BZ_OK) {
    stream.next_out = piece.data();
    stream.avail_out = static_cast<unsigned>(piece.size());
    status = BZ2_bzDecompress(&stream);
    const size_t produced = piece.size() - stream.avail_out;
    output.add(piece.data(), produced);
    if (produced == 0 && stream.avail_in == 0) break;
  }
  if (status != BZ_STREAM_END) throw damaged();
  return output.take();
}

std::string from_zlib(std::string_view bytes, Output output) {
  z_stream stream{};
  if (bytes.size() > std::numeric_limits<uInt>::max() || inflateInit(&stream) != Z_OK) throw damaged();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> owner(&stream, inflateEnd);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::array<char, kPiece> piece{};
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    status = inflate(&stream, Z_NO_FLUSH);
    output.add(piece.data(), piece.size() - stream.avail_out);
  }
  if (status != Z_STREAM_END) throw damaged();
  return output.take();
}

}  // namespace

std::string decompress(std::string_view method, std::string_view bytes, size_t max_size) {
  if (method == "zstd") return from_zstd(bytes, Output(max_size));
  if (method == "lz4") return from_lz4(bytes, Output(max_size));
  if (method == "bz2") return from_bz2(bytes, Output(max_size));
  if (method == "zlib") return from_zlib(bytes, Output(max_size));
  if (!method.empty() && method != "none") throw Error(fmt::format("compression '{}' is not read", method));
  return std::string(bytes);
}

uint32_t crc32_of(std::string_view bytes) {
  uLong crc = crc32(0, nullptr, 0);
  for (size_t at = 0; at < bytes.size();) {
    const size_t count = std::min<size_t>(bytes.size() - at, 1U << 30);
    crc = crc32(crc, reinterpret_cast<const Bytef*>(bytes.data() + at), static_cast<uInt>(count));
    at += count;
  }
  return static_cast<uint32_t>(crc);
}

}  // namespace loci::mapping
