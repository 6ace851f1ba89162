// A program that is killed at any moment loses no committed scene and leaves no half state.

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <random>
#include <regex>
#include <sstream>
#include <thread>

#include "mapping/base/files.h"
#include "memory/store/format.h"
#include "memory/store/store.h"
#include "tests/faults/faults.h"
#include "tests/memory/recorder/memory_dump.h"

namespace loci::testing_support {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::IsEmpty;

constexpr const char* kNobody = "65534";

fs::path templates() {
  return fs::temp_directory_path() / fmt::format("loci_faults_{}", ::getpid());
}

/// A memory as a program of version 1.0 wrote it.
void make_older(const fs::path& file) {
  SQLite::Database database(file.string(), SQLite::OPEN_READWRITE);
  for (const memory::Migration& migration : memory::kMemoryFormat.migrations) database.exec(migration.revert);
  database.exec("PRAGMA user_version = 1000; DELETE FROM meta WHERE key = 'digests'");
}

std::vector<std::string> words_of(const std::string& command, const fs::path& folder) {
  std::istringstream stream(command);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    if (word.starts_with("F/")) word = folder.string() + word.substr(1);
    words.push_back(word);
  }
  words.front() = std::string(LOCI_BIN_DIR "/") + words.front();
  return words;
}

[[noreturn]] void become(std::vector<std::string> words, const std::vector<std::string>& environment,
                         const fs::path& error, bool unprivileged) {
  if (::chdir(LOCI_SOURCE_DIR) != 0) ::_exit(126);
  for (const std::string& variable : environment) ::putenv(const_cast<char*>(variable.c_str()));
  const int out = ::open("/dev/null", O_WRONLY), log = ::open(error.c_str(), O_WRONLY | O_CREAT, 0600);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  const auto nobody = static_cast<uid_t>(std::stoi(kNobody));
  if (unprivileged && ::geteuid() == 0 && ::setuid(nobody) != 0) ::_exit(126);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(arguments.front(), arguments.data());
  ::_exit(127);
}

void must_succeed(const std::string& command) {
  const Finished finished = run_program(command, templates());
  ASSERT_EQ(finished.exit_code, 0) << command << ": " << finished.error;
}

/// Every other line of the sample, as a second robot would tell it.
void make_half(int half) {
  std::istringstream lines(read_file(fs::path(LOCI_SOURCE_DIR) / "apps/samples/detections.jsonl"));
  std::string text;
  int n = 0;
  for (std::string line; std::getline(lines, line);)
    if (n++ % 2 == half) text += line + "\n";
  write_file_atomically(templates() / fmt::format("half_{}.jsonl", half), text);
  must_succeed(fmt::format("loci-memory ingest F/half_{0}.jsonl -m F/half_{0}.loci", half));
}

/// What operations need, made once.
void make_template(const std::string& name) {
  if (fs::exists(templates() / name)) return;
  if (name == "day") {
    must_succeed("loci-simulate record apps/samples/cups.yaml -o F/day");
  } else if (name == "blocks.loci") {
    must_succeed("loci-perceive run tests/data/blocks --fixed-camera -m F/blocks.loci");
  } else if (name.starts_with("half_")) {
    make_half(name == "half_0.loci" ? 0 : 1);
  } else {
    must_succeed("loci-memory ingest apps/samples/detections.jsonl -m F/" + name);
    if (name == "edited.loci")
      must_succeed("loci-memory edit split object_1 2026-05-01T10:00:00Z -m F/edited.loci");
    if (name == "old.loci") make_older(templates() / name);
  }
}

}  // namespace

int fault_rounds(int few) {
  const char* const rounds = std::getenv("LOCI_FAULT_ROUNDS");
  return rounds == nullptr ? few : std::atoi(rounds);
}

Finished run_program(const std::string& command, const fs::path& folder, double kill_after_s,
                     const std::vector<std::string>& environment, bool unprivileged) {
  const fs::path error = fs::temp_directory_path() / fmt::format("loci_fault_error_{}", ::getpid());
  fs::remove(error);
  const std::vector<std::string> words = words_of(command, folder);
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) become(words, environment, error, unprivileged);
  if (kill_after_s >= 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kill_after_s));
    ::kill(child, SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const std::string text = fs::exists(error) ? read_file(error) : "";
  fs::remove(error);
  return {WIFSIGNALED(status), WIFEXITED(status) ? WEXITSTATUS(status) : -1, seconds.count(), text};
}

const std::vector<Operation>& all_operations() {
  static const std::vector<Operation> kAll = {
      {"run",
       "loci-perceive run F/day --map apps/samples/kitchen.urdf --resume --quiet -m F/new.loci",
       "new.loci",
       {"day"},
       true},
      {"ingest",
       "loci-memory ingest apps/samples/detections.jsonl --resume --quiet -m F/new.loci",
       "new.loci",
       {},
       true},
      {"edit",
       "loci-memory edit split object_1 2026-05-01T10:00:00Z -m F/day.loci",
       "day.loci",
       {"day.loci"}},
      {"undo", "loci-memory edit undo -m F/edited.loci", "edited.loci", {"edited.loci"}},
      {"label", "loci-memory edit label 1 0 cup -m F/day.loci", "day.loci", {"day.loci"}},
      {"forget", "loci-memory forget object_1 -m F/day.loci", "day.loci", {"day.loci"}},
      {"retain",
       "loci-memory retain --keep-images 0s --keep-reasoning 0s -m F/blocks.loci",
       "blocks.loci",
       {"blocks.loci"}},
      {"merge",
       "loci-memory merge F/half_0.loci F/half_1.loci --transform 0,0,0,0 -o F/new.loci",
       "new.loci",
       {"half_0.loci", "half_1.loci"}},
      {"reason", "loci-memory reason -m F/day.loci -o F/new.loci", "new.loci", {"day.loci"}},
      {"backup", "loci-memory backup -m F/day.loci -o F/new.loci", "new.loci", {"day.loci"}},
      {"migration", "loci-memory fact set object_1 alias tea -m F/old.loci", "old.loci", {"old.loci"}},
  };
  return kAll;
}

