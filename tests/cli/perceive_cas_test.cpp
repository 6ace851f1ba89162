#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "tests/cli/command.h"
#include "tests/mapping/recording/bag_writer.h"

namespace loci::apps::test {
namespace {

using testing::HasSubstr;

const std::string kTypes = " --types tests/data/climate.xml -o ";

TEST(PerceiveCas, ConvertsInAllFourDirections) {
  const std::string folder = fresh_folder();
  const auto convert = [&](const std::string& from, const std::string& to) {
    const Outcome outcome = run("loci-perceive cas " + from + kTypes + folder + to);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return read_file(folder + to);
  };
  const std::string json = convert("tests/data/weather.xmi", "/a.json");
  EXPECT_THAT(json, HasSubstr("warm & dry"));
  const std::string xmi = convert(folder + "/a.json", "/b.xmi");
  EXPECT_EQ(convert(folder + "/b.xmi", "/c.json"), json);
  EXPECT_EQ(convert(folder + "/b.xmi", "/d.xmi"), xmi);
  EXPECT_EQ(convert(folder + "/c.json", "/e.json"), json);
}

TEST(PerceiveCas, RefusesInOneLine) {
  const std::string folder = fresh_folder();
  write_file_atomically(folder + "/bad.xmi", "<xmi:XMI xmlns:xmi=\"x\"><a></xmi:XMI>");
  write_file_atomically(folder + "/bad.json", "{\"views\": []}");
  const std::pair<std::string, std::string> table[] = {
      {"tests/data/weather.xmi" + kTypes + folder + "/a.txt", "neither XMI nor JSON"},
      {"tests/data/weather.xmi -o " + folder + "/a.json", "no type system"},
      {folder + "/bad.xmi" + kTypes + folder + "/a.json", "bad.xmi:1"},
      {folder + "/bad.json" + kTypes + folder + "/a.json", "bad.json"},
      {"none.xmi" + kTypes + folder + "/a.json", "none.xmi"}};
  for (const auto& [arguments, expected] : table) {
    const Outcome outcome = run("loci-perceive cas " + arguments);
    EXPECT_EQ(outcome.exit_code, 1) << arguments;
    EXPECT_THAT(outcome.error, HasSubstr(expected));
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  }
}

TEST(PerceiveCas, MessagesOfABagAreFeatureStructures) {
  const std::string folder = fresh_folder();
  mapping::test::write_bag(
      folder + "/small.bag",
      {{"/say",
        kSecond,
        {"std_msgs/String", "string data\n", mapping::test::MessageBytes().text("hello").bytes()}}});
  const Outcome outcome = run("loci-perceive cas " + folder + "/small.bag -o " + folder + "/a.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(read_file(folder + "/a.json"), HasSubstr("ros.std_msgs.String"));
  EXPECT_THAT(read_file(folder + "/a.json"), HasSubstr("hello"));
  EXPECT_EQ(run("loci-perceive cas " + folder + "/small.bag --topic /sat -o " + folder + "/b.json").exit_code,
            1);
  const Outcome types = run("loci-perceive types --ros " + folder + "/small.bag -o " + folder + "/types.xml");
  ASSERT_EQ(types.exit_code, 0) << types.error;
  EXPECT_THAT(types.out, HasSubstr("ros.std_msgs.String"));
  EXPECT_EQ(run("loci-perceive types " + folder + "/types.xml --with-loci").exit_code, 0);
  EXPECT_EQ(
      run("loci-perceive cas " + folder + "/a.json --types " + folder + "/types.xml -o " + folder + "/c.xmi")
          .exit_code,
      0);
}

}  // namespace
}  // namespace loci::apps::test
