// docs/safety-evidence.md names tests that exist.

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "mapping/base/files.h"

namespace loci {
namespace {

namespace fs = std::filesystem;

std::set<std::string> names_in(const std::string& text, const std::regex& pattern) {
  std::set<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    names.insert((*match)[1].str() + "." + (*match)[2].str());
  return names;
}

TEST(SafetyEvidence, NamesTestsThatExist) {
  std::set<std::string> known;
  const std::regex declaration(R"(\nTEST(?:_F|_P)?\((\w+),\s+(\w+)\))");
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(LOCI_SOURCE_DIR) / "tests"))
    if (entry.path().extension() == ".cpp") known.merge(names_in(read_file(entry.path()), declaration));
  const std::set<std::string> named =
      names_in(read_file(fs::path(LOCI_SOURCE_DIR) / "docs/safety-evidence.md"),
               std::regex("`([A-Z]\\w+)\\.([A-Z]\\w+)`"));
  EXPECT_GT(named.size(), 50U);
  for (const std::string& name : named) EXPECT_TRUE(known.contains(name)) << name;
}

}  // namespace
}  // namespace loci
