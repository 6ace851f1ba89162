#include "memory/ingest/ingest.h"

#include "apps/memory/commands.h"
#include "mapping/base/json.h"

namespace loci::apps {

Command ingest_command() {
  return {"ingest",
          "Takes in detections of other systems",
          {"loci-memory ingest apps/samples/detections.jsonl -m demo-output/detections.loci --resume",
           "loci-memory ingest apps/samples/detections.jsonl -m demo-output/detections_map.loci --map "
           "apps/samples/kitchen.urdf --strict --resume --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string file, memory, map, now;
              memory::IngestOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("FILE", &arguments->file, "Detections, one scene per line (JSON Lines)");
            table.memory(arguments->memory);
            table.option("--map", &arguments->map, "URDF of the kitchen, for the places");
            table.option("--now", &arguments->now, "When the memory learns it, ISO 8601",
                         {.default_text = "the clock"});
            table.options(table_of(arguments->options));
            return [arguments](Session& session) {
              memory::WriteOptions write;
              if (!arguments->now.empty()) write.now = parse_time(arguments->now);
              arguments->options.map = arguments->map;
              const memory::IngestResult result =
                  ingest(arguments->file, arguments->memory, arguments->options, write, session.progress(),
                         session.warnings());
              session.answer(result.summary(), result.report());
            };
          }};
}

}  // namespace loci::apps
