// Annotators: annotate, describe, list.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/annotators/memory_annotators.h"
#include "memory/annotators/memory_reader.h"
#include "perception/annotators/annotators.h"
#include "perception/pipeline/pipeline.h"

namespace loci::apps {

perception::AnnotatorRegistry all_annotators() {
  perception::AnnotatorRegistry registry;
  add_annotators(registry);
  memory::add_memory_annotators(registry);
  return registry;
}

void PluginOption::declare(ArgumentTable& table) {
  table.option("--plugin FILE", &files, "Shared library with further annotators; may be repeated");
}

Experts PluginOption::load() const {
  Experts experts{all_annotators(), nullptr};
  std::vector<perception::LoadedPlugin> plugins;
  for (const std::string& file : files) plugins.push_back(load_plugin(file, experts.registry));
  experts.types = type_system_with_plugins(plugins);
  return experts;
}

void StatisticsTarget::declare(ArgumentTable& table) {
  table.option("--statistics FILE", &file, "JSON file with the statistics of annotators",
               {.default_text = "the file beside the memory"});
}

std::filesystem::path StatisticsTarget::path(const std::string& memory) const {
  if (!file.empty()) return file;
  return memory.empty() ? std::filesystem::path() : perception::statistics_path(memory);
}

perception::StatisticsTable StatisticsTarget::read(const std::string& memory) const {
  const std::filesystem::path from = path(memory);
  return from.empty() ? perception::StatisticsTable() : perception::read_statistics(from);
}

perception::StatisticsTable StatisticsTarget::read_named(const std::string& memory) const {
  for (const std::string& named : {memory, file})
    if (!named.empty() && !std::filesystem::exists(named)) throw Error("no such file", {named, 0, {}});
  return read(memory);
}

namespace {

struct AnnotateArguments {
  std::string memory;
  std::vector<std::string> annotators;
  std::string now;
  bool again = false;
  StatisticsTarget statistics;
  PluginOption plugins;
};

/// The steps that were given, as a pipeline that reads the memory.
perception::Pipeline read_pipeline(const AnnotateArguments& arguments,
                                   const perception::AnnotatorRegistry& registry) {
  YAML::Node document;
  document["reader"] = "MemoryReader";
  for (const std::string& step : arguments.annotators)
    document["flow"].push_back(Config::parse("step:\n- " + step, "--annotator").node("step")[0]);
  return perception::Pipeline::parse(Config::parse("", "--annotator").over(document, ""), registry);
}

void annotate(const AnnotateArguments& arguments, Session& session) {
  const Experts experts = arguments.plugins.load();
  perception::Pipeline pipeline = read_pipeline(arguments, experts.registry);
  memory::WriteOptions options;
  if (!arguments.now.empty()) options.now = parse_time(arguments.now);
  memory::Store::open_read(arguments.memory);  // What is no memory is refused, not made.
  const auto memory =
      std::make_shared<memory::MemorySource>(memory::Store::open_write(arguments.memory, options));
  const Json configuration = pipeline.to_json();
  if (!arguments.again) memory->annotated_by = pipeline.annotating();
  perception::Resources resources;
  resources.put_for_run(memory);
  perception::Context context{resources, session.warnings(), session.flags().threads, {}};
  const memory::Id run = memory->store.begin_run("loci-perceive annotate", configuration.dump());
  size_t clusters = 0;
  size_t annotations = 0;
  const perception::PipelineResult result =
      pipeline.run(context, experts.types, session.progress(), [&](perception::cas::Cas& cas) {
        clusters += perception::types::SceneCas(cas).clusters().size();
        annotations += store_new_annotations(*memory, cas, run);
      });
  memory->store.finish_run(run);
  for (const auto& [name, seconds] : result.seconds) session.timing(name, seconds);
  add_to_statistics(arguments.statistics.path(arguments.memory), result.statistics);
  session.answer(
      fmt::format("{}, {} asked about, {} added to {}\n", counted(result.frames, "scene"),
                  counted(clusters, "cluster"), counted(annotations, "annotation"), arguments.memory),
      {{"scenes", result.frames},
       {"clusters", clusters},
       {"annotations", annotations},
       {"pipeline", configuration}});
}

}  // namespace

Command annotate_command() {
  return {"annotate",
          "Run annotators over the scenes of a memory",
          {"loci-perceive annotate -m demo-output/memory.loci --annotator BarcodeReader",
           "loci-perceive annotate -m demo-output/memory.loci --annotator \"ColorName: {min_fraction: 0.2}\" "
           "--again --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<AnnotateArguments>();
            table.memory(arguments->memory);
            table.option("--annotator SPEC", &arguments->annotators,
                         "Annotator, or 'Name: {option: value}'; may be repeated", {.required = true});
            table.flag("--again", arguments->again, "Repeat what these annotators have described already");
            table.now(arguments->now);
            arguments->statistics.declare(table);
            arguments->plugins.declare(table);
            return [arguments](Session& session) { annotate(*arguments, session); };
          }};
}

namespace {

struct DescribeArguments {
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

void describe_named(const DescribeArguments& arguments, Session& session) {
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
          "Describe an annotator with statistics of its runs, or print the default pipeline",
          {"loci-perceive describe PlaneClusterExtractor -m demo-output/memory.loci",
           "loci-perceive describe pipeline"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<DescribeArguments>();
            table.positional("NAME", &arguments->name, "Annotator, reader, or 'pipeline'");
            table.option("-m,--memory MEMORY", &arguments->memory, "Memory with statistics beside it");
            arguments->statistics.declare(table);
            arguments->plugins.declare(table);
            return [arguments](Session& session) { describe_named(*arguments, session); };
          }};
}

namespace {

struct ListArguments {
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

void list(const ListArguments& arguments, Session& session) {
  const perception::AnnotatorRegistry registry = arguments.plugins.load().registry;
  const perception::StatisticsTable statistics = arguments.statistics.read_named(arguments.memory);
  Json json = {{"readers", Json::array()}, {"multipliers", Json::array()}, {"annotators", Json::array()}};
  std::string text;
  for (const std::string& name : registry.readers()) {
    const auto reader = registry.make_reader(name);
    json["readers"].push_back(entry(*reader));
    text += fmt::format("{:<24}{} (reader)\n", name, reader->descriptor().description);
  }
  for (const std::string& name : registry.multipliers()) {
    const auto multiplier = registry.make_multiplier(name);
    json["multipliers"].push_back(entry(*multiplier));
    text += fmt::format("{:<24}{} (CAS multiplier)\n", name, multiplier->descriptor().description);
  }
  for (const std::string& name : registry.annotators()) {
    const auto annotator = registry.make(name);
    json["annotators"].push_back(entry(*annotator));
    text += fmt::format("{:<24}{}\n", name, annotator->descriptor().description);
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
          "List the annotators with statistics of their runs",
          {"loci-perceive list", "loci-perceive list -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<ListArguments>();
            table.option("-m,--memory MEMORY", &arguments->memory, "Memory with statistics beside it");
            arguments->statistics.declare(table);
            arguments->plugins.declare(table);
            return [arguments](Session& session) { list(*arguments, session); };
          }};
}

}  // namespace loci::apps
