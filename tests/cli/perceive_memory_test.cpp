#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/memory/recorder/memory_dump.h"

namespace loci::apps::test {
namespace {

using ::testing::HasSubstr;

/// The sample day into a memory, in a folder of its own.
class PerceiveIntoMemory : public ::testing::Test {
 protected:
  void SetUp() override {
    recording = std::filesystem::temp_directory_path() / ("loci_day_" + std::to_string(getpid()));
    folder = fresh_folder();
    const Outcome outcome =
        loci::apps::test::run("loci-simulate record apps/samples/day.yaml --quiet -o " + recording.string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  void TearDown() override { std::filesystem::remove_all(recording); }

  std::string command(const std::string& memory, const std::string& more = {}) const {
    return std::string(LOCI_BIN_DIR "/loci-perceive run ") + recording.string() +
           " --map " LOCI_SOURCE_DIR "/apps/samples/kitchen.urdf --quiet -m " + (folder / memory).string() +
           " " + more;
  }

  /// Starts a run in a process of its own and sends it a signal after some time; its wait status.
  int run_and_signal(const std::string& memory, const std::string& more, int signal,
                     std::chrono::milliseconds after) const {
    const pid_t child = fork();
    if (child == 0) {
      const std::string line = "exec " + command(memory, more) + " >/dev/null 2>&1";
      execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      _exit(127);
    }
    std::this_thread::sleep_for(after);
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    return status;
  }

  std::filesystem::path recording, folder;
};

TEST_F(PerceiveIntoMemory, KilledAtAnyMomentAndResumedGivesTheMemoryOfAnUninterruptedRun) {
  ASSERT_EQ(loci::apps::test::run(command("whole.loci")).exit_code, 0);
  for (int attempt = 0; attempt < 6; ++attempt) {
    run_and_signal("killed.loci", "--resume", SIGKILL, std::chrono::milliseconds(150 + 170 * attempt));
    if (!std::filesystem::exists(folder / "killed.loci")) continue;
    const Outcome verify = loci::apps::test::run(std::string(LOCI_BIN_DIR "/loci-memory verify -m ") +
                                                 (folder / "killed.loci").string());
    // Killed before the first commit it leaves a database without tables.
    EXPECT_TRUE(verify.exit_code == 0 || verify.error.find("is empty") != std::string::npos) << verify.error;
  }
  const Outcome rest = loci::apps::test::run(command("killed.loci", "--resume"));
  ASSERT_EQ(rest.exit_code, 0) << rest.error;
  EXPECT_EQ(memory::memory_dump(folder / "whole.loci"), memory::memory_dump(folder / "killed.loci"));
}

TEST_F(PerceiveIntoMemory, ThreadsDoNotChangeTheMemory) {
  ASSERT_EQ(loci::apps::test::run(command("one.loci", "--threads 1")).exit_code, 0);
  ASSERT_EQ(loci::apps::test::run(command("two.loci", "--threads 2")).exit_code, 0);
  EXPECT_EQ(memory::memory_dump(folder / "one.loci"), memory::memory_dump(folder / "two.loci"));
}

TEST_F(PerceiveIntoMemory, SameRecordingTwiceIsRefusedWithOneLine) {
  ASSERT_EQ(loci::apps::test::run(command("twice.loci")).exit_code, 0);
  const std::string before = memory::memory_dump(folder / "twice.loci");
  const Outcome again = loci::apps::test::run(command("twice.loci"));
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.error, HasSubstr("in the memory already"));
  EXPECT_EQ(std::count(again.error.begin(), again.error.end(), '\n'), 1);
  EXPECT_EQ(memory::memory_dump(folder / "twice.loci"), before);
}

TEST_F(PerceiveIntoMemory, ResumingSaysWhatItLeavesOut) {
  ASSERT_EQ(loci::apps::test::run(command("some.loci", "--every 6")).exit_code, 0);
  const Outcome again = loci::apps::test::run(command("some.loci"));
  EXPECT_THAT(again.error, HasSubstr("(4 of 24 frames); --resume adds the 5 frames after the last"));
  EXPECT_THAT(again.error, HasSubstr("remove " + (folder / "some.loci").string()));
  const Outcome resumed = loci::apps::test::run(command("some.loci", "--resume"));
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
  EXPECT_THAT(resumed.out, HasSubstr("5 frames, "));
  EXPECT_THAT(resumed.out, HasSubstr("4 frames in the memory already; left out: 15 frames before the last"));
  const Outcome whole = loci::apps::test::run(command("some.loci"));
  EXPECT_THAT(whole.error, testing::Not(HasSubstr("--resume")));
}

TEST_F(PerceiveIntoMemory, ARecordingOfAnEarlierTimeSaysWhatToDo) {
  ASSERT_EQ(loci::apps::test::run(command("day.loci")).exit_code, 0);
  const auto record = [&](const std::string& rest) {
    const std::string from = recording.string(), to = (folder / "images").string();
    return loci::apps::test::run("rm -rf " + to + " && cp -r " + from + " " + to + " && cut -d, -f1,3- " +
                                 from + "/frames.csv > " + to + "/frames.csv && loci-perceive run " + to +
                                 " --quiet --every 8 -m " + (folder / "day.loci").string() + " " + rest);
  };
  const std::string before = memory::memory_dump(folder / "day.loci");
  const Outcome early = record("");
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.error,
              HasSubstr("the recording begins at 2000-01-01T00:00:00Z (made up), before the last"));
  EXPECT_THAT(early.error, HasSubstr("--start TIME"));
  EXPECT_THAT(early.error, testing::Not(HasSubstr("IdentityResolution")));
  EXPECT_EQ(memory::memory_dump(folder / "day.loci"), before);
  EXPECT_EQ(record("--start 2036-05-01T08:30:00Z").exit_code, 0);
}

TEST_F(PerceiveIntoMemory, RecordingIsKnownByItsContentNotItsPath) {
  ASSERT_EQ(loci::apps::test::run(command("moved.loci")).exit_code, 0);
  std::filesystem::copy(recording, folder / "elsewhere", std::filesystem::copy_options::recursive);
  recording = folder / "elsewhere";
  EXPECT_EQ(loci::apps::test::run(command("moved.loci")).exit_code, 1);
  const Outcome resumed = loci::apps::test::run(command("moved.loci", "--resume"));
  EXPECT_EQ(resumed.exit_code, 0);
  EXPECT_THAT(resumed.out, HasSubstr("24 frames in the memory already"));
}

TEST_F(PerceiveIntoMemory, InterruptLeavesWholeScenesAndExits130) {
  // On a busy machine the first signals may come before the program listens.
  int status = 0;
  for (int wait_ms = 400; wait_ms <= 3200; wait_ms *= 2) {
    status = run_and_signal("stopped.loci", "--resume", SIGINT, std::chrono::milliseconds(wait_ms));
    if (WIFEXITED(status)) break;
  }
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 0) GTEST_SKIP() << "it was done before the signal came";
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_EQ(loci::apps::test::run(command("stopped.loci", "--resume")).exit_code, 0);
  ASSERT_EQ(loci::apps::test::run(command("whole.loci")).exit_code, 0);
  EXPECT_EQ(memory::memory_dump(folder / "whole.loci"), memory::memory_dump(folder / "stopped.loci"));
}

TEST_F(PerceiveIntoMemory, WhatItSawIsADatasetToTrainFrom) {
  ASSERT_EQ(loci::apps::test::run(command("day.loci")).exit_code, 0);
  const auto memory = [&](const std::string& rest) {
    return loci::apps::test::run(std::string(LOCI_BIN_DIR "/loci-memory ") + rest + " --quiet -m " +
                                 (folder / "day.loci").string());
  };
  const std::string dataset = (folder / "dataset").string();
  for (const char* fact : {"object_3 class pot", "object_4 class mug", "object_5 class mug"})
    ASSERT_EQ(memory(std::string("fact set ") + fact).exit_code, 0);
  ASSERT_EQ(memory("edit label 1 0 cereal").exit_code, 0);
  const Outcome written =
      memory("export --dataset " + dataset + " --recording " + recording.string() + " --json");
  ASSERT_EQ(written.exit_code, 0) << written.error;
  const Json classes = parse_json(written.out, "stdout").at("classes");
  EXPECT_EQ(classes.at("cereal"), 1) << "what people label is one image";
  EXPECT_GT(classes.at("mug").get<int>(), 10);
  const std::string model = (folder / "things.model").string();
  const Outcome trained =
      loci::apps::test::run(std::string(LOCI_BIN_DIR "/loci-perceive train ") + dataset + " -o " + model +
                            " --folds 2 --expert VFH:svm --json --quiet");
  ASSERT_EQ(trained.exit_code, 0) << trained.error;
  const Json accuracies = parse_json(trained.out, "stdout").at("accuracies");
  EXPECT_FALSE(accuracies.contains("cereal")) << "one is too few";
  EXPECT_GT(accuracies.at("mug").get<double>(), 0.8);
  EXPECT_TRUE(std::filesystem::exists(model));
}

TEST(EvaluateChanges, TellsMostOfWhatHappenedOnARealTable) {
  LOCI_NEEDS_SHARED("data/osd_changes");
  const std::string recording = shared("data/osd_changes");
  const Outcome result = loci::apps::test::run(std::string(LOCI_BIN_DIR "/loci-evaluate changes ") +
                                               recording + " --json --quiet");
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json json = parse_json(result.out, "stdout");
  EXPECT_GE(json.at("right").get<int>(), 28);
  EXPECT_EQ(json.at("certain").get<int>(), 33);
}

}  // namespace
}  // namespace loci::apps::test
