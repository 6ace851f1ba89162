#include "apps/perceive/memory_target.h"

#include "mapping/base/json.h"
#include "memory/annotators/memory_annotators.h"
#include "perception/annotators/hypotheses/known_map.h"

namespace loci::apps {

void MemoryTarget::declare(ArgumentTable& table) {
  table.option("-m,--memory", &memory, "Memory to write to, FILE.loci (made when it does not exist)");
  table.flag("--resume", resume, "Go on with a recording that the memory has in part");
  table.option("--now", &now, "When the memory learns it, ISO 8601", {.default_text = "the clock"});
}

void MemoryTarget::prepare(const std::string& map, perception::Pipeline& pipeline,
                           const perception::AnnotatorRegistry& registry,
                           perception::Resources& resources) const {
  if (memory.empty()) {
    if (resume) throw Error("--resume needs a memory", {}, "name it with -m FILE.loci");
    return;
  }
  pipeline.add("IdentityResolution", registry);
  pipeline.add_writer("MemoryWriter", registry);
  pipeline.check(registry);
  memory::MemorySessionOptions options;
  options.memory = memory;
  options.configuration = pipeline.to_json();
  options.resume = resume;
  options.map = map;
  if (!now.empty()) options.write.now = parse_time(now);
  const mapping::Recording& recording =
      resources.get<mapping::Recording>("recording to read", "give its folder");
  resources.put_for_run(std::make_shared<memory::MemorySession>(options, recording));
  if (const auto known = resources.find<perception::KnownMap>())
    resources.put(std::make_shared<mapping::World>(known->world));
}

}  // namespace loci::apps
