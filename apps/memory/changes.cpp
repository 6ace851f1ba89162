#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "memory/questions/change_kinds.h"

namespace loci::apps {

Command changes_command() {
  return {"changes",
          "What happened between two times",
          {"loci-memory changes -m demo-output/memory.loci",
           "loci-memory changes -m demo-output/memory.loci --between 08:00 10:00"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              SpanArguments span;
              std::string subject, place, kind;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            arguments->span.declare(table);
            table.option("--object", &arguments->subject, "Only of these objects");
            table.option("--place", &arguments->place, "Only at this place");
            table.option("--kind", &arguments->kind,
                         "Only appeared, reappeared, moved, gone, hidden, looks_different or joint_changed; "
                         "came, left: moves to or from the place too");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              const memory::ChangesAnswer answer = ask_for_kind(store,
                                                                {.from = arguments->span.first(store),
                                                                 .to = arguments->span.last(store),
                                                                 .subject = arguments->subject,
                                                                 .place = arguments->place,
                                                                 .as_of = as_of},
                                                                arguments->kind);
              session.answer(to_text(answer, memory::TimeWriter(store)), to_json(answer));
            };
          }};
}

}  // namespace loci::apps
