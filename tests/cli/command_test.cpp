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
  const std::string line = std::string("cd '") + LOCI_SOURCE_DIR + "' && export TZ=UTC && PATH='" +
                           LOCI_BIN_DIR + "':$PATH && { " + command + "\n} >'" + out + "' 2>'" + error + "'";
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

TEST_P(EveryProgram, PrintsItsVersion) {
  EXPECT_THAT(run(std::string(GetParam()) + " --version").out, testing::StartsWith("loci "));
}

TEST_P(EveryProgram, SaysInOneLineThatItsAnswerIsLost) {
  for (const char* stdout_is : {" > /dev/full", " >&-"})
    for (const char* question : {" --help", " --version"}) {
      const Outcome lost = run(std::string(GetParam()) + question + stdout_is);
      EXPECT_EQ(lost.exit_code, 1) << question << stdout_is;
      EXPECT_EQ(lines_of(lost.error), 1) << lost.error;
    }
}

TEST_P(EveryProgram, EndsAsUsualWhereNobodyReadsItsErrors) {
  for (const char* stderr_is : {" 2> /dev/full", " 2>&-"})
    EXPECT_EQ(run(std::string(GetParam()) + " --no-such-flag" + stderr_is).exit_code, 2) << stderr_is;
}

INSTANTIATE_TEST_SUITE_P(Programs, EveryProgram,
                         testing::Values("loci-map", "loci-perceive", "loci-memory", "loci-simulate",
                                         "loci-evaluate", "loci"));

TEST(Commands, SayThatTheirAnswerIsLost) {
  for (const char* command :
       {"loci-map check apps/samples/kitchen.urdf", "loci-perceive list", "loci-memory questions"}) {
    const Outcome lost = run(std::string(command) + " > /dev/full");
    EXPECT_EQ(lost.exit_code, 1) << command;
    EXPECT_EQ(lines_of(lost.error), 1) << lost.error;
  }
}

TEST(Commands, RefuseAnEmptyValueOfAnOption) {
  // As of a variable of the shell that is not set. None of these may begin to work.
  const std::string folder = fresh_folder(), memory = folder + "/m.loci";
  ASSERT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + memory).exit_code, 0);
  const std::string before = read_file(memory);
  for (const std::string& command : std::vector<std::string>{
           "loci-memory forget object_1 -o \"\" -m " + memory,
           "loci-memory forget object_1 --tokens \"\" -m " + memory,
           "loci-memory retain --keep-images 0s -o \"\" -m " + memory,
           "loci-memory verify --forgotten \"\" -m " + memory, "loci-memory objects -m \"\"",
           "loci-memory objects --at \"\" -m " + memory, "loci-memory near red --radius \"\" -m " + memory,
           "loci-memory changes --between \"\" 10:00 -m " + memory,
           "loci-memory merge " + memory + " " + memory + " --transform \"\" -o " + folder + "/both.loci",
           "loci-memory digest -o \"\" -m " + memory, "loci-map register apps/samples -o \"\"",
           "loci-perceive run apps/samples -m \"\"", "loci-perceive convert apps/samples -o \"\"",
           "loci-map check \"\""}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 2) << command << outcome.out;
    EXPECT_THAT(outcome.error, testing::HasSubstr(" is empty")) << command;
  }
  EXPECT_EQ(read_file(memory), before);
}

TEST(Commands, DoNotReadWhatNeverEnds) {
  const std::string memory = fresh_folder() + "/m.loci";
  for (const std::string& command : std::vector<std::string>{
           "loci-map check /dev/zero", "loci-map export /dev/zero -o " + memory + ".svg --format svg",
           "loci-simulate record /dev/zero -o " + memory + ".day",
           "loci-memory ingest /dev/zero -m " + memory}) {
    const Outcome outcome = run("ulimit -v 4000000; timeout 60 " + command);
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_THAT(outcome.error, testing::HasSubstr("is not a regular file")) << command;
  }
}

TEST(Commands, RefuseFoldersForFilesBeforeTheyBegin) {
  const std::string folder = fresh_folder();
  const Outcome outcome = run("loci-perceive index no_images -o " + folder);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.error, testing::HasSubstr("is a folder, a file was expected"));
}

TEST(Commands, AddNothingToARecording) {
  const fs::path folder = fresh_folder();
  fs::create_directories(folder / "day/frames");
  write_file_atomically(folder / "day/.loci-recording", "frames.csv\n");
  for (const std::string& command : std::vector<std::string>{
           "loci-map fuse DAY -o DAY/frames", "loci-map fuse DAY -o DAY/new/scans",
           "loci-simulate scan apps/samples/kitchen.urdf --poses 1.5,1.5,0 -o DAY/frames",
           "loci-map export apps/samples/kitchen.urdf --format svg -o DAY/frames.csv"}) {
    std::string here = command;
    for (size_t at; (at = here.find("DAY")) != std::string::npos;)
      here.replace(at, 3, (folder / "day").string());
    const Outcome outcome = run(here);
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_THAT(outcome.error, testing::HasSubstr("lies within a recording")) << command;
  }
}

TEST(Commands, SuggestTheNearestForAnUnknownOne) {
  const Outcome outcome = run("loci-map chek");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.error, testing::HasSubstr("did you mean 'check'?"));
}

TEST(Commands, ExplainWrongUsageInOneLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"loci-map", "loci-map: no command is given; see loci-map --help\n"},
      {"loci-map fuse", "loci-map fuse: RECORDING is required; see loci-map fuse --help\n"},
      {"loci-map fuse recording --ouput scans",
       "loci-map fuse: unknown option '--ouput' (did you mean '--output'?); see loci-map fuse --help\n"},
      {"loci-map fuse recording --ouput=scans",
       "loci-map fuse: unknown option '--ouput' (did you mean '--output'?); see loci-map fuse --help\n"},
      {"loci-map check a.urdf b.urdf",
       "loci-map check: unexpected argument 'b.urdf'; see loci-map check --help\n"},
      {"loci-map fuse recording -o scans --every x",
       "loci-map fuse: --every: 'x' is not a whole number; see loci-map fuse --help\n"},
      {"loci-map check a.urdf --threads 2000",
       "loci-map check: --threads: 2000 is not allowed (0 to 1024); see loci-map check --help\n"},
      {"loci-map export a.urdf -o b --format stl",
       "loci-map export: --format: 'stl' is not one of glb, sdf, mjcf, owl, ply, grid, bt, svg; see loci-map "
       "export --help\n"},
      {"loci-memory was cup on table_1 --between 9 -m a.loci",
       "loci-memory was: --between needs 2 values; see loci-memory was --help\n"},
      {"loci-memory forget --between 9 -m a.loci",
       "loci-memory forget: --between needs 2 values; see loci-memory forget --help\n"},
      {"loci-memory changes --between 9 10 --between 11 12 -m a.loci",
       "loci-memory changes: --between is given several times; see loci-memory changes --help\n"},
      {"loci-memory stow banana shelf_1 -m a.loci",
       "loci-memory: unknown command 'stow' (did you mean 'task stow'?); see loci-memory --help\n"},
      {"loci-map articulate --before scans",
       "loci-map articulate: --before needs --after; see loci-map articulate --help\n"},
  };
  for (const auto& [command, message] : cases) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_EQ(outcome.error, message);
    EXPECT_EQ(outcome.out, "") << command;
  }
}

TEST(Commands, RefuseAnOutputThatCannotBeWrittenBeforeTheWork) {
  for (const std::string command : {"loci-map fuse absent", "loci-map track absent",
                                    "loci-map interpret absent", "loci-perceive convert absent"})
    EXPECT_THAT(run(command + " -o README.md/out").error,
                testing::ContainsRegex("README.md/out: cannot be written: .*/README.md is a file; write to"))
        << command;
  const std::string folder = fresh_folder();
  EXPECT_THAT(run("loci-map export apps/samples/kitchen.urdf -o " + folder + "/absent/map.sdf").error,
              testing::HasSubstr("cannot be written: the folder does not exist"));
}

TEST(Commands, RefuseAFolderThatIsNamedLikeAFile) {
  const std::string folder = fresh_folder();
  for (const std::string& command : {"loci-map fuse absent -o " + folder + "/room.ply",
                                     "loci-map interpret absent -o " + folder + "/map.urdf",
                                     "loci-perceive convert absent -o " + folder + "/day.zip"})
    EXPECT_THAT(run(command).error, testing::HasSubstr("what is written is a folder, its name ends in"));
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(Dispatcher, RunsTheProgramsBesideIt) {
  EXPECT_EQ(run("loci map check apps/samples/kitchen.urdf").out,
            run("loci-map check apps/samples/kitchen.urdf").out);
  EXPECT_EQ(run("loci help map check").out, run("loci-map check --help").out);
  EXPECT_EQ(run("loci map check absent.urdf").exit_code, 1);
  EXPECT_EQ(run("loci version").out, run("loci-map --version").out);
  const Outcome outcome = run("loci mpa check");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.error, "loci: unknown program 'mpa' (did you mean 'map'?); see loci --help\n");
}

TEST(Memory, IsFoundWhenTheCommandLineDoesNotNameIt) {
  const std::string folder = fresh_folder();
  const std::string inside = "cd '" + folder + "' && ";
  EXPECT_EQ(run(inside + "loci-memory objects").exit_code, 2) << "there is none";
  const std::string detections = LOCI_SOURCE_DIR "/apps/samples/detections.jsonl";
  ASSERT_EQ(run(inside + "loci-memory ingest " + detections + " -m one.loci").exit_code, 0);
  const Outcome named = run(inside + "loci-memory objects -m one.loci");
  const Outcome only = run(inside + "loci-memory objects");
  EXPECT_EQ(only.out, named.out);
  EXPECT_EQ(only.error, "memory: one.loci (the only memory in this folder)\n");
  EXPECT_EQ(run(inside + "loci-memory objects --quiet").error, "");
  const Outcome variable = run("LOCI_MEMORY='" + folder + "/one.loci' loci-memory objects");
  EXPECT_EQ(variable.out, named.out);
  EXPECT_EQ(variable.error, "memory: " + folder + "/one.loci (from LOCI_MEMORY)\n");
  fs::copy_file(folder + "/one.loci", folder + "/two.loci");
  const Outcome two = run(inside + "loci-memory objects");
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_THAT(two.error, testing::HasSubstr("several memories"));
}

}  // namespace
}  // namespace loci::apps::test
