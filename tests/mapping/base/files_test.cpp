#include "mapping/base/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "mapping/base/error.h"

namespace loci {
namespace {

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("loci_files_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    make_folder(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  size_t count() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }
  std::filesystem::path folder_;
};

TEST_F(Files, WritesAndReadsBack) {
  const std::string bytes("a\0b\n", 4);
  write_file_atomically(folder_ / "x", bytes);
  EXPECT_EQ(read_file(folder_ / "x"), bytes);
  EXPECT_EQ(count(), 1U);
}

TEST_F(Files, SaysWhatIsMissing) {
  EXPECT_THROW(read_file(folder_ / "none"), Error);
  EXPECT_THROW(read_file(folder_), Error);
  EXPECT_THROW(write_file_atomically(folder_ / "none" / "x", "bytes"), Error);
}

TEST_F(Files, ReadsWhatEndsAlone) {
  const auto pipe = folder_ / "pipe", link = folder_ / "link";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", link);
  for (const std::filesystem::path& endless : {pipe, link, std::filesystem::path("/dev/zero")})
    EXPECT_THROW(read_file(endless), Error) << endless;
  write_file_atomically(folder_ / "sparse", "x");
  std::filesystem::resize_file(folder_ / "sparse", uint64_t{1} << 40);
  EXPECT_THROW(read_file(folder_ / "sparse"), Error);
}

}  // namespace
}  // namespace loci
