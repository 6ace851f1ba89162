#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command scenes_command() {
  return {"scenes",
          "Lists the scenes",
          {"loci-memory scenes -m demo-output/memory.loci",
           "loci-memory scenes -m demo-output/memory.loci --from 09:00 --json"},
          [](CLI::App& app) {
            struct Arguments {
              MemoryArguments memory;
              SpanArguments span;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(app);
            arguments->span.declare(app);
            return [arguments](Session& session) {
              const Store store = Store::open_read(arguments->memory.memory);
              const AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store,
                              ScenesQuestion{.from = arguments->span.first(store),
                                             .to = arguments->span.last(store),
                                             .as_of = as_of});
            };
          }};
}

}  // namespace loci
