#include "mapping/recording/ros/bag.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "mapping/base/config.h"
#include "mapping/base/error.h"
#include "mapping/recording/compression.h"
#include "mapping/recording/ros/packed_bag.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRos1Magic = "#ROSBAG V";
constexpr const char* kMcapMagic = "\x89MCAP";
constexpr const char* kSqliteMagic = "SQLite format 3";

bool begins_with(const fs::path& path, std::string_view magic) {
  std::ifstream file(path, std::ios::binary);
  std::string head(magic.size(), '\0');
  return file.read(head.data(), static_cast<std::streamsize>(head.size())) && head == magic;
}

bool is_mcap(const fs::path& path) {
  return fs::is_regular_file(path) && begins_with(path, kMcapMagic);
}

bool is_ros1(const fs::path& path) {
  return fs::is_regular_file(path) && begins_with(path, kRos1Magic);
}

bool is_sqlite(const fs::path& path) {
  return path.extension() == ".db3" && fs::is_regular_file(path) && begins_with(path, kSqliteMagic);
}

/// A file of rosbag2 that is compressed as a whole, and not there unpacked, too.
bool is_packed_alone(const fs::path& path) {
  return is_packed_bag(path) && !is_ros1_bag(path) && !fs::exists(fs::path(path).replace_extension());
}

/// The files of a recording of rosbag2 in their order.
std::vector<fs::path> storage_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_mcap(entry.path()) || is_sqlite(entry.path()) || is_packed_alone(entry.path()))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// A file of any format; of one that is compressed as a whole, `problems` says where it is damaged.
std::unique_ptr<BagReader> open_file(const fs::path& path, std::vector<std::string>& problems,
                                     Progress& progress) {
  if (is_mcap(path)) return open_mcap(path, path);
  if (is_sqlite(path)) return open_sqlite_bag(path, path);
  if (is_ros1(path)) return open_ros1_bag(path, path);
  if (!is_packed_bag(path))
    throw Error("this file is not a ROS 1 bag", {path.string(), 0, {}}, "a bag begins with '#ROSBAG V2.0'");
  const UnpackedBag bag(path, progress);  // Its name is gone when its reader has opened it.
  if (!bag.problem().empty()) problems.push_back(bag.problem());
  if (is_mcap(bag.path())) return open_mcap(bag.path(), path);
  if (begins_with(bag.path(), kSqliteMagic)) return open_sqlite_bag(bag.path(), path);
  if (is_ros1(bag.path())) return open_ros1_bag(bag.path(), path);
  throw Error("the compressed file does not hold a bag", {path.string(), 0, {}});
}

