// Every example that --help prints and every console block of README and docs works as printed, from a folder
// that looks like the repository after ./demo.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/support/postgres_server.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kPrograms = {"loci-map", "loci-perceive", "loci-memory", "loci-simulate",
                                            "loci-evaluate"};

/// Examples that take longer are named in the test's output.
constexpr double kSlow_s = 3;

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

/// The examples of a program's commands, in the order of its help: later ones use what earlier ones make.
std::vector<std::pair<std::string, std::vector<std::string>>> help_examples(const std::string& program) {
  std::vector<std::pair<std::string, std::vector<std::string>>> examples;
  const Json json = parse_json(run(program + " --describe-cli").out, program);
  for (const Json& command : json.at("commands"))
    examples.emplace_back(command.at("name"), command.at("examples").get<std::vector<std::string>>());
  return examples;
}

/// The `$ ` lines of the console blocks of a document.
std::vector<std::string> console_commands(const fs::path& document) {
  std::vector<std::string> commands;
  bool inside = false;
  for (const std::string& line : lines(read_file(document))) {
    if (line.starts_with("```"))
      inside = line == "```console";
    else if (inside && line.starts_with("$ "))
      commands.push_back(line.substr(2));
  }
  return commands;
}

class Examples : public testing::Test {
 protected:
  void SetUp() override {
    // Tests run as processes side by side: each has a folder of its own.
    root_ = fs::temp_directory_path() / ("loci_examples_" + std::to_string(::getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_ / "demo-output");
    for (const char* folder : {"apps", "docs", "mapping", "perception", "memory", "tests"})
      fs::create_directory_symlink(fs::path(LOCI_SOURCE_DIR) / folder, root_ / folder);
    fs::create_directories(root_ / "build/release");
    fs::create_directory_symlink(LOCI_BIN_DIR, root_ / "build/release/bin");
    std::string why_not;
    server_ = loci::testing_support::PostgresServer::start(why_not);
    if (server_)
      server_->create_database("loci");
    else
      std::cout << "examples with PostgreSQL are left out: " << why_not << "\n";
    for (const char* command :
         {"loci-map explore apps/samples/kitchen.urdf --interact -o demo-output/explored",
          "loci-simulate record apps/samples/tour.yaml -o demo-output/tour",
          "loci-map fuse demo-output/tour -o demo-output/scans",
          "loci-map interpret demo-output/scans --recording demo-output/tour -o demo-output",
          "loci-simulate record apps/samples/day.yaml -o demo-output/day",
          "loci-perceive run demo-output/day --map demo-output/explored/map.urdf -m demo-output/memory.loci"})
      expect_works(command);
  }

  void TearDown() override { fs::remove_all(root_); }

  /// Runs a command, unless it has been run already.
  void expect_works(std::string command) {
    if (!done_.insert(command).second) return;
    const Stopwatch watch;
    if (command.find("postgresql://") != std::string::npos) {
      if (!server_) return;
      command = "PGHOST=" + server_->folder() + " PGUSER=postgres XDG_CACHE_HOME=" + root_.string() +
                "/cache " + command;
    }
    const Outcome outcome = run("cd '" + root_.string() + "' && " + command);
    EXPECT_EQ(outcome.exit_code, 0) << command << "\n" << outcome.error;
    if (watch.seconds() > kSlow_s) std::cout << watch.seconds() << " s: " << command << "\n";
  }

  fs::path root_;
  std::set<std::string> done_;
  std::unique_ptr<loci::testing_support::PostgresServer> server_;
};

// One test, as making the folder costs more than the examples.
TEST_F(Examples, OfHelpAndDocumentsWorkAsPrinted) {
  for (const std::string& program : kPrograms) {
    for (const auto& [command, examples] : help_examples(program)) {
      EXPECT_GE(examples.size(), 2U) << program << " " << command << " has too few examples";
      for (const std::string& example : examples) expect_works(example);
    }
  }
  std::vector<fs::path> documents = {fs::path(LOCI_SOURCE_DIR) / "README.md"};
  for (const auto& entry : fs::directory_iterator(fs::path(LOCI_SOURCE_DIR) / "docs"))
    if (entry.path().extension() == ".md") documents.push_back(entry.path());
  for (const fs::path& document : documents)
    for (const std::string& command : console_commands(document))
      // What needs data that does not come with the project says so by its path.
      if (command.find("YOUR_") == std::string::npos && command.find("./") != 0) expect_works(command);
}

}  // namespace
}  // namespace loci::apps::test