void FaultTest::SetUpTestSuite() {
  fs::remove_all(templates());
  make_folder(templates());
}

void FaultTest::TearDownTestSuite() {
  fs::remove_all(templates());
}

void FaultTest::SetUp() {
  folder_ = templates() / "work";
  for (const std::string& name : GetParam().files) make_template(name);
  reset();
  const std::string before = content();
  const Finished undisturbed = run();
  ASSERT_EQ(undisturbed.exit_code, 0) << undisturbed.error;
  seconds_ = undisturbed.seconds;
  result_ = content();
  ASSERT_NE(result_, before);
  states_ = {before, result_};
  if (GetParam().name == "migration") {
    reset();
    { const memory::Store migrated = memory::Store::open_write(memory()); }
    states_.push_back(content());
  }
}

void FaultTest::reset() const {
  fs::remove_all(folder_);
  make_folder(folder_);
  for (const std::string& name : GetParam().files)
    fs::copy(templates() / name, folder_ / name, fs::copy_options::recursive);
}

std::string FaultTest::content() const {
  if (!fs::exists(memory())) return {};
  std::string dump = memory::memory_dump(memory());
  const size_t tombstones = dump.find("== forgotten\n");  // they are random
  if (tombstones != std::string::npos) dump.erase(tombstones, dump.find("== map\n") - tombstones);
  if (GetParam().resumes) return dump;
  // What was done, without the numbers of runs, which those that were killed have taken.
  for (const memory::RunRow& run : memory::Store::open_read(memory()).runs())
    if (run.finished) dump += run.program + " " + run.configuration + "\n";
  return std::regex_replace(dump, std::regex("before/[0-9]+/"), "before/");
}

int64_t FaultTest::scenes() const {
  if (!fs::exists(memory())) return 0;
  return static_cast<int64_t>(memory::Store::open_read(memory()).scenes().size());
}

void FaultTest::expect_sound(const std::string& what) const {
  SCOPED_TRACE(what);
  if (fs::exists(memory())) {
    NoProgress quiet;
    EXPECT_THAT(memory::Store::open_read(memory()).verify(quiet).problems, IsEmpty());
  }
  const std::string now = content();
  const bool done = now == result_;
  if (!GetParam().resumes) {
    EXPECT_TRUE(std::ranges::find(states_, now) != states_.end()) << "a half state";
  }
  for (const std::string& name : GetParam().files) {
    if (name == GetParam().memory || !name.ends_with(".loci")) continue;
    EXPECT_EQ(read_file(folder_ / name), read_file(templates() / name)) << name << " was only read";
  }
  if (done && !GetParam().resumes) return;
  const Finished again = run();
  EXPECT_EQ(again.exit_code, 0) << again.error;
  expect_nothing_else();
  EXPECT_TRUE(content() == result_) << "called again it gives another result";
}

void FaultTest::expect_nothing_else() const {
  std::vector<std::string> allowed = GetParam().files;
  allowed.push_back(GetParam().memory);
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename();
    if (std::ranges::find(allowed, name) == allowed.end() && !name.starts_with("old.loci.1.0") &&
        !name.ends_with(".statistics.json"))
      ADD_FAILURE() << name << " is left behind";
  }
}

namespace {

TEST_P(FaultTest, KilledAtAnyMoment) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> moment(0, 1.1 * seconds_);
  int killed = 0;
  for (int round = 0; round < fault_rounds(1); ++round) {
    reset();
    const double after = moment(random);
    const Finished finished = run(after);
    killed += finished.killed ? 1 : 0;
    expect_sound(
        fmt::format("{} killed after {:.1f} of {:.1f} ms", GetParam().name, 1e3 * after, 1e3 * seconds_));
    if (HasFailure()) break;
  }
  RecordProperty("killed", killed);
  fmt::print("{}: killed {} times in {:.0f} ms\n", GetParam().name, killed, 1e3 * seconds_);
}

/// A run that is killed again and again goes on where it was.
TEST_P(FaultTest, ACommittedSceneIsNeverLost) {
  if (!GetParam().resumes) GTEST_SKIP() << "does all or nothing";
  std::mt19937 random(11);
  std::uniform_real_distribution<double> moment(0.3 * seconds_, 0.9 * seconds_);
  reset();
  int64_t before = 0;
  for (int round = 0; round < fault_rounds(3); ++round) {
    run(moment(random));
    const int64_t now = scenes();
    EXPECT_GE(now, before);
    before = now;
  }
  expect_sound("killed again and again");
}

INSTANTIATE_TEST_SUITE_P(Faults, FaultTest, testing::ValuesIn(all_operations()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace loci::testing_support
