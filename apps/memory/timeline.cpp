#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command timeline_command() {
  return {"timeline",
          "Scenes and events in order",
          {"loci-memory timeline -m demo-output/memory.loci",
           "loci-memory timeline -m demo-output/memory.loci --from 09:00 --json"},
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
                              TimelineQuestion{.from = arguments->span.first(store),
                                               .to = arguments->span.last(store),
                                               .as_of = as_of});
            };
          }};
}

}  // namespace loci
