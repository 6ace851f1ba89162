// loci: one name for all programs. `loci map explore …` runs `loci-map explore …` from the folder of this
// program.

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

constexpr const char* kDescription = "Semantic maps, object perception and object memory for service robots";

struct Sibling {
  const char* name;
  const char* description;
};

constexpr Sibling kPrograms[] = {
    {"map", "Build and check semantic URDF maps"},
    {"perceive", "Run perception pipelines over recordings"},
    {"memory", "Query and maintain a spatio-temporal object memory"},
    {"browse", "Show an object memory in a window"},
    {"simulate", "Render recordings and laser scans of simulated kitchens"},
    {"evaluate", "Measure loci against ground truth and other methods"},
};

int print_help() {
  fmt::print("{}\n\nUsage: loci PROGRAM [COMMAND] [ARGUMENTS] [OPTIONS]\n\nPrograms:\n", kDescription);
  for (const Sibling& program : kPrograms) fmt::print("  {:<10}{}\n", program.name, program.description);
  fmt::print(
      "\nOptions:\n"
      "  help [PROGRAM [COMMAND]]  Print this help, or that of a program or command\n"
      "  version                   Print the version\n"
      "\nExamples:\n"
      "  loci memory where red -m demo-output/memory.loci\n"
      "  loci help map explore\n");
  return 0;
}

int describe() {
  Json json = {{"program", "loci"},
               {"description", kDescription},
               {"version", kVersion},
               {"dispatcher", true},
               {"commands", Json::array()}};
  for (const Sibling& program : kPrograms)
    json["commands"].push_back({{"name", program.name},
                                {"description", program.description},
                                {"arguments", Json::array()},
                                {"examples", Json::array()}});
  fmt::print("{}\n", json.dump(1));
  return 0;
}

/// Replaces this process by the program beside it.
int run_sibling(const std::string& name, const std::vector<std::string>& words) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / ("loci-" + name);
  std::vector<std::string> all = {"loci-" + name};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  throw Error(fmt::format("cannot be run: {}", std::strerror(errno)), {program.string(), 0, {}});
}

int run(std::vector<std::string> words) {
  const std::string first = words.empty() ? "" : words[0];
  if (first.empty()) throw UsageError("no program is given");
  if (first == "version" || first == "--version") return print_version();
  if (first == "--describe-cli") return describe();
  if (first == "help" || first == "--help" || first == "-h") {
    if (words.size() == 1) return print_help();
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  std::vector<std::string> names = {"help", "version"};
  for (const Sibling& program : kPrograms) {
    if (words[0] == program.name) return run_sibling(words[0], {words.begin() + 1, words.end()});
    names.emplace_back(program.name);
  }
  throw unknown("program", words[0], names);
}

}  // namespace
}  // namespace loci::apps

int main(int argc, char** argv) {
  return loci::apps::run_guarded("loci", [&] { return loci::apps::run({argv + 1, argv + argc}); });
}
