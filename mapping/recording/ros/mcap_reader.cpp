// MCAP (mcap.dev/spec): records of an opcode, a length and content, most of them inside compressed chunks.
// The file is walked from its beginning: with or without an index, and as far as it is whole.

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <set>

#include "mapping/base/error.h"
#include "mapping/recording/compression.h"
#include "mapping/recording/ros/bag.h"
#include "mapping/recording/ros/chunk_cache.h"
#include "mapping/recording/ros/mcap_format.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using namespace mcap;

constexpr uint64_t kMaxChunk = uint64_t{1} << 30;
constexpr uint64_t kMaxRecord = uint64_t{1} << 31;

/// RecordFields of a record: little endian, texts and arrays with a length of four bytes before them.
class RecordFields {
 public:
  explicit RecordFields(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  T take() {
    T value{};
    std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view text() { return next(take<uint32_t>()); }
  std::string_view next(uint64_t count) {
    if (count > bytes_.size() - at_) throw Error("a record is too short");
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  std::string_view rest() { return bytes_.substr(at_); }
  size_t at() const { return at_; }

 private:
  std::string_view bytes_;
  size_t at_ = 0;
};

Serialization serialization_of(std::string_view encoding) {
  return encoding == "cdr"    ? Serialization::cdr
         : encoding == "ros1" ? Serialization::ros1
                              : Serialization::other;
}

class McapReader : public BagReader {
 public:
  McapReader(const fs::path& path, const fs::path& name) : path_(name), file_(path, std::ios::binary) {
    size_ = fs::file_size(path);
    walk();
    collect_topics();
    if (bad_chunks_ > 0)
      problems_.push_back(fmt::format("{}: {} of {} chunks are damaged and left out ({})", path_.string(),
                                      bad_chunks_, chunks_, bad_chunk_reason_));
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  std::vector<std::string> problems() const override { return problems_; }

  std::vector<TimeNs> times(const std::string& topic) const override { return times_in(messages_, topic); }

  std::string message(const std::string& topic, size_t i) const override {
    const std::lock_guard lock(mutex_);
    return std::string(bytes_of(messages_.at(topic).at(i)));
  }

  void visit(const std::function<bool(const BagTopic&)>& wanted, const Visitor& visitor) const override {
    const std::lock_guard lock(mutex_);
    visit_as_stored(topics_, messages_, wanted, visitor,
                    [this](const Message& each) { return bytes_of(each); });
  }

 private:
  struct Schema {
    std::string name, definition;
  };
  struct Channel {
    std::string topic;
    uint16_t schema = 0;
    Serialization serialization = Serialization::other;
  };
  struct Message {
    TimeNs time = 0;
    uint64_t chunk = 0;  ///< where its record stands in the file; 0 = not in a chunk
    uint64_t at = 0;     ///< of the data: in the unpacked chunk, or in the file
    uint64_t size = 0;
  };

  std::string read(uint64_t at, uint64_t count) const {
    if (at > size_ || count > size_ - at) throw Error("ends here");
    std::string bytes(count, '\0');
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(at));
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(count))) throw Error("cannot be read");
    return bytes;
  }

  /// The records of the file, its summary only if chunks are damaged, or to where it is damaged.
  void walk() {
    uint64_t at = kMagic.size();
    try {
      if (read(0, kMagic.size()) != kMagic) throw Error("is MCAP of another version than 0");
      while (true) {
        const std::string head = read(at, kRecordHead);
        const auto op = static_cast<Op>(head[0]);
        const auto length = RecordFields(std::string_view(head).substr(1)).take<uint64_t>();
        if (op == Op::data_end || op == Op::footer) break;
        if (length > size_ - at - kRecordHead)
          throw Error(fmt::format("the file ends within a record that claims {} bytes", length));
        take_record(op, at, length);
        at += kRecordHead + length;
      }
    } catch (const Error& error) {
      problems_.push_back(
          fmt::format("{}: truncated or damaged at byte {} of {} ({}); what stands before it is used",
                      path_.string(), at, size_, error.message()));
    }
    if (bad_chunks_ > 0) read_summary(at);
  }

  /// Channels and schemas stand in the chunk where they are used first, and once more behind the data: what
  /// a damaged chunk took with it comes from there.
  void read_summary(uint64_t at) {
    try {
      while (size_ - at > kRecordHead) {
        const std::string head = read(at, kRecordHead);
        const auto op = static_cast<Op>(head[0]);
        const auto length = RecordFields(std::string_view(head).substr(1)).take<uint64_t>();
        if (op == Op::footer || length > size_ - at - kRecordHead) return;
        if (op == Op::schema || op == Op::channel) take_record(op, at, length);
        at += kRecordHead + length;
      }
    } catch (const Error&) {  // It is a second copy: what it lacks is in the list of problems already.
    }
  }

  void take_record(Op op, uint64_t at, uint64_t length) {
    if (op != Op::schema && op != Op::channel && op != Op::message && op != Op::chunk) return;
    if (length > kMaxRecord) throw Error("a record of more than 2 GB");
    if (op == Op::chunk) return take_chunk(at, length);
    // Of a message, channel, sequence and times are enough.
    const std::string content =
        read(at + kRecordHead, op == Op::message ? std::min<uint64_t>(length, 22) : length);
    take_content(op, content, 0, at + kRecordHead, length);
  }

  void take_chunk(uint64_t at, uint64_t length) {
    ++chunks_;
    try {
      const std::string records = unpack(at, length);
      for (size_t place = 0; place < records.size();) {
        RecordFields head(std::string_view(records).substr(place));
        const auto op = static_cast<Op>(head.take<uint8_t>());
        const auto size = head.take<uint64_t>();
        const std::string_view content = head.next(size);
        take_content(op, content, at, place + kRecordHead, size);
        place += kRecordHead + size;
      }
    } catch (const Error& error) {
      ++bad_chunks_;
      if (bad_chunk_reason_.empty()) bad_chunk_reason_ = error.message();
    }
  }

  /// A record that stands at `at` in a chunk or in the file; `content` may be cut off for messages.
  void take_content(Op op, std::string_view content, uint64_t chunk, uint64_t at, uint64_t length) {
    RecordFields fields(content);
    if (op == Op::schema) {
      const auto id = fields.take<uint16_t>();
      const std::string name(fields.text());
      fields.text();  // encoding
      schemas_[id] = {name, std::string(fields.text())};
    } else if (op == Op::channel) {
      const auto id = fields.take<uint16_t>();
      Channel channel;
      channel.schema = fields.take<uint16_t>();
      channel.topic = fields.text();
      channel.serialization = serialization_of(fields.text());
      channels_[id] = channel;
    } else if (op == Op::message) {
      const auto channel = fields.take<uint16_t>();
      fields.take<uint32_t>();  // sequence
      const auto time = static_cast<TimeNs>(fields.take<uint64_t>());
      fields.take<uint64_t>();  // publish time
      by_channel_[channel].push_back({time, chunk, at + fields.at(), length - fields.at()});
    }
  }

  /// Records of the chunk at a position.
  std::string unpack(uint64_t at, uint64_t length) const {
    const std::string content = read(at + kRecordHead, length);
    RecordFields fields(content);
    fields.next(16);  // times of the first and last message
    const auto size = fields.take<uint64_t>();
    const auto crc = fields.take<uint32_t>();
    const std::string_view compression = fields.text();
    const std::string_view packed = fields.next(fields.take<uint64_t>());
    if (size > kMaxChunk) throw Error(fmt::format("a chunk of {} bytes", size));
    std::string records = decompress(compression, packed, size);
    if (records.size() != size) throw Error("a chunk unpacks to another size than it says");
    if (crc != 0 && crc32_of(records) != crc) throw Error("the checksum is wrong");
    return records;
  }

  /// Valid until the next call.
  std::string_view bytes_of(const Message& message) const {
    try {
      if (message.chunk != 0) {
        const std::string head = read(message.chunk, kRecordHead);
        const auto length = RecordFields(std::string_view(head).substr(1)).take<uint64_t>();
        return std::string_view(unpacked_.at(message.chunk, [&] { return unpack(message.chunk, length); }))
            .substr(message.at, message.size);
      }
      plain_ = read(message.at, message.size);
      return plain_;
    } catch (const Error& error) {
      throw Error("a message cannot be read: " + error.message(), {path_.string(), 0, {}});
    }
  }

  void collect_topics() {
    std::map<std::string, BagTopic> topics;
    std::set<std::string> twice;
    for (const auto& [id, channel] : channels_) {
      const auto schema = schemas_.find(channel.schema);
      BagTopic topic{channel.topic, {}, {}, 0, channel.serialization};
      if (schema != schemas_.end()) {
        topic.type = schema->second.name;
        topic.definition = schema->second.definition;
        if (const size_t msg = topic.type.find("/msg/"); msg != std::string::npos) topic.type.erase(msg, 4);
      }
      const BagTopic& known = topics.try_emplace(topic.name, topic).first->second;
      if (known.type != topic.type || known.serialization != topic.serialization) {
        problems_.push_back(fmt::format("{}: {} is {} and {}; the second is not read", path_.string(),
                                        topic.name, known.type, topic.type));
        continue;
      }
      std::vector<Message>& all = messages_[topic.name];
      all.insert(all.end(), by_channel_[id].begin(), by_channel_[id].end());
    }
    by_channel_.clear();
    topics_ = with_sorted_messages(topics, messages_);
  }

  fs::path path_;
  mutable std::mutex mutex_;
  mutable std::ifstream file_;
  uint64_t size_ = 0;
  mutable ChunkCache unpacked_;
  mutable std::string plain_;
  std::map<uint16_t, Schema> schemas_;
  std::map<uint16_t, Channel> channels_;
  std::map<uint16_t, std::vector<Message>> by_channel_;
  std::map<std::string, std::vector<Message>> messages_;
  std::vector<BagTopic> topics_;
  size_t chunks_ = 0, bad_chunks_ = 0;
  std::string bad_chunk_reason_;
  std::vector<std::string> problems_;
};

}  // namespace

std::unique_ptr<BagReader> open_mcap(const fs::path& path, const fs::path& name) {
  auto reader = std::make_unique<McapReader>(path, name);
  if (reader->topics().empty() && !reader->problems().empty())
    throw Error("nothing in this MCAP file can be read: " + reader->problems().front(),
                {name.string(), 0, {}});
  return reader;
}

}  // namespace loci::mapping
