#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "mapping/base/json.h"
#include "memory/annotators/remembered.h"
#include "perception/pipeline/pipeline.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string memory;
  std::vector<std::string> with;
  std::string now;
  bool again = false;
  StatisticsTarget statistics;
  PluginOption plugins;
};

/// The steps that were given, as a pipeline that reads the memory.
perception::Pipeline read_pipeline(const Arguments& arguments,
                                   const perception::AnnotatorRegistry& registry) {
  YAML::Node document;
  document["reader"] = "MemoryReader";
  for (const std::string& step : arguments.with)
    document["flow"].push_back(Config::parse("step:\n- " + step, "--with").node("step")[0]);
  return perception::Pipeline::parse(Config::parse("", "--with").over(document, ""), registry);
}

void annotate(const Arguments& arguments, Session& session) {
  const Experts experts = arguments.plugins.load();
  perception::Pipeline pipeline = read_pipeline(arguments, experts.registry);
  memory::WriteOptions options;
  if (!arguments.now.empty()) options.now = parse_time(arguments.now);
  memory::Store::open_read(arguments.memory);  // What is no memory is refused, not made.
  const auto memory =
      std::make_shared<memory::RememberedMemory>(memory::Store::open_write(arguments.memory, options));
  const Json configuration = pipeline.to_json();
  if (!arguments.again) memory->answered_by = pipeline.annotating();
  perception::Resources resources;
  resources.put_for_run(memory);
  perception::Context context{resources, session.warnings(), session.flags().threads, {}};
  const memory::Id run = memory->store.begin_run("loci-perceive annotate", configuration.dump());
  size_t clusters = 0;
  size_t annotations = 0;
  const perception::PipelineResult result =
      pipeline.run(context, experts.types, session.progress(), [&](perception::cas::Cas& cas) {
        clusters += perception::types::SceneCas(cas).clusters().size();
        annotations += keep_late_annotations(*memory, cas, run);
      });
  memory->store.finish_run(run);
  for (const auto& [name, seconds] : result.seconds) session.timing(name, seconds);
  add_to_statistics(arguments.statistics.path(arguments.memory), result.statistics);
  session.answer(fmt::format("{} scenes, {} clusters asked about, {} annotations added to {}\n",
                             result.frames, clusters, annotations, arguments.memory),
                 {{"scenes", result.frames},
                  {"clusters", clusters},
                  {"annotations", annotations},
                  {"pipeline", configuration}});
}

}  // namespace

Command annotate_command() {
  return {"annotate",
          "Runs annotators over what was remembered",
          {"loci-perceive annotate -m demo-output/memory.loci --with BarcodeReader",
           "loci-perceive annotate -m demo-output/memory.loci --with \"ColorName: {min_fraction: 0.2}\" "
           "--again --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.memory(arguments->memory);
            table.option("--with", &arguments->with,
                         "Annotator, or 'Name: {option: value}'; can be given several times",
                         {.required = true});
            table.flag("--again", arguments->again,
                       "Asks again about what these annotators have described already");
            table.option("--now", &arguments->now, "When the memory learns it, ISO 8601",
                         {.default_text = "the clock"});
            arguments->statistics.declare(table);
            arguments->plugins.declare(table);
            return [arguments](Session& session) { annotate(*arguments, session); };
          }};
}

}  // namespace loci::apps
