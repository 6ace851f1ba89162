// Outputs never destroy inputs, and replace only what loci wrote.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A command that writes a file.
struct Writer {
  const char* name;
  std::string command;  ///< with OUT for the output
  std::string input;    ///< that it reads
};

class Outputs : public testing::TestWithParam<Writer> {
 protected:
  void SetUp() override {
    folder_ = fresh_folder();
    fs::copy_file(fs::path(LOCI_SOURCE_DIR) / "apps/samples/detections.jsonl", folder_ / "detections.jsonl");
    const Outcome made = run("cd " + folder_.string() + " && loci-memory ingest detections.jsonl -m m.loci");
    ASSERT_EQ(made.exit_code, 0) << made.error;
  }

  Outcome write(const std::string& out, const std::string& more = {}) const {
    std::string command = GetParam().command;
    command.replace(command.find("OUT"), 3, out);
    return run("cd " + folder_.string() + " && " + command + " " + more);
  }
  void expect_refused(const Outcome& outcome, const std::string& why) const {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr(why));
  }

  fs::path folder_;
};

TEST_P(Outputs, AnInputStays) {
  const fs::path input = folder_ / GetParam().input;
  const std::string before = read_file(input);
  fs::create_symlink(input.filename(), folder_ / "link");
  for (const std::string& out : {GetParam().input, "./" + GetParam().input, std::string("link")})
    for (const char* force : {"", "--force"})
      expect_refused(write(out, force), "is an input of this command");
  EXPECT_EQ(read_file(input), before);
}

TEST_P(Outputs, WhatLociDidNotWriteStays) {
  write_file_atomically(folder_ / "letter", "dear Ada");
  expect_refused(write("letter"), "loci did not write it");
  EXPECT_EQ(read_file(folder_ / "letter"), "dear Ada");
  EXPECT_EQ(write("letter", "--force").exit_code, 0);
  EXPECT_NE(read_file(folder_ / "letter"), "dear Ada");
}

TEST_P(Outputs, AMemoryStays) {
  ASSERT_EQ(run("cd " + folder_.string() + " && loci-memory ingest detections.jsonl -m other.loci").exit_code,
            0);
  const std::string before = read_file(folder_ / "other.loci");
  expect_refused(write("other.loci"), "other.loci");
  EXPECT_EQ(read_file(folder_ / "other.loci"), before);
}

TEST_P(Outputs, WhatLociWroteIsReplaced) {
  ASSERT_EQ(write("out").exit_code, 0);
  const std::string first = read_file(folder_ / "out");
  const Outcome again = write("out");
  EXPECT_EQ(again.exit_code, 0) << again.error;
  EXPECT_EQ(read_file(folder_ / "out").substr(0, 20), first.substr(0, 20));
}

INSTANTIATE_TEST_SUITE_P(Cli, Outputs,
                         testing::Values(Writer{"report", "loci-memory report -m m.loci -o OUT", "m.loci"},
                                         Writer{"catalogue", "loci-memory catalogue export OUT -m m.loci",
                                                "m.loci"}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace loci::apps::test
