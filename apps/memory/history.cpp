#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command history_command() {
  return {"history",
          "Where an object was, over time",
          {"loci-memory history object_1 -m demo-output/memory.loci",
           "loci-memory history red -m demo-output/memory.loci --between \"this morning\" noon --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              SpanArguments span;
              std::vector<std::string> subject;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            arguments->span.declare(table);
            table.positional("OBJECT...", &arguments->subject,
                             "object_12, a name, a colour, a size, \"on table_1\"");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              answer_question(
                  session, store,
                  memory::HistoryQuestion{joined(arguments->subject), arguments->span.first(store),
                                          arguments->span.last(store), as_of});
            };
          }};
}

}  // namespace loci::apps
