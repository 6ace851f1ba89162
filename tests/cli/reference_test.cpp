// Completions and manual pages, as the build generates them from the declarations of the programs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;

/// What bash offers for a command line; "" at the end is a word that begins.
std::string completed(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += " '" + word + "'";
  const std::string name = words[0], function = "_" + name;
  std::string script = "source " LOCI_SHARE_DIR "/bash-completion/completions/" + name + "; ";
  script += "COMP_WORDS=(" + list + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); f=" + function +
            "; ${f//-/_}; echo \"${COMPREPLY[*]}\"";
  const fs::path file = fs::path(fresh_folder()) / "complete.sh";
  write_file_atomically(file, script + "\n");
  return run("bash '" + file.string() + "'").out;
}

TEST(Completion, OffersCommandsOptionsAndValues) {
  EXPECT_EQ(completed({"loci-map", "fu"}), "fuse\n");
  EXPECT_EQ(completed({"loci-map", "export", "map.urdf", "--form"}), "--format\n");
  EXPECT_EQ(completed({"loci-map", "export", "map.urdf", "--format", "s"}), "sdf svg\n");
  EXPECT_EQ(completed({"loci-map", "export", "map.urdf", "--format", "=", "s"}), "sdf svg\n");
  EXPECT_EQ(completed({"loci-memory", "edit", "und"}), "undo\n");
  EXPECT_EQ(completed({"loci-map", "fuse", "tests/d"}), "\n") << "files are left to bash";
}

TEST(Completion, OfTheDispatcherIsThatOfThePrograms) {
  EXPECT_EQ(completed({"loci", "sim"}), "simulate\n");
  EXPECT_EQ(completed({"loci", "map", "fu"}), "fuse\n");
  EXPECT_EQ(completed({"loci", "map", "export", "map.urdf", "--format", "s"}), "sdf svg\n");
  EXPECT_EQ(completed({"loci", "help", "map", "fu"}), "fuse\n");
}

TEST(ManualPages, AreThereForEveryCommandAndAreWellFormed) {
  const fs::path folder = fs::path(LOCI_SHARE_DIR) / "man/man1";
  const bool groff = run("command -v groff").exit_code == 0;
  for (const char* program : {"loci-map", "loci-perceive", "loci-memory", "loci-simulate"}) {
    const Json json = parse_json(run(std::string(program) + " --describe-cli").out, program);
    for (const Json& command : json.at("commands")) {
      const fs::path page =
          folder / (std::string(program) + "-" + command.at("name").get<std::string>() + ".1");
      const std::string text = read_file(page);
      EXPECT_THAT(text, testing::StartsWith(".TH ")) << page;
      for (const char* section :
           {"\n.SH NAME\n", "\n.SH SYNOPSIS\n", "\n.SH DESCRIPTION\n", "\n.SH EXAMPLES\n"})
        EXPECT_THAT(text, testing::HasSubstr(section)) << page;
      if (!groff) continue;
      const Outcome checked = run("groff -K utf8 -man -ww -z '" + page.string() + "'");
      EXPECT_EQ(checked.exit_code, 0) << page;
      EXPECT_EQ(checked.error, "") << page;
    }
  }
}

TEST(Reference, InTheDocumentsIsWhatTheProgramsDeclare) {
  for (const char* program :
       {"loci-browse", "loci-evaluate", "loci-map", "loci-memory", "loci-perceive", "loci-simulate"}) {
    // Presets with sanitizers build no browser.
    if (program == std::string("loci-browse") && !fs::exists(fs::path(LOCI_BIN_DIR) / program)) continue;
    const std::string page = std::string(program) + ".md";
    EXPECT_EQ(read_file(fs::path(LOCI_SOURCE_DIR) / "docs/reference" / page),
              read_file(fs::path(LOCI_SHARE_DIR) / "doc/loci" / page))
        << "docs/update reference";
  }
}

}  // namespace
}  // namespace loci::apps::test
