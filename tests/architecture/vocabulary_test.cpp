// Names, messages, help texts and documents use the field's terms (docs/glossary.md): the words that were
// replaced do not come back.

#include <gtest/gtest.h>
#include <regex.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/architecture/tree.h"

namespace {

namespace fs = std::filesystem;

struct Pattern {
  const char* not_allowed;  ///< regular expression
  const char* but;
};

/// Nowhere: names in code, comments, messages, documents.
const std::vector<Pattern> kEverywhere = {
    {R"(\bk(Least|Most|Fewest|Smallest|Largest)([A-Z]|\b))", "kMin…, kMax…"},
    {R"(\b(least|fewest|most)_(m|mb|px|deg|points|objects|words|confidence|probability|share)\b)",
     "min_…, max_…"},
    {R"(--(least|fewest|most|smallest|largest)-)", "--min-…, --max-…"},
    {R"(\bloci_(room|proxies)\b)", "loci_add_module, loci_generate_types"},
    {R"(\b[Pp]ictures?\b)", "image, figure, thumbnail, crop, screenshot"},
    {R"(\b[Ww]ho is who\b)", "data association, object identity"},
    {R"(\b([Ll]ikeness|[Cc]loseness)\b)", "similarity, distance"},
    {R"(\bbags? of looks\b)", "stored views"},
    {R"(\bchosen story\b)", "maximum a posteriori (MAP) hypothesis"},
    {R"(\b(Whereabouts|Untracked|Busyness|CarriedBelief|StopPlanner|InteractionStop)\b)",
     "see docs/glossary.md"},
    {R"(\b(is_news|find_ways|pull_way_m|rival_gap|wide_net|people_time|scene_of_cas|kept_of_cas)\b)",
     "see docs/glossary.md"},
    {R"(\b[Ll]eftovers?\b)", "alternative hypothesis"},
    {R"(\b[Tt]wo clocks\b)", "bitemporal: valid time and transaction time"},
    {R"(\b(carries out|makes anew|measures what we claim)\b)", "implements, rebuilds, benchmarks"},
    {R"(\b(processor time|by the clock|on the clock)\b)", "CPU time, wall time"},
};

/// In documents and help texts, which people read.
const std::vector<Pattern> kProse = {
    {R"(\b[Tt]hings?\b)", "object, sample, item"},
    {R"(\b(is|are) told\b)", "is reported"},
    {R"(\bamong five\b)", "top-5"},
    {R"(\bwhat is nothing\b)", "plain words"},
};

/// "FILE:LINE: word (use …)" for each match. POSIX expressions: std::regex is several times slower.
std::string findings(const std::string& name, const std::string& text, const std::vector<Pattern>& patterns) {
  std::string found;
  for (const Pattern& pattern : patterns) {
    regex_t regex;
    if (regcomp(&regex, pattern.not_allowed, REG_EXTENDED | REG_NEWLINE) != 0)
      return std::string("not an expression: ") + pattern.not_allowed;
    regmatch_t match;
    for (size_t at = 0; regexec(&regex, text.c_str() + at, 1, &match, at == 0 ? 0 : REG_NOTBOL) == 0;
         at += static_cast<size_t>(match.rm_eo)) {
      const size_t begin = at + static_cast<size_t>(match.rm_so), line = text.rfind('\n', begin) + 1;
      if (text.compare(line, 2, "$ ") == 0) continue;  // What a person asks.
      found += name + ":" +
               std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<long>(begin), '\n')) +
               ": " + text.substr(begin, static_cast<size_t>(match.rm_eo - match.rm_so)) +
               " (use: " + pattern.but + ")\n";
    }
    regfree(&regex);
  }
  return found;
}

std::string read(const fs::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool is_source(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".h" || extension == ".cpp" || extension == ".sql" || extension == ".cmake" ||
         extension == ".txt" || extension == ".xml" || extension == ".py";
}

TEST(Vocabulary, OfSources) {
  for (const char* folder :
       {"apps", "cmake", "gui", "mapping", "memory", "nbv", "perception", "python", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const std::string name = fs::relative(entry.path(), kRoot).string();
      if (!is_source(entry.path()) || name == "tests/architecture/vocabulary_test.cpp" ||
          name.starts_with("tests/data"))
        continue;
      EXPECT_EQ(findings(name, read(entry.path()), kEverywhere), "");
    }
}

TEST(Vocabulary, OfDocuments) {
  std::vector<fs::path> documents = {kRoot / "README.md", kRoot / "CONTRIBUTING.md"};
  for (const auto& entry : fs::directory_iterator(kRoot / "docs"))
    if (entry.path().extension() == ".md") documents.push_back(entry.path());
  for (const fs::path& document : documents) {
    const std::string name = fs::relative(document, kRoot).string();
    EXPECT_EQ(findings(name, read(document), kEverywhere), "");
    EXPECT_EQ(findings(name, read(document), kProse), "");
  }
}

TEST(Vocabulary, OfHelpTexts) {
  for (const char* program : {"loci-map", "loci-perceive", "loci-memory", "loci-simulate", "loci-evaluate"}) {
    const std::string all = output_of(std::string(LOCI_BIN_DIR "/") + program + " --describe-cli");
    ASSERT_GT(all.size(), 1000U) << program;
    EXPECT_EQ(findings(program, all, kEverywhere), "");
    EXPECT_EQ(findings(program, all, kProse), "");
  }
}

TEST(Vocabulary, FindsWhatItShouldFind) {
  EXPECT_NE(findings("x", "constexpr double kLeastFace = 1;", kEverywhere), "");
  EXPECT_NE(findings("x", "constexpr int kMost = 4;", kEverywhere), "");
  EXPECT_NE(findings("x", "a picture of it", kEverywhere), "");
  EXPECT_NE(findings("x", "the things on the table", kProse), "");
  EXPECT_EQ(findings("x", "kMinFace, an image, something, everything", kEverywhere), "");
  EXPECT_EQ(findings("x", "something on the table", kProse), "");
}

}  // namespace
