// Bags of ROS 1 (format 2.0, wiki.ros.org/Bags/Format/2.0): records of a header of named fields and data.
// Messages stand in chunks, which may be compressed; behind each chunk records list where in it the messages
// of a connection are. Nothing in the file is believed before it is known to fit: not lengths, not offsets,
// not counts.

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <map>
#include <mutex>

#include "mapping/base/error.h"
#include "mapping/recording/compression.h"
#include "mapping/recording/ros/bag.h"
#include "mapping/recording/ros/chunk_cache.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

enum class RecordKind : uint8_t { message = 2, bag = 3, index = 4, chunk = 5, connection = 7 };

template <typename T>
T number_in(std::string_view bytes) {
  if (bytes.size() != sizeof(T)) throw Error("a field has not the size of its number");
  T value{};
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/// The next `count` bytes, which are taken away.
std::string_view take(std::string_view& bytes, size_t count) {
  if (count > bytes.size()) throw Error("a record is too short");
  const std::string_view taken = bytes.substr(0, count);
  bytes.remove_prefix(count);
  return taken;
}

std::string_view take_sized(std::string_view& bytes) {
  return take(bytes, number_in<uint32_t>(take(bytes, sizeof(uint32_t))));
}

/// A header: fields as NAME=VALUE, each with its length before it.
class HeaderFields {
 public:
  explicit HeaderFields(std::string_view bytes) {
    while (!bytes.empty()) {
      const std::string_view field = take_sized(bytes);
      const size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw Error("a field has no value");
      fields_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }
  /// Empty where there is none.
  std::string_view text(std::string_view name) const {
    const auto found = fields_.find(name);
    return found == fields_.end() ? std::string_view() : found->second;
  }
  template <typename T>
  T number(std::string_view name) const {
    return number_in<T>(text(name));
  }
  RecordKind kind() const { return static_cast<RecordKind>(number<uint8_t>("op")); }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

class Ros1Reader : public BagReader {
 public:
  Ros1Reader(const fs::path& path, const fs::path& name) : path_(name), file_(path, std::ios::binary) {
    size_ = fs::file_size(path);
    try {
      walk();
    } catch (const Error& error) {
      throw Error(fmt::format("the bag cannot be read: {}", error.message()), {name.string(), 0, {}},
                  kReindex);
    }
    if (!indexed_)
      throw Error("the bag has no index: it is truncated, or its recording was not finished",
                  {name.string(), 0, {}}, kReindex);
    collect_topics();
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
  static constexpr size_t kMaxChunk = size_t{1} << 28;  // unpacked; recorders begin a new one before 1 MB
  static constexpr size_t kMaxHeader = size_t{1} << 20;
  static constexpr const char* kReindex = "'rosbag reindex' repairs bags whose recording was interrupted";

  struct Message {
    TimeNs time = 0;
    uint64_t chunk = 0;  ///< where its record stands in the file
    uint64_t at = 0;     ///< in the unpacked chunk
    uint32_t connection = 0;
  };
  struct Record {
    std::string header;
    uint64_t data_at = 0, data_size = 0;
    uint64_t end() const { return data_at + data_size; }
  };

  std::string read(uint64_t at, uint64_t count) const {
    if (at > size_ || count > size_ - at) throw Error("it ends within a record");
    std::string bytes(count, '\0');
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(at));
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(count))) throw Error("it cannot be read");
    return bytes;
  }

  Record record_at(uint64_t at) const {
    const auto size_at = [&](uint64_t where) { return number_in<uint32_t>(read(where, sizeof(uint32_t))); };
    Record record;
    const uint32_t header_size = size_at(at);
    if (header_size > kMaxHeader) throw Error("a header is too long");
    record.header = read(at + sizeof(uint32_t), header_size);
    record.data_at = at + 2 * sizeof(uint32_t) + header_size;
    record.data_size = size_at(record.data_at - sizeof(uint32_t));
    if (record.data_size > size_ - record.data_at) throw Error("it ends within a record");
    return record;
  }

  void walk() {
    constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
    if (read(0, kMagic.size()) != kMagic) throw Error("it is not of version 2.0");
    uint64_t chunk = 0;
    for (uint64_t at = kMagic.size(); at < size_;) {
      const Record record = record_at(at);
      const HeaderFields fields(record.header);
      const RecordKind kind = fields.kind();
      if (kind == RecordKind::bag) take_head(fields);
      if (kind == RecordKind::chunk) chunk = at;
      if (kind == RecordKind::index) take_index(fields, record, chunk);
      if (kind == RecordKind::connection) take_connection(fields, record);
      at = record.end();
    }
  }

  void take_head(const HeaderFields& fields) {
    if (!fields.text("encryptor").empty()) throw Error("it is encrypted, which is not read");
    const auto index_at = fields.number<uint64_t>("index_pos");
    indexed_ = index_at != 0;
    if (index_at > size_) throw Error("it ends before its index");
  }

  void take_index(const HeaderFields& fields, const Record& record, uint64_t chunk) {
    if (chunk == 0) throw Error("an index has no chunk before it");
    if (fields.number<uint32_t>("ver") != 1) throw Error("an index is not of version 1");
    const auto connection = fields.number<uint32_t>("conn");
    const std::string content = read(record.data_at, record.data_size);
    for (std::string_view rest = content; !rest.empty();) {
      const auto next = [&rest] { return number_in<uint32_t>(take(rest, sizeof(uint32_t))); };
      const TimeNs seconds = next(), nanoseconds = next();
      by_connection_[connection].push_back({seconds * kSecond + nanoseconds, chunk, next(), connection});
    }
  }

  void take_connection(const HeaderFields& fields, const Record& record) {
    const std::string content = read(record.data_at, record.data_size);
    const HeaderFields about(content);
    connections_[fields.number<uint32_t>("conn")] = {std::string(fields.text("topic")),
                                                     std::string(about.text("type")),
                                                     std::string(about.text("message_definition"))};
  }

  void collect_topics() {
    std::map<std::string, BagTopic> topics;
    for (const auto& [id, topic] : connections_) {
      const BagTopic& known = topics.try_emplace(topic.name, topic).first->second;
      if (known.type != topic.type) {
        problems_.push_back(fmt::format("{}: {} is {} and {}; the second is not read", path_.string(),
                                        topic.name, known.type, topic.type));
        continue;
      }
      std::vector<Message>& all = messages_[topic.name];
      all.insert(all.end(), by_connection_[id].begin(), by_connection_[id].end());
    }
    by_connection_.clear();
    topics_ = with_sorted_messages(topics, messages_);
  }

  /// Records of the chunk at a position.
  std::string unpack(uint64_t at) const {
    const Record record = record_at(at);
    const HeaderFields fields(record.header);
    const size_t size = fields.number<uint32_t>("size");
    if (size > kMaxChunk) throw Error(fmt::format("a chunk of {} bytes", size));
    std::string records =
        decompress(fields.text("compression"), read(record.data_at, record.data_size), size);
    if (records.size() != size) throw Error("a chunk unpacks to another size than it says");
    return records;
  }

  /// Valid until the next call.
  std::string_view bytes_of(const Message& message) const {
    try {
      std::string_view records = unpacked_.at(message.chunk, [&] { return unpack(message.chunk); });
      take(records, message.at);
      const HeaderFields fields(take_sized(records));
      if (fields.kind() != RecordKind::message || fields.number<uint32_t>("conn") != message.connection)
        throw Error("the index does not point to it");
      return take_sized(records);
    } catch (const Error& error) {
      throw Error("a message cannot be read: " + error.message(), {path_.string(), 0, {}}, kReindex);
    }
  }

  fs::path path_;
  mutable std::mutex mutex_;
  mutable std::ifstream file_;
  uint64_t size_ = 0;
  bool indexed_ = false;
  mutable ChunkCache unpacked_;
  std::map<uint32_t, BagTopic> connections_;
  std::map<uint32_t, std::vector<Message>> by_connection_;
  std::map<std::string, std::vector<Message>> messages_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> problems_;
};

}  // namespace

std::unique_ptr<BagReader> open_ros1_bag(const fs::path& path, const fs::path& name) {
  return std::make_unique<Ros1Reader>(path, name);
}

}  // namespace loci::mapping
