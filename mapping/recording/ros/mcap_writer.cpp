#include "mapping/recording/ros/mcap_writer.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/recording/compression.h"
#include "mapping/recording/ros/mcap_format.h"

namespace loci::mapping {
namespace {

using namespace mcap;

constexpr size_t kChunkSize = size_t{1} << 22;

/// Content of a record.
class RecordBytes {
 public:
  template <typename T>
  RecordBytes& add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  RecordBytes& text(std::string_view value) {
    add(static_cast<uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  std::string record(Op op) const {
    return RecordBytes().add(op).add(static_cast<uint64_t>(bytes_.size())).bytes_ + bytes_;
  }
  size_t size() const { return bytes_.size(); }

 private:
  std::string bytes_;
};

std::string zstd_of(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3);
  if (ZSTD_isError(size) != 0) throw Error("compression failed");
  packed.resize(size);
  return packed;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, const OutputOptions& options)
    : file_(path, options) {
  write(kMagic);
  write(RecordBytes().text("ros2").text("loci").record(Op::header));
}

void McapWriter::write(std::string_view bytes) {
  file_.write(bytes);
  at_ += bytes.size();
}

uint16_t McapWriter::add_channel(const std::string& topic, const std::string& type,
                                 const std::string& definition) {
  const auto id = static_cast<uint16_t>(counts_.size() + 1);
  counts_[id] = 0;
  std::string records = RecordBytes().add(id).text(type).text("ros2msg").text(definition).record(Op::schema);
  records += RecordBytes().add(id).add(id).text(topic).text("cdr").add(uint32_t{0}).record(Op::channel);
  definitions_ += records;
  chunk_ += records;
  return id;
}

void McapWriter::add(uint16_t channel, TimeNs time, std::string_view message) {
  if (chunk_messages_.empty()) chunk_first_ = time;
  chunk_last_ = time;
  if (std::all_of(counts_.begin(), counts_.end(), [](const auto& count) { return count.second == 0; }))
    first_ = time;
  last_ = time;
  ++counts_.at(channel);
  chunk_messages_[channel].emplace_back(time, chunk_.size());
  const auto stamp = static_cast<uint64_t>(time);
  RecordBytes head;
  head.add(channel).add(uint32_t{0}).add(stamp).add(stamp);
  std::string record = head.record(Op::message);
  const uint64_t length = head.size() + message.size();
  std::copy_n(reinterpret_cast<const char*>(&length), sizeof length, record.begin() + 1);
  chunk_ += record;
  chunk_ += message;
  if (chunk_.size() > kChunkSize) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_messages_.empty()) return;
  const std::string packed = zstd_of(chunk_);
  ChunkIndex index{chunk_first_, chunk_last_, at_, 0, 0, packed.size(), chunk_.size(), {}};
  RecordBytes content;
  content.add(chunk_first_).add(chunk_last_).add(uint64_t{chunk_.size()}).add(crc32_of(chunk_)).text("zstd");
  content.add(uint64_t{packed.size()});
  std::string record = content.record(Op::chunk);
  const uint64_t length = content.size() + packed.size();
  std::copy_n(reinterpret_cast<const char*>(&length), sizeof length, record.begin() + 1);
  write(record);
  write(packed);
  index.length = at_ - index.at;
  for (const auto& [channel, messages] : chunk_messages_) {
    index.index_at[channel] = at_;
    RecordBytes entries;
    entries.add(channel).add(static_cast<uint32_t>(16 * messages.size()));
    for (const auto& [time, place] : messages) entries.add(time).add(place);
    write(entries.record(Op::message_index));
  }
  index.indexes_length = at_ - index.at - index.length;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_messages_.clear();
}

void McapWriter::write_summary() {
  const uint64_t start = at_;
  std::string summary = definitions_;
  const uint64_t chunk_indexes = summary.size();
  for (const ChunkIndex& chunk : chunks_) {
    RecordBytes record;
    record.add(chunk.first).add(chunk.last).add(chunk.at).add(chunk.length);
    record.add(static_cast<uint32_t>(10 * chunk.index_at.size()));
    for (const auto& [channel, at] : chunk.index_at) record.add(channel).add(at);
    record.add(chunk.indexes_length).text("zstd").add(chunk.packed).add(chunk.unpacked);
    summary += record.record(Op::chunk_index);
  }
  uint64_t messages = 0;
  RecordBytes counts;
  for (const auto& [channel, count] : counts_) {
    counts.add(channel).add(count);
    messages += count;
  }
  const auto channels = static_cast<uint16_t>(counts_.size());
  RecordBytes statistics;
  statistics.add(messages)
      .add(channels)
      .add(static_cast<uint32_t>(channels))
      .add(uint32_t{0})
      .add(uint32_t{0});
  statistics.add(static_cast<uint32_t>(chunks_.size())).add(first_).add(last_);
  statistics.add(static_cast<uint32_t>(10 * counts_.size()));
  for (const auto& [channel, count] : counts_) statistics.add(channel).add(count);
  const uint64_t statistics_at = summary.size();
  summary += statistics.record(Op::statistics);
  const uint64_t offsets = summary.size();
  for (const auto& [op, from, to] : {std::tuple(Op::chunk_index, chunk_indexes, statistics_at),
                                     std::tuple(Op::statistics, statistics_at, offsets)})
    summary += RecordBytes().add(op).add(start + from).add(to - from).record(Op::summary_offset);
  write(summary);
  // No checksum of the summary: the footer's own first fields belong to it.
  write(RecordBytes().add(start).add(start + offsets).add(uint32_t{0}).record(Op::footer));
}

void McapWriter::finish() {
  end_chunk();
  write(RecordBytes().add(uint32_t{0}).record(Op::data_end));
  write_summary();
  write(kMagic);
  file_.commit();
}

}  // namespace loci::mapping
