#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command kind_command() {
  return {"kind",
          "What kind of scene this is: scenes with the same things, and the occasion",
          {"loci-memory kind -m demo-output/memory.loci",
           "loci-memory kind --scene 3 -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::optional<memory::Id> scene;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.option("--scene", &arguments->scene, "Number of the scene", {.default_text = "the last"});
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store, memory::KindQuestion{arguments->scene, as_of});
            };
          }};
}

}  // namespace loci::apps
