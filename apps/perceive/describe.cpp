#include <algorithm>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "mapping/base/json.h"
#include "perception/annotators/annotators.h"
#include "perception/pipeline/pipeline.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string name;
  std::string memory;
  StatisticsTarget statistics;
  PluginOption plugins;
};

template <class Declarer>
void answer(Declarer& declarer, const perception::StatisticsTable& statistics, Session& session) {
  OptionTable table;
  declarer.declare(table);
  const perception::AnnotatorDescriptor descriptor = declarer.descriptor();
  std::string text = description_text(descriptor, table);
  Json json = describe(descriptor, table);
  if (const auto known = statistics.find(descriptor.name); known != statistics.end()) {
    text += "  so far: " + statistics_text(known->second) + "\n";
    json["statistics"] = to_json(known->second);
  }
  session.answer(text, json);
}

void describe_named(const Arguments& arguments, Session& session) {
  const perception::AnnotatorRegistry registry = arguments.plugins.load().registry;
  const perception::StatisticsTable statistics = arguments.statistics.read_named(arguments.memory);
  const std::string& name = arguments.name;
  if (name == "pipeline") {
    session.answer(
        perception::default_pipeline(),
        perception::Pipeline::parse(perception::default_pipeline(), "the default pipeline", registry)
            .to_json());
    return;
  }
  const auto is_one_of = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is_one_of(registry.readers()))
    answer(*registry.make_reader(name), statistics, session);
  else if (is_one_of(registry.multipliers()))
    answer(*registry.make_multiplier(name), statistics, session);
  else
    answer(*registry.make(name), statistics, session);
}

}  // namespace

Command describe_command() {
  return {"describe",
          "Describes one annotator, with what is known from its runs, or the default pipeline",
          {"loci-perceive describe PlaneClusterExtractor -m demo-output/memory.loci",
           "loci-perceive describe pipeline"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("NAME", &arguments->name, "Annotator, reader, or 'pipeline'");
            table.option("-m,--memory", &arguments->memory, "Memory beside which the statistics are");
            arguments->statistics.declare(table);
            arguments->plugins.declare(table);
            return [arguments](Session& session) { describe_named(*arguments, session); };
          }};
}

}  // namespace loci::apps
