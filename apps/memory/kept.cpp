#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command kept_command() {
  return {"kept",
          "What is kept on or in a place, of all that was ever seen there",
          {"loci-memory kept drawer_1 -m demo-output/memory.loci",
           "loci-memory kept table_1 -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> place;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("PLACE...", &arguments->place, "The place, e.g. table_1 or drawer_1");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store, memory::KeptQuestion{joined(arguments->place), as_of});
            };
          }};
}

}  // namespace loci::apps
