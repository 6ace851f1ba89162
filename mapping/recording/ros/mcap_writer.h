#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mapping/base/output_file.h"
#include "mapping/base/time.h"

namespace loci::mapping {

/// Writes MCAP of profile ros2: zstd chunks with CRC, message and chunk indexes, statistics. The file takes
/// its name at finish().
class McapWriter {
 public:
  McapWriter(const std::filesystem::path& path, const OutputOptions& options);

  /// `definition` is the text of the message type with those of all types that it uses.
  uint16_t add_channel(const std::string& topic, const std::string& type, const std::string& definition);
  /// `message` in CDR. Messages come in order of time.
  void add(uint16_t channel, TimeNs time, std::string_view message);
  void finish();

 private:
  struct ChunkIndex {
    TimeNs first = 0, last = 0;
    uint64_t at = 0, length = 0, indexes_length = 0, packed = 0, unpacked = 0;
    std::map<uint16_t, uint64_t> index_at;
  };
  void write(std::string_view bytes);
  void end_chunk();
  void write_summary();

  OutputFile file_;
  uint64_t at_ = 0;
  std::string definitions_;  ///< schema and channel records, for the summary
  std::map<uint16_t, uint64_t> counts_;
  TimeNs first_ = 0, last_ = 0;
  std::string chunk_;
  TimeNs chunk_first_ = 0, chunk_last_ = 0;
  std::map<uint16_t, std::vector<std::pair<TimeNs, uint64_t>>> chunk_messages_;
  std::vector<ChunkIndex> chunks_;
};

}  // namespace loci::mapping
