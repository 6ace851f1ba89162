#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace loci::apps::questions {

/// A question of a table with the answer that the simulator's truth has. Of the lists any entry is right, but
/// `objects` and `places` must all be named.
struct AskedQuestion {
  std::string memory = {};  ///< day, plain, kitchen, corner, or a drawn kitchen
  std::string sentence = {};
  std::vector<std::string> after = {};    ///< sentences asked before
  int line = 0;                           ///< in the table
  std::vector<std::string> verdict = {};  ///< yes, no, not observed
  std::optional<size_t> number = {};
  std::vector<std::string> place = {};
  std::optional<std::vector<std::string>> objects = {}, places = {};
  std::optional<std::pair<std::string, std::string>> time = {},
                                                     duration = {};  ///< first and last that are right
  std::optional<std::pair<double, double>> probability = {};
  std::vector<std::string> text = {};    ///< one of them is in the answer
  std::string reason = {};               ///< is in the answer or its evidence
  std::vector<std::string> answer = {};  ///< unknown, gone, not known, not understood, or a verdict
};

/// Reads a table (tests/data/questions). Error with file and line for what it does not know.
std::vector<AskedQuestion> read_table(const std::filesystem::path& file);

}  // namespace loci::apps::questions
