#include "mapping/base/output_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <fmt/format.h>

#include <csignal>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"

namespace loci {
namespace {

namespace fs = std::filesystem;

constexpr OutputOptions kAnything{.replace = Replace::anything};

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("loci_output_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    make_folder(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  size_t count() const { return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), {})); }
  static unsigned mode_of(const fs::path& path) {
    return static_cast<unsigned>(fs::status(path).permissions()) & 0777U;
  }
  bool has_extended_attributes() const { return ::setxattr(folder_.c_str(), "user.test", "", 0, 0) == 0; }
  std::string refusal(const fs::path& path, const OutputOptions& options) {
    try {
      write_output(path, "new", options);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
  fs::path folder_;
};

TEST_F(OutputFileTest, HasItsNameOnlyAfterCommit) {
  {
    OutputFile file(folder_ / "x");
    file.write("new");
    EXPECT_FALSE(fs::exists(folder_ / "x"));
    EXPECT_EQ(file.temporary().parent_path(), fs::canonical(folder_));
  }
  EXPECT_EQ(count(), 0U) << "without commit nothing is left";
  write_output(folder_ / "x", "new");
  EXPECT_EQ(read_file(folder_ / "x"), "new");
  EXPECT_EQ(count(), 1U);
}

/// As another program would write it.
void write_foreign(const fs::path& file, const std::string& text, const char* mode = "wb") {
  std::FILE* const stream = std::fopen(file.c_str(), mode);
  ASSERT_NE(stream, nullptr);
  std::fputs(text.c_str(), stream);
  std::fclose(stream);
}

TEST_F(OutputFileTest, ReplacesOnlyWhatLociWroteUnlessForced) {
  write_output(folder_ / "own", "any bytes: loci");
  write_foreign(folder_ / "foreign", "a letter");
  EXPECT_EQ(refusal(folder_ / "own", {}), "");
  EXPECT_NE(refusal(folder_ / "foreign", {}).find("loci did not write it"), std::string::npos);
  EXPECT_EQ(read_file(folder_ / "foreign"), "a letter");
  EXPECT_EQ(refusal(folder_ / "foreign", kAnything), "");
  EXPECT_EQ(read_file(folder_ / "foreign"), "new");
  EXPECT_NE(refusal(folder_ / "foreign", {.replace = Replace::nothing}).find("exists already"),
            std::string::npos);
  EXPECT_EQ(count(), 2U);
}

TEST_F(OutputFileTest, WhatWasEditedSinceIsNotOurs) {
  if (!has_extended_attributes()) GTEST_SKIP() << "the file system has no extended attributes";
  write_output(folder_ / "map", "loci");
  EXPECT_TRUE(written_by_loci(folder_ / "map"));
  fs::rename(folder_ / "map", folder_ / "moved");
  EXPECT_TRUE(written_by_loci(folder_ / "moved"));
  write_foreign(folder_ / "moved", "aliases", "ab");
  EXPECT_NE(refusal(folder_ / "moved", {}).find("or it was changed since"), std::string::npos);
  EXPECT_EQ(read_file(folder_ / "moved"), "locialiases");
  write_foreign(folder_ / "copy", "loci");
  EXPECT_FALSE(written_by_loci(folder_ / "copy"));
}

TEST_F(OutputFileTest, AMemoryIsNeverReplacedAsOurs) {
  write_output(folder_ / "memory", "SQLite format 3, loci");
  EXPECT_FALSE(written_by_loci(folder_ / "memory"));
}

TEST_F(OutputFileTest, NeverReplacesAnInputUnderAnyName) {
  const fs::path input = folder_ / "input";
  write_output(input, "loci");
  fs::create_symlink("input", folder_ / "symbolic");
  fs::create_hard_link(input, folder_ / "hard");
  fs::create_directory_symlink(".", folder_ / "here");
  for (const fs::path& output : {input, folder_ / "." / "input", folder_ / "symbolic", folder_ / "hard",
                                 folder_ / "here" / "input", folder_ / "here" / "symbolic"}) {
    EXPECT_NE(refusal(output, {.replace = Replace::anything, .inputs = {folder_ / "none", input}})
                  .find("is an input of this command"),
              std::string::npos)
        << output;
    EXPECT_EQ(read_file(input), "loci");
  }
  EXPECT_THROW(refuse_inputs(folder_, {input}), Error) << "a folder with an input in it";
  EXPECT_NO_THROW(refuse_inputs(folder_ / "new", {input}));
}

TEST_F(OutputFileTest, ReplacesTheTargetOfALinkAndKeepsTheLink) {
  write_output(folder_ / "target", "loci");
  fs::create_symlink("target", folder_ / "link");
  write_output(folder_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(read_file(folder_ / "target"), "new");
}

TEST_F(OutputFileTest, HasThePermissionsAskedForOrThoseOfTheOldFile) {
  write_output(folder_ / "private", "loci", {.mode = 0600});
  EXPECT_EQ(mode_of(folder_ / "private"), 0600U);
  write_output(folder_ / "private", "new");
  EXPECT_EQ(mode_of(folder_ / "private"), 0600U);
  OutputFile open(folder_ / "secret", {.mode = 0600});
  EXPECT_EQ(mode_of(open.temporary()), 0600U) << "from the first byte on";
}

TEST_F(OutputFileTest, DoesNotWriteThroughWhatLiesAtTheTemporaryName) {
  const fs::path name = OutputFile(folder_ / "x").temporary();
  write_output(folder_ / "precious", "loci");
  fs::create_symlink("precious", name);
  write_output(folder_ / "x", "new");
  EXPECT_EQ(read_file(folder_ / "precious"), "loci");
  EXPECT_TRUE(fs::is_symlink(name));
}

TEST_F(OutputFileTest, AFileThatAppearedMeanwhileIsNotReplaced) {
  OutputFile file(folder_ / "x", {.replace = Replace::nothing});
  file.write("new");
  write_output(folder_ / "x", "other");
  EXPECT_THROW(file.commit(), Error);
  EXPECT_EQ(read_file(folder_ / "x"), "other");
  EXPECT_EQ(count(), 1U);
}

TEST_F(OutputFileTest, WhatAKilledProgramLeftIsRemovedAndWhatOthersWriteStays) {
  const pid_t child = ::fork();
  if (child == 0) {
    const OutputFile killed(folder_ / "x");
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  const OutputFile written(folder_ / "x");
  write_foreign(folder_ / "x.tmp_notes", "of the user");
  EXPECT_EQ(count(), 3U);
  EXPECT_EQ(remove_abandoned(folder_ / "x").size(), 1U);
  EXPECT_EQ(count(), 2U);
  EXPECT_TRUE(fs::exists(written.temporary()));
}

TEST_F(OutputFileTest, OfFoldersOnlyThoseThatLociMadeAreRemoved) {
  const pid_t child = ::fork();
  if (child == 0) {
    make_partial_folder(folder_ / "x");
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  const fs::path of_user = folder_ / fmt::format("x.tmp{}_5", child);
  fs::create_directory(of_user);
  EXPECT_EQ(count(), 2U);
  const fs::path written = make_partial_folder(folder_ / "x/");
  EXPECT_EQ(count(), 2U) << "what was killed is gone";
  EXPECT_TRUE(remove_abandoned(folder_ / "x").empty()) << "this program is alive";
  commit_partial_folder(written, folder_ / "x/");
  EXPECT_TRUE(fs::is_empty(folder_ / "x"));
  EXPECT_TRUE(fs::exists(of_user));
}

TEST_F(OutputFileTest, APrivateFileStaysPrivateWhereItReplacesAnother) {
  write_output(folder_ / "x", "loci");
  fs::permissions(folder_ / "x", fs::perms(0644));
  write_output(folder_ / "x", "secret", {.replace = Replace::anything, .mode = 0600});
  EXPECT_EQ(static_cast<unsigned>(fs::status(folder_ / "x").permissions()), 0600U);
}

TEST_F(OutputFileTest, NothingIsAddedToARecording) {
  const fs::path written = folder_ / "day/frames", input = folder_ / "tum";
  make_folder(written);
  make_folder(input / "rgb");
  write_output(folder_ / "day" / kRecordingManifest, "frames.csv\n");
  for (const fs::path& output : {written, written / "map.json", input / "rgb/new/map.json", input / "x"})
    EXPECT_THROW(refuse_within(output, {input}), Error) << output;
  for (const fs::path& output : {folder_ / "day", input, folder_ / "x"})
    EXPECT_NO_THROW(refuse_within(output, {input})) << output;
}

TEST_F(OutputFileTest, RefusesWhatIsNoFile) {
  EXPECT_THROW(write_output(folder_, "bytes", kAnything), Error);
  EXPECT_THROW(write_output("/dev/null", "bytes", kAnything), Error);
  EXPECT_THROW(write_output(folder_ / "none" / "x", "bytes", kAnything), Error);
  EXPECT_THROW(write_output({}, "bytes", kAnything), Error);
}

TEST_F(OutputFileTest, KeepsTheOldFileWhenThereIsNoRoom) {
  write_output(folder_ / "x", "loci, the old one");
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  rlimit small = old;
  small.rlim_cur = 1000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write_output(folder_ / "x", std::string(1 << 20, 'n')), Error);
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_file(folder_ / "x"), "loci, the old one");
  EXPECT_EQ(count(), 1U);
}

}  // namespace
}  // namespace loci
