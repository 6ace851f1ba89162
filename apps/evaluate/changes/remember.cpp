#include "apps/evaluate/changes/remember.h"

#include "mapping/base/config.h"
#include "mapping/base/json.h"
#include "memory/annotators/memory_annotators.h"
#include "memory/annotators/memory_session.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/hypotheses/known_map.h"
#include "perception/types/types.h"

namespace loci::changes {

void remember(const std::shared_ptr<Recording>& recording, const RememberOptions& options, Progress& progress,
              Warnings& warnings) {
  AnnotatorRegistry registry;
  add_annotators(registry);
  add_memory_annotators(registry);
  Pipeline pipeline = options.pipeline.empty()
                          ? Pipeline::parse(default_pipeline(), "the default pipeline", registry)
                          : Pipeline::parse(Config::read(options.pipeline), registry);
  pipeline.add("IdentityResolution", registry);
  pipeline.add_writer("MemoryWriter", registry);
  Resources resources;
  resources.put(recording);
  if (!options.map.empty()) {
    const auto map = KnownMap::load(options.map, {}, warnings);
    resources.put(map);
    resources.put(std::make_shared<World>(map->world));
  }
  MemorySessionOptions session;
  session.memory = options.memory;
  session.program = options.program;
  session.configuration = pipeline.to_json();
  session.map = options.map;
  resources.put(std::make_shared<MemorySession>(session, *recording));
  Context context{resources, warnings, options.threads, {}};
  run_with_memory(pipeline, context, types::type_system(), progress);
}

}  // namespace loci::changes
