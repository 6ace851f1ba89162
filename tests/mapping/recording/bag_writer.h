#pragma once

#include <ros/serialization.h>
#include <rosbag/bag.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/time.h"

namespace loci::mapping::test {

/// A message that is serialised already.
struct RawMessage {
  std::string type, definition, bytes;
};

/// Serialises as ROS 1 does.
class MessageBytes {
 public:
  template <typename T>
  MessageBytes& add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  MessageBytes& text(const std::string& value) {
    add(static_cast<uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  MessageBytes& header(TimeNs stamp, const std::string& frame) {
    add(uint32_t{0}).add(static_cast<uint32_t>(stamp / kSecond)).add(static_cast<uint32_t>(stamp % kSecond));
    return text(frame);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace loci::mapping::test

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<loci::mapping::test::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const loci::mapping::test::RawMessage&) {
    return "0123456789abcdef0123456789abcdef";
  }
};
template <>
struct DataType<loci::mapping::test::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const loci::mapping::test::RawMessage& m) { return m.type.c_str(); }
};
template <>
struct Definition<loci::mapping::test::RawMessage> {
  static const char* value() { return ""; }
  static const char* value(const loci::mapping::test::RawMessage& m) { return m.definition.c_str(); }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<loci::mapping::test::RawMessage> {
  template <typename Stream>
  static void write(Stream& stream, const loci::mapping::test::RawMessage& m) {
    std::memcpy(stream.advance(static_cast<uint32_t>(m.bytes.size())), m.bytes.data(), m.bytes.size());
  }
  static uint32_t serializedLength(const loci::mapping::test::RawMessage& m) {
    return static_cast<uint32_t>(m.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace loci::mapping::test {

struct BagEntry {
  std::string topic;
  TimeNs time_ns;
  RawMessage message;
};

inline void write_bag(const std::filesystem::path& path, const std::vector<BagEntry>& entries,
                      rosbag::CompressionType compression = rosbag::compression::Uncompressed) {
  rosbag::Bag bag(path.string(), rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(1024);
  for (const BagEntry& each : entries)
    bag.write(each.topic,
              ros::Time(static_cast<uint32_t>(each.time_ns / kSecond),
                        static_cast<uint32_t>(each.time_ns % kSecond)),
              each.message);
  bag.close();
}

}  // namespace loci::mapping::test
