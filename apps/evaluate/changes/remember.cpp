#include "apps/evaluate/changes/remember.h"

#include "mapping/base/config.h"
#include "mapping/base/text/json.h"
#include "memory/annotators/memory_annotators.h"
#include "memory/annotators/memory_session.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/types/scene_cas.h"

namespace loci::apps::changes {

void remember(const std::shared_ptr<mapping::Recording>& recording, const RememberOptions& options,
              Progress& progress, Warnings& warnings) {
  perception::AnnotatorRegistry registry;
  add_annotators(registry);
  memory::add_memory_annotators(registry);
  perception::Pipeline pipeline =
      options.pipeline.empty()
          ? perception::Pipeline::parse(perception::default_pipeline(), "the default pipeline", registry)
          : perception::Pipeline::parse(Config::read(options.pipeline), registry);
  pipeline.add("IdentityResolution", registry);
  pipeline.add_writer("MemoryWriter", registry);
  perception::Resources resources;
  resources.put(recording);
  if (!options.map.empty()) {
    const auto map = perception::KnownMap::load(options.map, options.package_paths, warnings);
    resources.put(map);
    resources.put(std::make_shared<mapping::World>(map->world));
  }
  memory::MemorySessionOptions session;
  session.memory = options.memory;
  session.program = options.program;
  session.configuration = pipeline.to_json();
  session.map = options.map;
  resources.put(std::make_shared<memory::MemorySession>(session, *recording));
  perception::Context context{resources, warnings, options.threads, {}};
  memory::run_with_memory(pipeline, context, perception::types::type_system(), progress);
}

}  // namespace loci::apps::changes
