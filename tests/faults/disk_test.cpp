// A disk that fails, is full or may not be written, and a clock that jumps back.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <random>
#include <sstream>

#include "mapping/base/files.h"
#include "memory/edits/edits.h"
#include "memory/store/store.h"
#include "tests/faults/faults.h"

namespace loci::testing_support {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

/// Without warnings, such as of a copy that a migration keeps.
int lines_of_errors(const std::string& text) {
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) count += line.starts_with("warning: ") ? 0 : 1;
  return count;
}

class FailingDisk : public FaultTest {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "nothing can be preloaded before a sanitizer";
#endif
    FaultTest::SetUp();
  }
  std::vector<std::string> failing_from(long change, int error) const {
    return {"LD_PRELOAD=" LOCI_FAULT_SHIM, "LOCI_FAULT_FOLDER=" + fs::canonical(folder_).string(),
            fmt::format("LOCI_FAULT_AFTER={}", change), fmt::format("LOCI_FAULT_ERROR={}", error),
            "LOCI_FAULT_COUNT=" + count_file().string()};
  }
  /// How many changes of files the operation makes.
  long changes() const {
    reset();
    EXPECT_EQ(run(-1, failing_from(0, 0)).exit_code, 0);
    const long count = std::stol(read_file(count_file()));
    fs::remove(count_file());
    return count;
  }
  /// Runs the operation with a disk that fails; whether it was refused.
  bool fail_from(long change, long last, int error) const {
    reset();
    const Finished finished = run(-1, failing_from(change, error));
    fs::remove(count_file());
    const std::string what =
        fmt::format("change {} of {} fails with {}", change, last, error == EIO ? "EIO" : "ENOSPC");
    if (finished.exit_code != 0) {  // the last changes only tidy up
      EXPECT_EQ(finished.exit_code, 1) << what << ": " << finished.error;
      EXPECT_EQ(lines_of_errors(finished.error), 1) << what << ": " << finished.error;
      EXPECT_THAT(finished.error, testing::Not(HasSubstr(".partial"))) << what;
    }
    expect_sound(what);
    return finished.exit_code != 0;
  }
  fs::path count_file() const {
    return folder_.string() + ".count";
  }
};

/// From the n-th change on everything fails, for n up to all that the operation makes.
TEST_P(FailingDisk, LeavesTheOldStateOrTheNewOne) {
  const long last = changes();
  ASSERT_GT(last, 3);
  std::mt19937 random(5);
  std::uniform_int_distribution<long> moment(1, last);
  int refused = 0;
  for (int round = 0; round < fault_rounds(3); ++round) {
    refused += fail_from(moment(random), last, round % 2 == 0 ? EIO : ENOSPC) ? 1 : 0;
    if (HasFailure()) break;
  }
  EXPECT_GT(refused, 0);
  fmt::print("{}: {} changes, {} times refused\n", GetParam().name, last, refused);
}

/// The end, where logs are folded into their file and files get their names.
TEST_P(FailingDisk, LosesNothingInTheLastChanges) {
  if (GetParam().resumes) GTEST_SKIP() << "commits scene by scene";
  const long last = changes();
  for (long from = std::max(1L, last - 12); from <= last && !HasFailure(); ++from) fail_from(from, last, EIO);
}

INSTANTIATE_TEST_SUITE_P(Faults, FailingDisk, testing::ValuesIn(all_operations()),
                         [](const auto& parameter) { return parameter.param.name; });

class Clock : public FaultTest {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "nothing can be preloaded before a sanitizer";
#endif
    FaultTest::SetUp();
  }
};

/// What is added when the clock is a day behind is known after what was added before.
TEST_P(Clock, ThatJumpsBackDoesNotTurnTheOrderOfCommitsRound) {
  reset();
  const std::vector<std::string> behind = {"LD_PRELOAD=" LOCI_FAULT_SHIM, "LOCI_FAULT_CLOCK_S=86400"};
  const auto say = [&](const char* name, const std::vector<std::string>& environment) {
    EXPECT_EQ(run_program(std::string("loci-memory fact set object_1 owner ") + name + " -m F/day.loci",
                          folder_, -1, environment)
                  .exit_code,
              0);
  };
  say("Ada", {});
  say("Ben", behind);
  const memory::Store store = memory::Store::open_read(memory());
  const std::vector<memory::RunRow> runs = store.runs();
  for (size_t i = 1; i < runs.size(); ++i) EXPECT_LE(runs[i - 1].started, runs[i].started);
  const auto owner = [&](const memory::AsOf& as_of) {
    std::string names;
    for (const memory::FactRow& fact : store.facts(as_of)) names += fact.value.value_or("") + " ";
    return names;
  };
  EXPECT_EQ(owner({}), "Ben ");
  EXPECT_EQ(owner({.known_at = runs.back().started - 1}), "Ada ");
  NoProgress quiet;
  EXPECT_THAT(store.verify(quiet).problems, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Faults, Clock, testing::Values(all_operations().at(2)),
                         [](const auto& parameter) { return parameter.param.name; });

class ReadOnlyFolder : public FaultTest {};

TEST_P(ReadOnlyFolder, IsRefusedInOneLine) {
  reset();
  constexpr uid_t kNobody = 65534;
  if (::geteuid() == 0) {  // root may write anywhere
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      ASSERT_EQ(::chown(entry.path().c_str(), kNobody, kNobody), 0);
    ASSERT_EQ(::chown(folder_.c_str(), kNobody, kNobody), 0);
    if (run_program("loci-memory --version", folder_, -1, {}, true).exit_code != 0)
      GTEST_SKIP() << "others may not run the programs";
  }
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  const Finished finished = run(-1, {}, true);
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_EQ(lines_of_errors(finished.error), 1) << finished.error;
  EXPECT_THAT(finished.error, HasSubstr("annot be written")) << finished.error;
  expect_sound("after a read-only folder");
}

INSTANTIATE_TEST_SUITE_P(Faults, ReadOnlyFolder, testing::ValuesIn(all_operations()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace loci::testing_support
