// Every seed and every input that once was a finding, through its target: no crash, no hang, no exception but
// loci::Error with one line of text. tests/data/fuzz/TARGET holds them; regressions are named after what they
// found.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "tests/fuzz/bad_inputs.h"
#include "tests/fuzz/targets.h"

namespace loci::fuzz {
namespace {

namespace fs = std::filesystem;

const fs::path kSeeds = fs::path(LOCI_SOURCE_DIR) / "tests/data/fuzz";
constexpr double kMaxSeconds = 20;  // far above what any takes, also with sanitizers on a busy machine

std::vector<fs::path> sorted_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

/// "read", or the line with which the input is refused. Whatever else happens fails the test.
std::string outcome_of(const Target& target, std::string_view bytes, const std::string& what) {
  const Stopwatch watch;
  std::string outcome = "read";
  try {
    target.run(bytes);
  } catch (const Error& error) {
    outcome = error.what();
    EXPECT_FALSE(outcome.empty()) << target.name << " " << what;
    EXPECT_EQ(outcome.find('\n'), std::string::npos) << target.name << " " << what << ": " << outcome;
  } catch (const std::exception& error) {
    ADD_FAILURE() << target.name << " " << what << ": not a loci::Error: " << error.what();
  }
  EXPECT_LT(watch.seconds(), kMaxSeconds) << target.name << " " << what;
  return outcome;
}

class Seeds : public testing::TestWithParam<Target> {};

TEST_P(Seeds, AreReadOrRefusedWithOneLine) {
  const std::vector<fs::path> files = sorted_files(kSeeds / GetParam().name);
  EXPECT_FALSE(files.empty()) << "a target needs seeds";
  for (const fs::path& file : files) outcome_of(GetParam(), read_file(file), file.filename().string());
}

/// The seeds are valid: a fuzzer that starts from what is refused finds the way in by luck alone.
TEST_P(Seeds, AreRead) {
  for (const fs::path& file : sorted_files(kSeeds / GetParam().name)) {
    if (!file.filename().string().starts_with("seed")) continue;
    EXPECT_EQ(outcome_of(GetParam(), read_file(file), file.filename().string()), "read") << file;
  }
}

/// A few random changes of a seed: bytes flipped, removed, doubled, or taken from another seed.
std::string mutated(std::string bytes, const std::string& other, std::mt19937& random) {
  const auto below = [&](size_t count) {
    return count == 0 ? 0 : std::uniform_int_distribution<size_t>(0, count - 1)(random);
  };
  for (size_t left = 1 + below(4); left > 0; --left) {
    const size_t at = below(bytes.size()), length = 1 + below(16);
    switch (below(5)) {
      case 0:
        if (!bytes.empty()) bytes[at] = static_cast<char>(below(256));
        break;
      case 1:
        if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ 1 << below(8));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size()), length));
        break;
      default:
        bytes.insert(at, other.substr(below(other.size()), length));
    }
  }
  return bytes;
}

/// What a fuzzer does without looking at the code: LOCI_FUZZ_ROUNDS says how often.
TEST_P(Seeds, RandomChangesAreReadOrRefusedWithOneLine) {
  const char* given = std::getenv("LOCI_FUZZ_ROUNDS");
  const int rounds = given == nullptr ? 100 : std::atoi(given);
  const std::vector<fs::path> files = sorted_files(kSeeds / GetParam().name);
  std::vector<std::string> seeds;
  for (const fs::path& file : files) seeds.push_back(read_file(file));
  std::mt19937 random(4711);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    const std::string& seed = seeds[static_cast<size_t>(round) % seeds.size()];
    const std::string bytes = mutated(seed, seeds[random() % seeds.size()], random);
    if (given != nullptr)
      std::ofstream(fs::temp_directory_path() / "loci_fuzz_last_input", std::ios::binary)
          << bytes;  // of a crash
    outcome_of(GetParam(), bytes, fmt::format("round {}", round));
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Seeds, testing::ValuesIn(targets()),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(Targets, AreNamedOnce) {
  for (const Target& target : targets()) EXPECT_EQ(find_target(target.name), &target);
  EXPECT_EQ(find_target("none"), nullptr);
}

/// All files of the folder that targets write, by content.
std::string state_of(const fs::path& folder) {
  std::string state;
  for (const fs::path& file : sorted_files(folder))
    if (fs::is_regular_file(file)) state += file.string() + "\n" + read_file(file);
  return state;
}

TEST(BadInputs, EachIsReadOrRefusedWithOneLineAndNothingChanges) {
  const std::vector<BadInput> inputs = bad_inputs(kSeeds);
  EXPECT_GE(inputs.size(), 500U);
  const std::string before = state_of(fs::path(LOCI_SOURCE_DIR) / "tests/data");
  size_t refused = 0;
  for (const BadInput& input : inputs)
    refused += outcome_of(*find_target(input.target), input.bytes, input.name) != "read" ? 1 : 0;
  EXPECT_GE(refused, inputs.size() / 3) << "most of the table is bad";
  EXPECT_EQ(state_of(fs::path(LOCI_SOURCE_DIR) / "tests/data"), before);
}

}  // namespace
}  // namespace loci::fuzz
