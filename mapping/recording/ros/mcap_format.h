#pragma once

#include <cstdint>
#include <string_view>

// What reader and writer of MCAP share.

namespace loci::mapping::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
inline constexpr uint64_t kRecordHead = 9;  ///< opcode and length

enum class Op : uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

}  // namespace loci::mapping::mcap
