#include "mapping/base/config.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/options.h"

namespace loci {
namespace {

using testing::HasSubstr;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

struct TestOptions {
  double tolerance_m = 0.02;
  int count = 3;
  bool fast = false;
  std::string mode = "plane";
  void declare(OptionTable& table) {
    table.number("tolerance_m", tolerance_m, "m", "Largest gap.", 0.001, 1);
    table.integer("count", count, "", "How many.", 1, 10);
    table.flag("fast", fast, "Be quick.");
    table.text("mode", mode, "Which way.", {"plane", "point"});
  }
};

TEST(Config, NamesUnknownKeyWithTheNearestKnownOne) {
  const Config config = Config::parse("\ntolerence_m: 0.1\n", "p.yaml");
  const std::string message = message_of([&] { read_options<TestOptions>(config); });
  EXPECT_THAT(message, HasSubstr("p.yaml:2"));
  EXPECT_THAT(message, HasSubstr("tolerence_m"));
  EXPECT_THAT(message, HasSubstr("did you mean 'tolerance_m'?"));
}

TEST(Config, ReportsAllBadValuesAtOnce) {
  const Config config = Config::parse("{tolerance_m: 5, count: 0, mode: cube}", "p.yaml");
  const std::string message = message_of([&] { read_options<TestOptions>(config); });
  EXPECT_THAT(message, HasSubstr("tolerance_m is 5"));
  EXPECT_THAT(message, HasSubstr("count is 0"));
  EXPECT_THAT(message, HasSubstr("mode is 'cube'"));
}

TEST(Config, ReadsWhatIsGivenAndKeepsDefaults) {
  const auto options = read_options<TestOptions>(Config::parse("{count: 7, fast: true}", "p.yaml"));
  EXPECT_EQ(options.count, 7);
  EXPECT_TRUE(options.fast);
  EXPECT_EQ(options.tolerance_m, 0.02);
}

TEST(Config, SaysWhereAValueCannotBeRead) {
  const Config config = Config::parse("a:\n  b: [1, x]\n", "p.yaml");
  const Config inner = config.map("a");
  EXPECT_THAT(message_of([&] { inner.require<std::vector<double>>("b"); }), HasSubstr("p.yaml:2: a.b"));
  EXPECT_THAT(message_of([&] { inner.require<double>("c"); }), HasSubstr("'c' is missing"));
}

TEST(Config, RefusesAKeyThatStandsTwice) {
  EXPECT_THAT(message_of([] { Config::parse("a: 1\nb: 2\na: 3\n", "p.yaml"); }),
              HasSubstr("p.yaml:3: the key 'a' stands twice, first in line 1"));
  EXPECT_THAT(message_of([] { Config::parse("a: [{b: 1, b: 2}]", "p.yaml"); }),
              HasSubstr("'b' stands twice"));
}

TEST(Config, RefusesWhatIsNotYaml) {
  EXPECT_THAT(message_of([] { Config::parse("a: [1, 2", "p.yaml"); }), HasSubstr("p.yaml:"));
}

TEST(Config, RefusesWhatIsTooDeepOrGrowsThroughAliases) {
  EXPECT_THAT(
      message_of([] { Config::parse("a: " + std::string(100, '[') + std::string(100, ']'), "p.yaml"); }),
      HasSubstr("levels deep"));
  EXPECT_THAT(message_of([] { Config::parse(std::string(100000, '['), "p.yaml"); }), HasSubstr("p.yaml:1"));
  EXPECT_THAT(message_of([] { Config::parse("a: &a [*a, *a]", "p.yaml"); }), HasSubstr("levels deep"));
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    bomb += fmt::format("a{0}: &a{0} [", i);
    for (int k = 0; k < 10; ++k) bomb += (k > 0 ? ", " : "") + before;
    bomb += "]\n";
  }
  EXPECT_THAT(message_of([&] { Config::parse(bomb, "p.yaml"); }), HasSubstr("aliases expanded"));
  EXPECT_THAT(message_of([] { Config::parse("? [a, b]\n: c\n", "p.yaml"); }),
              HasSubstr("a key is not a name"));
}

}  // namespace
}  // namespace loci