/// Several files as one bag; with compression per message, as metadata.yaml says.
class BagFolder : public BagReader {
 public:
  BagFolder(const fs::path& folder, Progress& progress) : folder_(folder) {
    read_metadata();
    for (const fs::path& file : storage_files(folder)) {
      try {
        readers_.push_back(open_file(file, problems_, progress));
      } catch (const Error& error) {
        problems_.emplace_back(error.what());
      }
    }
    if (readers_.empty() && !problems_.empty())
      throw Error("no file of this recording can be read: " + problems_.front(), {folder.string(), 0, {}});
    merge_topics();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<TimeNs> times(const std::string& topic) const override { return times_in(messages_, topic); }

  std::string message(const std::string& topic, size_t i) const override {
    const Message& message = messages_.at(topic).at(i);
    std::string bytes = readers_[message.reader]->message(topic, message.number);
    return per_message_ ? decompress("zstd", bytes, kMaxMessage) : bytes;
  }

  void visit(const std::function<bool(const BagTopic&)>& wanted, const Visitor& visitor) const override {
    if (per_message_) return BagReader::visit(wanted, visitor);
    std::map<std::pair<std::string, std::pair<size_t, size_t>>, size_t> number;
    for (const auto& [topic, messages] : messages_)
      for (size_t i = 0; i < messages.size(); ++i)
        number[{topic, {messages[i].reader, messages[i].number}}] = i;
    for (size_t r = 0; r < readers_.size(); ++r)
      readers_[r]->visit(wanted, [&](const BagTopic& topic, size_t i, TimeNs time, std::string_view bytes) {
        const auto found = number.find({topic.name, {r, i}});
        if (found != number.end()) visitor(topic, found->second, time, bytes);
      });
  }

  std::vector<std::string> problems() const override {
    std::vector<std::string> all = problems_;
    for (const auto& reader : readers_)
      for (std::string& text : reader->problems()) all.push_back(std::move(text));
    return all;
  }

 private:
  struct Message {
    TimeNs time = 0;
    size_t reader = 0, number = 0;
  };
  static constexpr size_t kMaxMessage = size_t{1} << 30;

  void read_metadata() {
    const fs::path file = folder_ / "metadata.yaml";
    if (!fs::exists(file)) return;
    try {
      const Config info = Config::read(file).map("rosbag2_bagfile_information");
      const std::string mode = info.get<std::string>("compression_mode", "");
      per_message_ = mode == "MESSAGE" || mode == "message";
      for (const std::string& name : info.get<std::vector<std::string>>("relative_file_paths", {}))
        check_listed(name);
    } catch (const Error& error) {
      problems_.push_back(fmt::format("metadata.yaml is not used: {}", error.what()));
    }
  }

  void check_listed(const std::string& name) {
    const fs::path file = folder_ / fs::path(name).filename();
    const fs::path plain = fs::path(file).replace_extension();
    if (!fs::exists(file) && !fs::exists(plain))
      problems_.push_back(fmt::format("{}, which metadata.yaml names, is missing", file.string()));
  }

  void merge_topics() {
    std::map<std::string, BagTopic> topics;
    for (size_t r = 0; r < readers_.size(); ++r) {
      for (const BagTopic& topic : readers_[r]->topics()) {
        BagTopic& merged = topics.try_emplace(topic.name, topic).first->second;
        if (merged.type != topic.type) {
          problems_.push_back(fmt::format("{} is {} in one file and {} in another, which is not read",
                                          topic.name, merged.type, topic.type));
          continue;
        }
        const std::vector<TimeNs> times = readers_[r]->times(topic.name);
        for (size_t i = 0; i < times.size(); ++i) messages_[topic.name].push_back({times[i], r, i});
      }
    }
    topics_ = with_sorted_messages(topics, messages_);
  }

  fs::path folder_;
  bool per_message_ = false;
  std::vector<std::unique_ptr<BagReader>> readers_;
  std::vector<BagTopic> topics_;
  std::map<std::string, std::vector<Message>> messages_;
  std::vector<std::string> problems_;
};

}  // namespace

bool is_ros1_bag(const fs::path& path) {
  return is_ros1(path) || (path.stem().extension() == ".bag" && is_packed_bag(path));
}

bool is_ros2_bag(const fs::path& path) {
  if (!fs::is_directory(path))
    return is_mcap(path) || is_sqlite(path) || (is_packed_bag(path) && !is_ros1_bag(path));
  return !storage_files(path).empty();
}

RosBag::RosBag(const fs::path& path, Progress* progress) : path_(path) {
  NoProgress none;
  Progress& unpacking = progress != nullptr ? *progress : none;
  if (fs::is_directory(path) && is_ros2_bag(path))
    reader_ = std::make_unique<BagFolder>(path, unpacking);
  else
    reader_ = open_file(path, problems_, unpacking);
}

std::vector<std::string> RosBag::problems() const {
  std::vector<std::string> all = problems_;
  for (std::string& text : reader_->problems()) all.push_back(std::move(text));
  return all;
}

const BagTopic* RosBag::find(const std::string& topic) const {
  for (const BagTopic& each : topics())
    if (each.name == topic) return &each;
  return nullptr;
}

}  // namespace loci::mapping
