#include "tests/cli/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "mapping/base/files.h"

namespace loci::apps::test {

namespace fs = std::filesystem;

std::string fresh_folder() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(info->test_suite_name()) + "_" + info->name();
  std::replace(name.begin(), name.end(), '/', '_');
  const fs::path folder = fs::temp_directory_path() / "loci_cli_tests" / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder.string();
}

Outcome run(const std::string& command) {
  const fs::path folder = fs::temp_directory_path() / ("loci_run_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string out = (folder / "out").string();
  const std::string error = (folder / "err").string();
  const std::string line = std::string("cd '") + LOCI_SOURCE_DIR + "' && PATH='" + LOCI_BIN_DIR +
                           "':$PATH && { " + command + "\n} >'" + out + "' 2>'" + error + "'";
  const int status = std::system(line.c_str());
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_file(out);
  outcome.error = read_file(error);
  fs::remove_all(folder);
  return outcome;
}

std::string shared(const std::string& relative) {
  const fs::path path = fs::path(LOCI_SHARED_DIR) / relative;
  return fs::exists(path) ? fs::canonical(path).string() : "";
}

int lines_of(const std::string& text) {
  std::istringstream stream(text);
  int count = 0;
  for (std::string line; std::getline(stream, line);) count += line.empty() ? 0 : 1;
  return count;
}

namespace {

class EveryProgram : public testing::TestWithParam<const char*> {};

TEST_P(EveryProgram, ExplainsItself) {
  const Outcome help = run(std::string(GetParam()) + " --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, testing::HasSubstr("Usage"));
}

TEST_P(EveryProgram, CallsWrongUsageWrongUsage) {
  EXPECT_EQ(run(std::string(GetParam()) + " --no-such-flag").exit_code, 2);
}

INSTANTIATE_TEST_SUITE_P(Programs, EveryProgram,
                         testing::Values("loci-map", "loci-perceive", "loci-memory", "loci-simulate",
                                         "loci-evaluate"));

TEST(Commands, SuggestTheNearestForAnUnknownOne) {
  const Outcome outcome = run("loci-map chek");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.error, testing::HasSubstr("did you mean 'check'?"));
}

}  // namespace
}  // namespace loci::apps::test
