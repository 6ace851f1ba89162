#include <fmt/format.h>

#include <algorithm>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "apps/perceive/memory_target.h"
#include "apps/perceive/scene_report.h"
#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/hypotheses/known_map.h"
#include "perception/annotators/io/images.h"
#include "perception/pipeline/goal.h"
#include "perception/pipeline/pipeline.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string recording;
  std::string map;
  std::vector<std::string> package_paths;
  std::vector<std::string> robots;
  std::string pipeline;
  std::string labels;
  std::string images;
  int every = 0;
  MemoryTarget memory;
  StatisticsTarget statistics;
  PluginOption plugins;
  std::string goal;
  double budget_ms = 0;
  std::vector<std::string> with;
};

void declare(ArgumentTable& table, Arguments& arguments) {
  table.positional("RECORDING", &arguments.recording, "Folder of the recording");
  table.option("--map", &arguments.map, "URDF of the kitchen (its sidecar is found beside it)");
  table.option("--package-path", &arguments.package_paths,
               "Folder that holds packages (package://NAME/…); can be given several times");
  table.option("--robot", &arguments.robots,
               "URDF[,JOINTS.csv] of a robot that may be in view; can be given several times");
  table.option("--pipeline", &arguments.pipeline,
               "Pipeline as YAML; the default one is shown by `describe pipeline`");
  table.option("--every", &arguments.every, "Take every n-th frame",
               {.default_text = "as in the pipeline", .min = 1});
  arguments.memory.declare(table);
  arguments.statistics.declare(table);
  arguments.plugins.declare(table);
  table.option("--for", &arguments.goal,
               "What is looked for, \"class=mug color=red on=table_1\": annotators are chosen for it",
               {.excludes = {"--pipeline"}});
  table.option("--budget-ms", &arguments.budget_ms, "Expected time per scene that --for may use",
               {.default_text = "no limit", .min = 1, .needs = {"--for"}});
  table.option("--with", &arguments.with,
               "Options of an annotator that --for may choose: 'Name: {option: value}'",
               {.needs = {"--for"}});
  table.option("--labels", &arguments.labels,
               "Folder for label images FRAME_label.png (0 = none, n = object)");
  table.option("--images", &arguments.images, "Folder for colour images with what was found drawn in");
}

/// The steps of the default pipeline that find the objects: those before the first that needs them.
Json steps_that_find(const perception::AnnotatorRegistry& registry) {
  Json steps = Json::array();
  const Json all =
      perception::Pipeline::parse(perception::default_pipeline(), "the default pipeline", registry).to_json();
  for (const Json& step : all["flow"]) {
    const std::vector<std::string> needs = registry.make(step.begin().key())->descriptor().needs;
    if (std::find(needs.begin(), needs.end(), "Cluster") != needs.end()) break;
    steps.push_back(step);
  }
  return steps;
}

std::optional<perception::GoalPlan> plan_for(const Arguments& arguments,
                                             const perception::AnnotatorRegistry& registry) {
  if (arguments.goal.empty()) return std::nullopt;
  Json configured = Json::object();
  for (const std::string& text : arguments.with) {
    const Config list = Config::parse("flow: [{" + text + "}]", "--with");
    configured.update(to_json(read_flow(list, "flow", registry))[0]);
  }
  const std::optional<double> budget =
      arguments.budget_ms > 0 ? std::optional<double>(arguments.budget_ms / 1e3) : std::nullopt;
  return plan_goal(perception::parse_goal(arguments.goal), steps_that_find(registry), configured, registry,
                   arguments.statistics.read(arguments.memory.memory), budget);
}

perception::Pipeline read_pipeline(const Arguments& arguments, const perception::AnnotatorRegistry& registry,
                                   const std::optional<perception::GoalPlan>& plan) {
  Config config = plan ? Config::parse(plan->pipeline.dump(), "the pipeline made by --for")
                  : arguments.pipeline.empty()
                      ? Config::parse(perception::default_pipeline(), "the default pipeline")
                      : Config::read(arguments.pipeline);
  if (arguments.every > 0) {
    // The command line overrides the file.
    YAML::Node options;
    options["RecordingReader"]["every"] = arguments.every;
    YAML::Node changed = YAML::Clone(config.node());
    changed["reader"] = options;
    config = config.over(changed, "");
  }
  return perception::Pipeline::parse(config, registry);
}

