#include <gmock/gmock.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// The commands of a guide: its ```sh block.
std::string guide(const std::string& document) {
  const std::string text = read_file(std::string(LOCI_SOURCE_DIR "/docs/") + document);
  const std::string open = "```sh\n";
  const size_t begin = text.find(open) + open.size();
  return text.substr(begin, text.find("```", begin) - begin);
}

/// A folder that looks like that of the project to who follows the guide.
class Plugin : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder();
    for (const char* part : {"apps", "docs"})
      fs::create_directory_symlink(fs::path(LOCI_SOURCE_DIR) / part, folder_ / part);
    fs::create_directories(folder_ / "build");
    fs::create_directory_symlink(fs::path(LOCI_BIN_DIR).parent_path(), folder_ / "build/release");
  }
  Outcome here(const std::string& command) const {
    return run("cd '" + folder_.string() + "' && " + command);
  }
  /// A library that says `loci_plugin()` in another way.
  std::string library(const std::string& source) const {
    write_file_atomically(folder_ / "plugin.cpp", source);
    const Outcome built = here("c++ -shared -fPIC plugin.cpp -o plugin.so");
    EXPECT_EQ(built.exit_code, 0) << built.error;
    return (folder_ / "plugin.so").string();
  }
  fs::path folder_;
};

TEST_F(Plugin, AProgramOutsideUsesTheInstalledLibraries) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a program outside is built without sanitizers";
#endif
  const Outcome outcome = here("set -e\n" + guide("cpp.md"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("counter_1"));
  EXPECT_THAT(outcome.out, HasSubstr("2026-05-01T07:10:00Z  scene 1"));
  const Outcome unknown = here("application/where application/memory.loci zebra");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.error, HasSubstr("nothing is known as 'zebra'"));
  // Internals stay here, and nothing points into the folder in which it was built.
  EXPECT_TRUE(fs::exists(folder_ / "installed/include/loci/memory/store/store.h"));
  EXPECT_FALSE(fs::exists(folder_ / "installed/include/loci/memory/store/database.h"));
  const Outcome search =
      here("grep -rlF '" + std::string(LOCI_SOURCE_DIR) + "' installed/lib/cmake installed/include");
  EXPECT_EQ(search.out, "");
}

TEST_F(Plugin, TheGuideWorksAsPrinted) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a plugin outside is built without sanitizers";
#endif
  ASSERT_EQ(here("loci-simulate record apps/samples/day.yaml --quiet -o demo-output/day").exit_code, 0);
  const Outcome outcome = here("set -e\n" + guide("annotators.md"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("Says how bright each object looks."));
  EXPECT_THAT(outcome.out, HasSubstr("24 frames"));
  EXPECT_THAT(outcome.out, HasSubstr("object_"));  // found by a word of the plugin's own type
  // Nothing of what was installed points into the folder in which it was built.
  const Outcome search =
      here("grep -rlF '" + std::string(LOCI_SOURCE_DIR) + "' installed/lib/cmake installed/include");
  EXPECT_EQ(search.out, "");
  const Outcome json = here(
      "installed/bin/loci-perceive list --json --plugin brightness/brightness.so -m brightness/memory.loci");
  ASSERT_EQ(json.exit_code, 0) << json.error;
  const Json list = parse_json(json.out, "list");
  const auto brightness = std::find_if(list["annotators"].begin(), list["annotators"].end(),
                                       [](const Json& each) { return each["name"] == "Brightness"; });
  ASSERT_NE(brightness, list["annotators"].end());
  EXPECT_EQ((*brightness)["statistics"]["scenes"], 24);
}

TEST_F(Plugin, OfAnotherVersionIsRefusedWithBothVersions) {
  const std::string plugin = library(R"(
    struct Info { int format; const char* version; const char* compiler; } info = {1, "0.0.7", "9.9.9"};
    extern "C" const Info* loci_plugin() { return &info; })");
  const Outcome outcome = run("loci-perceive list --plugin " + plugin);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("built against loci 0.0.7 (compiler 9.9.9), and this is loci 0.1.0"));
  EXPECT_EQ(lines_of(outcome.error), 1);
}

TEST_F(Plugin, WhatIsNoneIsRefused) {
  const std::string plugin = library("int nothing() { return 0; }");
  for (const auto& [file, message] : {std::pair<std::string, std::string>{plugin, "no plugin of loci"},
                                      {"absent.so", "no such plugin"},
                                      {LOCI_SOURCE_DIR "/README.md", "cannot be loaded"}}) {
    const Outcome outcome = run("loci-perceive describe ColorName --plugin " + file);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.error, HasSubstr(message));
    EXPECT_EQ(lines_of(outcome.error), 1);
  }
}

}  // namespace
}  // namespace loci::apps::test
