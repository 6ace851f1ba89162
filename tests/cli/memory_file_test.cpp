// What is done with the file of a memory itself, and what other programs get out of it.

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/memory/questions/synthetic_day.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class MemoryFileCli : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder();
    file_ = folder_ + "/memory.loci";
    const memory::testing_support::SyntheticDay day(file_);
  }
  static Json answer(const std::string& command) {
    const Outcome outcome = run("loci-memory " + command + " --json");
    EXPECT_EQ(outcome.exit_code, 0) << command << ": " << outcome.error;
    return parse_json(outcome.out, command);
  }
  std::string folder_, file_;
};

TEST_F(MemoryFileCli, MergeWithItselfAddsNothingAndWithoutACommonFrameIsRefused) {
  const std::string joined = folder_ + "/joined.loci";
  const Json same = answer("merge " + file_ + " " + file_ + " -o " + joined);
  EXPECT_EQ(same["scenes"], 0);
  EXPECT_EQ(same["known_scenes"], 6);
  EXPECT_EQ(answer("objects -m " + joined), answer("objects -m " + file_));
  EXPECT_EQ(run("loci-memory verify -m " + joined).exit_code, 0);

  const std::string other = folder_ + "/other.loci";
  EXPECT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + other).exit_code, 0);
  const std::string both = folder_ + "/both.loci";
  const Outcome refused = run("loci-memory merge " + file_ + " " + other + " -o " + both);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error, HasSubstr("--transform"));
  EXPECT_FALSE(fs::exists(both));
  const Outcome joined_now =
      run("loci-memory merge " + file_ + " " + other + " --transform 0,0,0,0 -o " + both);
  EXPECT_EQ(joined_now.exit_code, 0) << joined_now.error;
  EXPECT_THAT(joined_now.out, HasSubstr("loci-memory reason -m " + both));
  EXPECT_EQ(run("loci-memory verify -m " + both).exit_code, 0);
}

TEST_F(MemoryFileCli, ClocksAreThoseOfTheZoneThatIsNamedOrOfTheMachine) {
  const std::string home = folder_ + "/home.loci", here = folder_ + "/here.loci";
  const std::string ingest = "loci-memory ingest apps/samples/detections.jsonl -m ";
  EXPECT_EQ(run(ingest + home + " --time-zone Europe/Berlin").exit_code, 0);
  EXPECT_EQ(run("TZ=Asia/Kathmandu " + ingest + here).exit_code, 0);
  EXPECT_EQ(answer("time-zone -m " + home)["time_zone"], "Europe/Berlin");
  EXPECT_EQ(answer("time-zone -m " + here)["time_zone"], "Asia/Kathmandu");
  // The cereal was on the table at 07:40 UTC, and on the counter half an hour before.
  EXPECT_THAT(run("loci-memory where cereal --at 9:40 -m " + home).out, HasSubstr("on table_1"));
  EXPECT_THAT(run("loci-memory where cereal --at 9:10 -m " + home).out, HasSubstr("on counter_1"));
  EXPECT_EQ(answer("time-zone UTC -m " + home)["time_zone"], "UTC");
  EXPECT_THAT(run("loci-memory where cereal --at 7:40 -m " + home).out, HasSubstr("on table_1"));
  const Outcome refused = run("loci-memory time-zone Berlin -m " + home);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error, HasSubstr("Europe/Berlin"));
  EXPECT_EQ(answer("time-zone -m " + home)["time_zone"], "UTC") << "a refused zone changes nothing";
}

