#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "mapping/base/files.h"

namespace loci::memory::testing_support {

/// A fresh folder per test, removed afterwards.
class TemporaryFolder : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / ("loci_" + std::string(info->test_suite_name()) + "_" +
                                                        info->name() + "_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    make_folder(folder_);
    file_ = folder_ / "memory.loci";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  std::filesystem::path file_;
};

}  // namespace loci::memory::testing_support