/// What annotators share. Rooms that bring annotators with resources of their own put them here.
perception::Resources make_resources(const Arguments& arguments, Session& session) {
  perception::Resources resources;
  resources.put(std::shared_ptr<mapping::Recording>(mapping::open_recording(arguments.recording)));
  if (!arguments.map.empty() || !arguments.robots.empty()) {
    const std::vector<std::filesystem::path> packages(arguments.package_paths.begin(),
                                                      arguments.package_paths.end());
    const std::shared_ptr<perception::KnownMap> map =
        arguments.map.empty() ? perception::KnownMap::without_room(session.warnings())
                              : perception::KnownMap::load(arguments.map, packages, session.warnings());
    for (const std::string& robot : arguments.robots) {
      const size_t comma = robot.find(',');
      const std::string joints = comma == std::string::npos ? "" : robot.substr(comma + 1);
      map->add_robot(robot.substr(0, comma), joints, packages, session.warnings());
    }
    resources.put(map);
  }
  return resources;
}

void write_images(const Arguments& arguments, const perception::types::SceneCas& scene, bool with_memory) {
  // With a memory the numbers are its objects', otherwise those of the scene's clusters.
  if (!arguments.labels.empty())
    perception::write_label_image(scene, arguments.labels,
                                  with_memory ? perception::tracked_numbers(scene) : std::vector<int>());
  if (!arguments.images.empty()) perception::write_overlay(scene, arguments.images);
}

void run(const Arguments& arguments, Session& session) {
  const Experts experts = arguments.plugins.load();
  const perception::AnnotatorRegistry& registry = experts.registry;
  const std::optional<perception::GoalPlan> plan = plan_for(arguments, registry);
  perception::Pipeline pipeline = read_pipeline(arguments, registry, plan);
  perception::Resources resources = make_resources(arguments, session);
  if (!arguments.labels.empty()) make_folder(arguments.labels);
  if (!arguments.images.empty()) make_folder(arguments.images);
  arguments.memory.prepare(arguments.map, pipeline, registry, resources);
  perception::Context context{resources, session.warnings(), session.flags().threads, {}};
  const bool remembers = resources.find<memory::MemorySession>() != nullptr;
  std::string text = plan ? plan_text(*plan) : std::string();
  const std::optional<perception::Condition> wanted =
      plan && !plan->condition.empty() ? std::optional(perception::Condition::parse(plan->condition, {}))
                                       : std::nullopt;
  Json found = Json::array();
  size_t things = 0;
  Json scenes = Json::array();
  const auto done = [&](perception::cas::Cas& cas) {
    const perception::types::SceneCas scene(cas);
    things += scene.scene().clusters.size();
    if (wanted) {
      int number = 0;
      for (const perception::types::Cluster& cluster : scene.clusters()) {
        ++number;
        if (!wanted->holds(scene, cluster)) continue;
        found.push_back({{"frame", scene.scene().frame_index.get()}, {"cluster", number}});
        text += fmt::format("frame {}: cluster {} fits\n", scene.scene().frame_index.get(), number);
      }
      return write_images(arguments, scene, remembers);
    }
    // With a memory the questions are the way to look; without one this is the answer.
    if (!remembers || session.flags().verbose) text += scene_text(scene);
    if (session.flags().json) scenes.push_back(scene_json(scene));
    write_images(arguments, scene, resources.find<memory::MemorySession>() != nullptr);
  };
  memory::MemoryRunResult result;
  if (remembers)
    result = memory::run_with_memory(pipeline, context, experts.types, session.progress(), done);
  else
    result.pipeline = pipeline.run(context, experts.types, session.progress(), done);
  for (const auto& [name, seconds] : result.pipeline.seconds) session.timing(name, seconds);
  if (const auto path = arguments.statistics.path(arguments.memory.memory); !path.empty())
    add_to_statistics(path, result.pipeline.statistics);
  text += fmt::format("{} frames, {} things seen", result.pipeline.frames, things);
  if (result.pipeline.left_out > 0)
    text += fmt::format("; {} frames were left out because an annotator failed", result.pipeline.left_out);
  if (result.skipped > 0) text += fmt::format("; {} frames were in the memory already", result.skipped);
  text += remembers ? fmt::format("; remembered in {}\n", arguments.memory.memory) : "\n";
  Json json = {{"frames", result.pipeline.frames},
               {"skipped", result.skipped},
               {"left_out", result.pipeline.left_out},
               {"scenes", scenes},
               {"pipeline", context.configuration}};
  if (plan) json.update({{"found", found}, {"plan", to_json(*plan)}});
  session.answer(text, json);
}

}  // namespace

Command run_command() {
  return {"run",
          "What stands where, frame by frame, through a pipeline of annotators",
          {"loci-perceive run demo-output/day --map demo-output/explored/map.urdf -m demo-output/memory.loci "
           "--resume",
           "loci-perceive run demo-output/day --every 6 --json",
           "loci-perceive run demo-output/day --every 6 --for \"color=red\" --budget-ms 2000"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            declare(table, *arguments);
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