TEST_F(MemoryFileCli, MergeReasonsOverWhatTwoHalvesSaw) {
  // One story, told by two robots in turns.
  const std::string lines = read_file(fs::path(LOCI_SOURCE_DIR) / "apps/samples/detections.jsonl");
  std::istringstream stream(lines);
  std::string halves[2];
  int n = 0;
  for (std::string line; std::getline(stream, line);) halves[n++ % 2] += line + "\n";
  for (const int half : {0, 1}) {
    const std::string name = folder_ + "/half_" + std::to_string(half);
    write_file_atomically(name + ".jsonl", halves[half]);
    EXPECT_EQ(run("loci-memory ingest " + name + ".jsonl -m " + name + ".loci").exit_code, 0);
  }
  EXPECT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + folder_ + "/whole.loci").exit_code,
            0);
  const Json merged =
      answer("merge " + folder_ + "/half_0.loci " + folder_ + "/half_1.loci --transform 0,0,0,0 -o " +
             folder_ + "/apart.loci --reason " + folder_ + "/together.loci");
  EXPECT_GT(merged["reason"]["scenes"].get<int>(), 0);
  const auto objects = [&](const std::string& name) {
    return answer("objects -m " + folder_ + "/" + name + ".loci")["objects"].size();
  };
  EXPECT_GT(objects("apart"), objects("together"));
  EXPECT_EQ(objects("together"), objects("whole"));
  EXPECT_EQ(run("loci-memory verify -m " + folder_ + "/together.loci").exit_code, 0);
}

TEST_F(MemoryFileCli, RetainLetsOldImagesGoAndKeepsTheAnswers) {
  const std::string smaller = folder_ + "/smaller.loci";
  const Json before = answer("objects -m " + file_);
  const Json result = answer("retain --keep-images 1h -m " + file_ + " -o " + smaller);
  EXPECT_EQ(result["scenes_without_images"], 3);  // the last scene is at 10:30; at 09:30 it is an hour
  EXPECT_EQ(answer("objects -m " + smaller), before);
  EXPECT_EQ(run("loci-memory verify -m " + smaller).exit_code, 0);
  EXPECT_EQ(run("loci-memory retain --keep-images soon -m " + smaller).exit_code, 1);
}

TEST_F(MemoryFileCli, RetainLetsReasonsGoAndWhyAndReasonSaySo) {
  const std::string memory = folder_ + "/detections.loci", smaller = folder_ + "/smaller.loci";
  ASSERT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + memory).exit_code, 0);
  EXPECT_EQ(run("loci-memory why scene_2 -m " + memory).exit_code, 0);
  const Json result = answer("retain --keep-reasoning 2h -m " + memory + " -o " + smaller);
  ASSERT_GT(result["scenes_without_reasoning"], 1);
  EXPECT_LT(result["bytes_after"], result["bytes_before"]);
  EXPECT_EQ(answer("objects -m " + smaller), answer("objects -m " + memory));
  const Outcome why = run("loci-memory why scene_2 -m " + smaller);
  EXPECT_EQ(why.exit_code, 1);
  EXPECT_THAT(why.error, HasSubstr("was let go"));
  EXPECT_EQ(run("loci-memory why scene_12 -m " + smaller).exit_code, 0);
  const Json anew = answer("reason -m " + smaller + " -o " + folder_ + "/anew.loci");
  EXPECT_EQ(anew["let_go"], result["scenes_without_reasoning"]);
  EXPECT_EQ(anew["scenes"], 12 - anew["let_go"].get<int>());
  EXPECT_TRUE(anew["from"].is_string());
  EXPECT_EQ(run("loci-memory retain --keep-reasoning 0s -m " + smaller).exit_code, 0);
  EXPECT_EQ(run("loci-memory verify -m " + smaller).exit_code, 0);
}

TEST_F(MemoryFileCli, AnOutputIsNeverTheMemoryItselfUnderWhateverName) {
  const std::string link = folder_ + "/link.loci", hard = folder_ + "/hard.loci", before = read_file(file_);
  fs::create_symlink("memory.loci", link);
  fs::create_hard_link(file_, hard);
  for (const std::string& output : {file_, folder_ + "/./memory.loci", link, hard})
    for (const std::string command : {"forget object_1 -m ", "retain --keep-images 1h -m ", "backup -m ",
                                      "reason -m ", "restore --force "}) {
      const Outcome refused = run("loci-memory " + command + file_ + " -o " + output);
      EXPECT_EQ(refused.exit_code, 1) << command << output;
      EXPECT_THAT(refused.error, HasSubstr("is an input of this command"));
      EXPECT_EQ(lines_of(refused.error), 1);
      EXPECT_EQ(read_file(file_), before);
    }
  EXPECT_TRUE(fs::is_symlink(link));
}

