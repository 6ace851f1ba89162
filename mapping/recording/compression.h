#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace loci::mapping {

/// Unpacks a whole stream of "zstd", "lz4" (frame format), "bz2", "zlib", or "" and "none" (a copy). Memory
/// is taken as bytes come out, so a lie about the size costs nothing. Error for another method, damaged
/// bytes, or more than `max_size` bytes.
std::string decompress(std::string_view method, std::string_view bytes, size_t max_size);

/// The CRC-32 of zlib, PNG and MCAP.
uint32_t crc32_of(std::string_view bytes);

}  // namespace loci::mapping
