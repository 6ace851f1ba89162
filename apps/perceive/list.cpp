#include <fmt/format.h>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "mapping/base/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string memory;
  StatisticsTarget statistics;
  PluginOption plugins;
};

template <class Declarer>
Json entry(Declarer& declarer) {
  OptionTable table;
  declarer.declare(table);
  return perception::describe(declarer.descriptor(), table);
}

void list(const Arguments& arguments, Session& session) {
  const perception::AnnotatorRegistry registry = arguments.plugins.load().registry;
  const perception::StatisticsTable statistics = arguments.statistics.read_named(arguments.memory);
  Json json = {{"readers", Json::array()}, {"multipliers", Json::array()}, {"annotators", Json::array()}};
  std::string text;
  for (const std::string& name : registry.readers()) {
    const auto reader = registry.make_reader(name);
    json["readers"].push_back(entry(*reader));
    text += fmt::format("{:<24}{} (reader)\n", name, reader->descriptor().sentence);
  }
  for (const std::string& name : registry.multipliers()) {
    const auto multiplier = registry.make_multiplier(name);
    json["multipliers"].push_back(entry(*multiplier));
    text += fmt::format("{:<24}{} (CAS multiplier)\n", name, multiplier->descriptor().sentence);
  }
  for (const std::string& name : registry.annotators()) {
    const auto annotator = registry.make(name);
    json["annotators"].push_back(entry(*annotator));
    text += fmt::format("{:<24}{}\n", name, annotator->descriptor().sentence);
    const auto known = statistics.find(name);
    if (known == statistics.end()) continue;
    json["annotators"].back()["statistics"] = to_json(known->second);
    text += fmt::format("{:<24}  {}\n", "", statistics_text(known->second));
  }
  session.answer(text, json);
}

}  // namespace

Command list_command() {
  return {"list",
          "Lists the annotators, with what is known from their runs",
          {"loci-perceive list", "loci-perceive list -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.option("-m,--memory", &arguments->memory, "Memory beside which the statistics are");
            arguments->statistics.declare(table);
            arguments->plugins.declare(table);
            return [arguments](Session& session) { list(*arguments, session); };
          }};
}

}  // namespace loci::apps