TEST_F(MemoryFileCli, ANewMemoryNeverReplacesAFile) {
  const std::string letter = folder_ + "/letter.txt";
  write_file_atomically(letter, "dear loci");
  for (const std::string& command :
       std::vector<std::string>{"forget object_1 -m ", "retain --keep-images 1h -m ", "backup -m ",
                                "reason -m ", "restore ", "merge " + file_ + " "}) {
    const Outcome refused = run("loci-memory " + command + file_ + " -o " + letter);
    EXPECT_EQ(refused.exit_code, 1) << command;
    EXPECT_THAT(refused.error, HasSubstr("exists already"));
    EXPECT_EQ(read_file(letter), "dear loci");
  }
  EXPECT_EQ(run("loci-memory forget object_99 -m " + file_ + " -o " + folder_ + "/none.loci").exit_code, 1);
  EXPECT_FALSE(fs::exists(folder_ + "/none.loci")) << "a copy in which nothing was forgotten";
}

TEST_F(MemoryFileCli, BackupAndRestoreGiveTheSameAnswers) {
  const std::string backup = folder_ + "/backup.loci", restored = folder_ + "/restored.loci";
  const Json made = answer("backup -m " + file_ + " -o " + backup);
  EXPECT_EQ(made["scenes"], 6);
  EXPECT_EQ(answer("restore " + backup + " -o " + restored)["bytes"], made["bytes"]);
  EXPECT_EQ(answer("objects -m " + restored), answer("objects -m " + file_));
  EXPECT_EQ(answer("restore " + backup + " -o " + restored + " --force")["ok"], true);
}

/// Where files cannot become larger than some kilobytes, as on a full disk: each command says so in one line.
class FullDisk : public MemoryFileCli {
 protected:
  static Outcome run_limited(int kilobytes, const std::string& command) {
    // bash counts in 1,024 bytes. Without the trap the system would end the program.
    return run("bash -c \"trap '' XFSZ; ulimit -f " + std::to_string(kilobytes) + "; " + command + "\"");
  }
  static void expect_one_line(const Outcome& outcome) {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_THAT(outcome.error, testing::AnyOf(HasSubstr("disk"), HasSubstr("cannot be written")));
  }
  /// Names of the files in the test's folder.
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path().filename().string());
    return names;
  }
  static int kilobytes_of(const std::string& file) { return static_cast<int>(fs::file_size(file) / 1024); }
};

TEST_F(FullDisk, WhatMakesAMemoryLeavesNothingBehind) {
  const std::set<std::string> before = files();
  const int limit = kilobytes_of(file_) / 2;
  expect_one_line(run_limited(limit, "loci-memory reason -m " + file_ + " -o " + folder_ + "/anew.loci"));
  expect_one_line(
      run_limited(limit, "loci-memory merge " + file_ + " " + file_ + " -o " + folder_ + "/both.loci"));
  expect_one_line(run_limited(
      limit, "loci-memory retain --keep-images 1h -m " + file_ + " -o " + folder_ + "/less.loci"));
  EXPECT_EQ(files(), before);
}

TEST_F(FullDisk, WhatAddsToAMemoryLeavesItSound) {
  const std::string memory = folder_ + "/detections.loci";
  ASSERT_EQ(run("head -n 6 apps/samples/detections.jsonl > " + folder_ + "/first.jsonl").exit_code, 0);
  ASSERT_EQ(run("loci-memory ingest " + folder_ + "/first.jsonl -m " + memory).exit_code, 0);
  const Json before = answer("objects -m " + memory);
  ASSERT_EQ(run("loci-memory catalogue export " + folder_ + "/home.json -m " + file_).exit_code, 0);
  const int limit = 8;  // less than one transaction of any of them
  expect_one_line(
      run_limited(limit, "loci-memory ingest apps/samples/detections.jsonl --resume -m " + memory));
  expect_one_line(run_limited(limit, "loci-memory catalogue import " + folder_ + "/home.json -m " + memory));
  EXPECT_EQ(answer("objects -m " + memory), before);
  EXPECT_EQ(run("loci-memory verify -m " + memory).exit_code, 0);
  EXPECT_EQ(run("loci-memory ingest apps/samples/detections.jsonl --resume -m " + memory).exit_code, 0)
      << "goes on when there is room";
}

