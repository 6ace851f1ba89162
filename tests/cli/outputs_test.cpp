// Outputs never destroy inputs, and replace only what loci wrote.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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
    for (const char* name : {"kitchen.urdf", "kitchen.semantic.json", "detections.jsonl"})
      fs::copy_file(fs::path(LOCI_SOURCE_DIR) / "apps/samples" / name, folder_ / name);
    if (GetParam().input != "m.loci") return;
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
  std::ofstream(folder_ / "letter") << "dear Ada";
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

INSTANTIATE_TEST_SUITE_P(
    Cli, Outputs,
    testing::Values(Writer{"sdf", "loci-map export kitchen.urdf --format sdf -o OUT", "kitchen.urdf"},
                    Writer{"glb", "loci-map export kitchen.urdf --format glb -o OUT", "kitchen.urdf"},
                    Writer{"owl", "loci-map export kitchen.urdf --format owl -o OUT", "kitchen.urdf"},
                    Writer{"ply", "loci-map export kitchen.urdf --format ply -o OUT", "kitchen.urdf"},
                    Writer{"svg", "loci-map export kitchen.urdf --format svg -o OUT", "kitchen.urdf"},
                    Writer{"bt", "loci-map export kitchen.urdf --format bt -o OUT", "kitchen.urdf"},
                    Writer{"report", "loci-memory report -m m.loci -o OUT", "m.loci"},
                    Writer{"catalogue", "loci-memory catalogue export OUT -m m.loci", "m.loci"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

/// A command that writes files of fixed names into a folder, one of which somebody else wrote.
struct FolderWriter {
  const char* name;
  std::string command;  ///< with OUT for the folder
  std::string file;     ///< that it would write
};

class FolderOutputs : public testing::TestWithParam<FolderWriter> {};

TEST_P(FolderOutputs, FilesOfOthersStay) {
  const fs::path folder = fresh_folder();
  fs::create_directories(folder / "out");
  std::ofstream(folder / "out" / GetParam().file) << "dear Ada";
  std::string command = GetParam().command;
  command.replace(command.find("OUT"), 3, (folder / "out").string());
  if (const size_t memory = command.find("MEMORY"); memory != std::string::npos) {
    command.replace(memory, 6, (folder / "m.loci").string());
    ASSERT_EQ(
        run("loci-memory ingest apps/samples/detections.jsonl -m " + (folder / "m.loci").string()).exit_code,
        0);
  }
  const Outcome refused = run(command);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error, HasSubstr("loci did not write it"));
  EXPECT_EQ(read_file(folder / "out" / GetParam().file), "dear Ada");
  EXPECT_EQ(run(command + " --force").exit_code, 0);
  EXPECT_EQ(run(command).exit_code, 0) << "its own files it replaces";
}

INSTANTIATE_TEST_SUITE_P(
    Cli, FolderOutputs,
    testing::Values(
        FolderWriter{"scans", "loci-simulate scan apps/samples/kitchen.urdf --poses 1.5,1.5,0 -o OUT",
                     "scans.yaml"},
        FolderWriter{"points", "loci-simulate scan apps/samples/kitchen.urdf --poses 1.5,1.5,0 -o OUT",
                     "scan_000.pcd"},
        FolderWriter{"grid", "loci-map export apps/samples/kitchen.urdf -o OUT/floor.pgm", "floor.yaml"},
        FolderWriter{"tables", "loci-memory export -m MEMORY -o OUT", "objects.csv"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace loci::apps::test
