#include "apps/evaluate/changes/comparison.h"
#include "apps/evaluate/commands.h"
#include "apps/evaluate/temporary_folder.h"
#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "memory/annotators/memory_annotators.h"
#include "memory/annotators/memory_session.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/hypotheses/known_map.h"
#include "perception/types/types.h"

namespace loci {
namespace {

struct Arguments {
  std::string folder;
  std::string memory;
  std::string map;
  std::string pipeline;
};

void perceive(const Arguments& arguments, const std::shared_ptr<Recording>& recording,
              const std::filesystem::path& memory, Session& session) {
  AnnotatorRegistry registry;
  add_annotators(registry);
  add_memory_annotators(registry);
  Pipeline pipeline = arguments.pipeline.empty()
                          ? Pipeline::parse(default_pipeline(), "the default pipeline", registry)
                          : Pipeline::parse(Config::read(arguments.pipeline), registry);
  pipeline.add("IdentityResolution", registry);
  pipeline.add_writer("MemoryWriter", registry);
  Resources resources;
  resources.put(recording);
  if (!arguments.map.empty()) {
    const auto map = KnownMap::load(arguments.map, {}, session.warnings());
    resources.put(map);
    resources.put(std::make_shared<World>(map->world));
  }
  MemorySessionOptions options;
  options.memory = memory;
  options.program = "loci-evaluate changes";
  options.configuration = pipeline.to_json();
  options.map = arguments.map;
  resources.put(std::make_shared<MemorySession>(options, *recording));
  Context context{resources, session.warnings(), session.flags().threads, {}};
  run_with_memory(pipeline, context, types::type_system(), session.progress());
}

void run(const Arguments& arguments, Session& session) {
  const std::shared_ptr<Recording> recording = open_recording(arguments.folder);
  std::vector<int64_t> frames;
  for (size_t i = 0; i < recording->size(); ++i) frames.push_back(recording->index_of(i));
  const changes::Truth truth = changes::read_truth(arguments.folder, frames);
  const TemporaryFolder folder("changes");
  const std::filesystem::path memory =
      arguments.memory.empty() ? folder.path() / "memory.loci" : std::filesystem::path(arguments.memory);
  perceive(arguments, recording, memory, session);
  const Store store = Store::open_read(memory);
  const changes::Moments moments = changes::read_moments(store);
  const std::vector<changes::Comparison> methods = {
      changes::compare("loci", truth, moments, changes::memory_story(store, moments)),
      changes::compare("greedy", truth, moments, changes::greedy_story(moments)),
      changes::compare("nearest", truth, moments, changes::nearest_story(moments))};
  session.answer(changes::text(methods, session.flags().verbose), changes::to_json(methods));
}

}  // namespace

Command changes_command() {
  return {"changes",
          "What the memory says happened, beside the truth and simpler ways of telling",
          {"loci-evaluate changes demo-output/day --map apps/samples/kitchen.urdf",
           "loci-evaluate changes demo-output/day --map apps/samples/kitchen.urdf --json"},
          [](CLI::App& app) {
            auto arguments = std::make_shared<Arguments>();
            app.add_option("DIR", arguments->folder,
                           "Recording with objects.csv and transitions.csv, or truth.jsonl")
                ->required();
            app.add_option("-m,--memory", arguments->memory, "Keep the memory in this file");
            app.add_option("--map", arguments->map, "URDF of the kitchen");
            app.add_option("--pipeline", arguments->pipeline, "Pipeline as YAML instead of the default one");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci
