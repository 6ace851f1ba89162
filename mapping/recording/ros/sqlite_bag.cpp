// Recordings of rosbag2 in SQLite (.db3): tables `topics` and `messages`.

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "mapping/base/error.h"
#include "mapping/recording/ros/bag.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxBytes = 1 << 28;  ///< of one value

std::string file_uri(const fs::path& path) {
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string())
    uri += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02X}", static_cast<unsigned char>(c))
                                            : std::string(1, c);
  // Without a write-ahead log beside it the file is all there is: no lock, no shared memory beside it.
  return uri + (fs::exists(path.string() + "-wal") ? "?mode=ro" : "?mode=ro&immutable=1");
}

class SqliteBag : public BagReader {
 public:
  /// With `cut_off` also a file that is shorter than its head says, which SQLite refuses unless the schema
  /// may be repaired.
  SqliteBag(const fs::path& path, const fs::path& name, bool cut_off = false)
      : path_(name), database_(file_uri(path), SQLite::OPEN_READONLY | SQLite::OPEN_URI) {
    sqlite3* handle = database_.getHandle();
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, cut_off ? 0 : 1, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_WRITABLE_SCHEMA, cut_off ? 1 : 0, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMaxBytes);
    read_topics();
    read_messages();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  std::vector<std::string> problems() const override { return problems_; }

  std::vector<TimeNs> times(const std::string& topic) const override {
    std::vector<TimeNs> times;
    const auto found = messages_.find(topic);
    if (found == messages_.end()) return times;
    for (const auto& [time, id] : found->second) times.push_back(time);
    return times;
  }

  std::string message(const std::string& topic, size_t i) const override {
    const std::lock_guard lock(mutex_);
    try {
      SQLite::Statement query(database_, "SELECT data FROM messages WHERE id = ?");
      query.bind(1, messages_.at(topic).at(i).second);
      if (!query.executeStep()) throw Error("the message is gone", {path_.string(), 0, {}});
      const SQLite::Column data = query.getColumn(0);
      return {static_cast<const char*>(data.getBlob()), static_cast<size_t>(data.getBytes())};
    } catch (const SQLite::Exception& error) {
      throw Error(fmt::format("a message cannot be read: {}", error.what()), {path_.string(), 0, topic});
    }
  }

 private:
  void read_topics() {
    SQLite::Statement query(database_,
                            "SELECT id, name, type, serialization_format FROM topics ORDER BY name");
    while (query.executeStep()) {
      BagTopic topic;
      topic.name = query.getColumn(1).getString();
      topic.type = query.getColumn(2).getString();
      if (const size_t msg = topic.type.find("/msg/"); msg != std::string::npos) topic.type.erase(msg, 4);
      topic.serialization =
          query.getColumn(3).getString() == "cdr" ? Serialization::cdr : Serialization::other;
      if (messages_.contains(topic.name)) {
        problems_.push_back(fmt::format("{}: the topic {} is there twice", path_.string(), topic.name));
        continue;
      }
      messages_[topic.name];
      names_[query.getColumn(0).getInt64()] = topic.name;
      topics_.push_back(std::move(topic));
    }
  }

  /// Rows are not always in order of time. What comes before a damaged page is kept.
  void read_messages() {
    try {
      SQLite::Statement query(database_, "SELECT id, topic_id, timestamp FROM messages");
      while (query.executeStep()) {
        const auto name = names_.find(query.getColumn(1).getInt64());
        if (name != names_.end())
          messages_[name->second].emplace_back(query.getColumn(2).getInt64(), query.getColumn(0).getInt64());
      }
    } catch (const SQLite::Exception& error) {
      problems_.push_back(
          fmt::format("{}: damaged ({}); the messages before that are used", path_.string(), error.what()));
    }
    for (BagTopic& topic : topics_) {
      auto& messages = messages_[topic.name];
      std::sort(messages.begin(), messages.end());
      topic.messages = messages.size();
    }
  }

  fs::path path_;
  mutable std::mutex mutex_;
  SQLite::Database database_;
  std::map<int64_t, std::string> names_;
  std::map<std::string, std::vector<std::pair<TimeNs, int64_t>>> messages_;  ///< time and id, ascending
  std::vector<BagTopic> topics_;
  std::vector<std::string> problems_;
};

}  // namespace

std::unique_ptr<BagReader> open_sqlite_bag(const fs::path& path, const fs::path& name) {
  try {
    try {
      return std::make_unique<SqliteBag>(path, name);
    } catch (const SQLite::Exception& error) {
      if (error.getErrorCode() != SQLITE_CORRUPT) throw;
      return std::make_unique<SqliteBag>(path, name, true);
    }
  } catch (const SQLite::Exception& error) {
    throw Error(fmt::format("the database cannot be read as a rosbag2 recording: {}", error.what()),
                {name.string(), 0, {}}, "it has the tables topics and messages");
  }
}

}  // namespace loci::mapping
