#pragma once

#include <string>

namespace loci::apps::test {

/// What a program did.
struct Outcome {
  int exit_code = -1;
  std::string out;    ///< stdout
  std::string error;  ///< stderr
};

/// Runs a shell command with the built programs first on the PATH, from the repository root.
Outcome run(const std::string& command);

/// A fresh empty folder for the running test, below the system's temporary folder.
std::string fresh_folder();

/// Path of something in the shared data, or "" when the data is not here (then the test skips).
std::string shared(const std::string& relative);

/// Number of lines of a text that are not empty.
int lines_of(const std::string& text);

}  // namespace loci::apps::test

/// Skips the test with a line when shared data is not there.
#define LOCI_NEEDS_SHARED(relative)               \
  if (loci::apps::test::shared(relative).empty()) \
  GTEST_SKIP() << "needs " << (relative) << " of the shared data folder"
