#include "perception/conversions/ros_types.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "mapping/base/files.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kDefinition =
    "# a comment\nuint8 LOW=1\nstring NAME= a # b\nHeader header\nuint8 level  # how much\nuint32[] counts\n"
    "uint8[3] color\nstring[] words\nPart[] parts\nduration waited\ntime[2] times\nfloat32 f\nbool "
    "ok\nuint64 big\n"
    "================================================================================\nMSG: std_msgs/Header\n"
    "uint32 seq\ntime stamp\nstring frame_id\n"
    "================================================================================\nMSG: my_msgs/Part\n"
    "float64 size\nother_msgs/Empty nothing\n"
    "================================================================================\nMSG: "
    "other_msgs/Empty\n";

class Bytes {
 public:
  template <typename T>
  Bytes& add(T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  Bytes& text(const std::string& value) {
    add(static_cast<uint32_t>(value.size()));
    bytes += value;
    return *this;
  }
  std::string bytes;
};

std::string message() {
  Bytes bytes;
  bytes.add(uint32_t{7}).add(uint32_t{12}).add(uint32_t{5}).text("base");
  bytes.add(uint8_t{200}).add(uint32_t{2}).add(uint32_t{1}).add(uint32_t{4000000000});
  bytes.add(uint8_t{1}).add(uint8_t{2}).add(uint8_t{255});
  bytes.add(uint32_t{2}).text("a").text("");
  bytes.add(uint32_t{2}).add(0.5).add(-1.5);
  bytes.add(int32_t{-1}).add(int32_t{500000000});
  bytes.add(uint32_t{1}).add(uint32_t{0}).add(uint32_t{2}).add(uint32_t{3});
  return bytes.add(1.25F).add(uint8_t{1}).add(uint64_t{9}).bytes;
}

RosTypes types_of_definition() {
  RosTypes types;
  types.add("my_msgs/Thing", kDefinition, "a bag");
  return types;
}

std::shared_ptr<const cas::TypeSystem> system_of(const RosTypes& types) {
  return cas::TypeSystem::load({{"ros.xml", types.xml()}}, {}, {});
}

TEST(RosTypes, MessagesBecomeFeatureStructures) {
  const RosTypes types = types_of_definition();
  cas::Cas cas(system_of(types));
  const cas::FeatureStructure thing = types.read(cas, "my_msgs/Thing", message());
  EXPECT_EQ(thing.type().name(), "ros.my_msgs.Thing");
  const auto header = thing.get<cas::FeatureStructure>("header");
  EXPECT_EQ(header.get<int64_t>("sequence"), 7);
  EXPECT_EQ(header.get<cas::FeatureStructure>("stamp").get<int64_t>("nanoseconds"), 12000000005);
  EXPECT_EQ(header.get<std::string>("frame_id"), "base");
  EXPECT_EQ(thing.get<int16_t>("level"), 200);
  EXPECT_EQ(thing.array<int64_t>("counts")[1], 4000000000);
  EXPECT_EQ(thing.array<uint8_t>("color")[2], 255);
  EXPECT_EQ(thing.array<std::string>("words").size(), 2U);
  EXPECT_EQ(thing.list("parts").at(1).get<double>("size"), -1.5);
  EXPECT_EQ(thing.get<cas::FeatureStructure>("waited").get<int64_t>("nanoseconds"), -500000000);
  EXPECT_EQ(thing.list("times").at(1).get<int64_t>("nanoseconds"), 2000000003);
  EXPECT_TRUE(thing.get<bool>("ok"));
  EXPECT_EQ(thing.get<float>("f"), 1.25F);
  EXPECT_THAT(thing.type().description(), HasSubstr("LOW=1, NAME=a # b"));
}

TEST(RosTypes, MessagesOfAnotherLengthAreRefused) {
  const RosTypes types = types_of_definition();
  cas::Cas cas(system_of(types));
  const std::string whole = message();
  for (size_t length = 0; length < whole.size(); length += 3)
    EXPECT_THROW(types.read(cas, "my_msgs/Thing", whole.substr(0, length)), Error) << length;
  EXPECT_THROW(types.read(cas, "my_msgs/Thing", whole + "x"), Error);
}

TEST(RosTypes, FoldersOfDefinitionsGiveTheSameTypes) {
  const fs::path folder = fs::path(testing::TempDir()) / "ros_folder";
  fs::remove_all(folder);
  for (const char* package : {"my_msgs", "other_msgs", "std_msgs"}) make_folder(folder / package / "msg");
  const std::string text = kDefinition;
  write_file_atomically(folder / "my_msgs/msg/Thing.msg", text.substr(0, text.find("=====")));
  write_file_atomically(folder / "my_msgs/msg/Part.msg", "float64 size\nother_msgs/Empty nothing\n");
  write_file_atomically(folder / "std_msgs/msg/Header.msg", "uint32 seq\ntime stamp\nstring frame_id\n");
  RosTypes types;
  types.add_folder(folder);
  try {
    types.xml();
    FAIL() << "a definition is missing";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("my_msgs/Part uses other_msgs/Empty"));
  }
  write_file_atomically(folder / "other_msgs/msg/Empty.msg", "");
  types.add_folder(folder);
  EXPECT_EQ(types.xml(), types_of_definition().xml());
}

TEST(RosTypes, BrokenDefinitionsAreNamedWithTheirLine) {
  RosTypes types;
  for (const char* text : {"uint8\n", "uint8[x] a\n", "uint8 two words\n"}) {
    try {
      types.add("p/T", std::string("bool ok\n") + text, "T.msg");
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("T.msg:2")) << text;
    }
  }
  EXPECT_THROW(types.add_folder(testing::TempDir() + "/no such folder"), Error);
}

}  // namespace
}  // namespace loci::perception