TEST_F(MemoryFileCli, ForgetNamesTheCopiesThatMigrationsKept) {
  const std::string copy = file_ + ".1.0", tokens = folder_ + "/tokens.json";
  fs::copy_file(file_, copy);
  fs::copy_file(file_, file_ + ".bak");
  const Json result = answer("forget object_1 --tokens " + tokens + " -m " + file_);
  EXPECT_EQ(result["copies"], Json::array({copy}));
  const Outcome left = run("loci-memory verify --forgotten " + tokens + " -m " + file_);
  EXPECT_EQ(left.exit_code, 1);
  EXPECT_THAT(left.out, HasSubstr("kept before a migration"));
  fs::remove(copy);
  EXPECT_EQ(run("loci-memory verify --forgotten " + tokens + " -m " + file_).exit_code, 0);
}

TEST_F(MemoryFileCli, AHardLinkedMemoryIsReadAndRefusedForWritingInOneLine) {
  fs::create_hard_link(file_, folder_ / fs::path("hard.loci"));
  EXPECT_EQ(run("loci-memory objects -m " + file_).exit_code, 0);
  const Outcome refused = run("loci-memory fact set object_1 alias tea -m " + file_);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_EQ(lines_of(refused.error), 1) << refused.error;
  EXPECT_THAT(refused.error, HasSubstr("has 2 names (hard links)"));
  EXPECT_THAT(refused.error, HasSubstr("remove the other name"));
}

TEST_F(MemoryFileCli, VerifyRepairsWhatFollowsFromOtherRows) {
  const Json before = answer("on table_1 -m " + file_);
  {
    SQLite::Database database(file_, SQLite::OPEN_READWRITE);
    for (const char* table : {"stay", "visit", "observation_rank", "scene_rank", "object_term"})
      database.exec(std::string("DELETE FROM ") + table);
  }
  const Outcome damaged = run("loci-memory verify -m " + file_);
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.error, HasSubstr("--repair"));
  const Json repaired = answer("verify --repair -m " + file_);
  EXPECT_GT(repaired["repaired"].get<int>(), 0);
  EXPECT_TRUE(repaired["ok"].get<bool>());
  EXPECT_EQ(answer("on table_1 -m " + file_), before);
  EXPECT_EQ(answer("verify --repair -m " + file_)["repaired"], 0);
}

TEST_F(MemoryFileCli, ExportsOwlIndividualsWithTime) {
  const Json result = answer("export --include owl labels clouds -m " + file_ + " -o " + folder_ + "/out");
  EXPECT_EQ(result["rows"]["objects"], 4);
  const std::string owl = read_file(folder_ + "/out/individuals.owl");
  for (const char* expected : {"#object_1\"", "knowrob.owl#HumanScaleObject", "knowrob:startTime",
                               "knowrob:endTime", "#object_1_stay_2\"", "#pose_object_1_stay_2\"",
                               "<rdfs:label>tea cup</rdfs:label>", "#counter_1\"", "owl:ObjectProperty"})
    EXPECT_THAT(owl, HasSubstr(expected));
}

TEST_F(MemoryFileCli, TheExamplesOfTheViewsWorkAsPrinted) {
  const std::string page = read_file(fs::path(LOCI_SOURCE_DIR) / "docs/memory.md");
  std::istringstream stream(page);
  bool inside = false;
  int executed = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("```")) inside = line == "```sh";
    const std::string program = line.substr(0, line.find(' '));
    if (!inside || (program != "sqlite3" && program != "python3" && program != "duckdb")) continue;
    if (run("command -v " + program).exit_code != 0) {
      std::cout << "not installed: " << program << "\n";
      continue;
    }
    const Outcome outcome = run("cd " + folder_ + " && " + line);
    EXPECT_EQ(outcome.exit_code, 0) << line << ": " << outcome.error;
    EXPECT_NE(outcome.out, "") << line;
    ++executed;
  }
  if (executed == 0) GTEST_SKIP() << "neither sqlite3 nor python3 is installed";
}

}  // namespace
}  // namespace loci::apps::test
