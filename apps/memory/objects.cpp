#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "memory/questions/unseen.h"

namespace loci::apps {

Command objects_command() {
  return {
      "objects",
      "Lists the objects",
      {"loci-memory objects -m demo-output/memory.loci",
       "loci-memory objects red -m demo-output/memory.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          MemoryArguments memory;
          std::vector<std::string> subject;
          std::string since;
        };
        auto arguments = std::make_shared<Arguments>();
        arguments->memory.declare(table);
        table.positional("[OBJECT...]", &arguments->subject, "Only these: a colour, a size, \"on table_1\"");
        table.option("--unseen-since", &arguments->since, "Only what was not seen since this time");
        return [arguments](Session& session) {
          const memory::Store store = memory::Store::open_read(arguments->memory.memory);
          const memory::AsOf as_of = arguments->memory.as_of(store);
          const memory::ObjectsQuestion question{.subject = joined(arguments->subject), .as_of = as_of};
          const memory::ObjectsAnswer answer =
              arguments->since.empty()
                  ? ask(store, question)
                  : ask_unseen_since(store, question, memory::TimeReader(store).read(arguments->since).first);
          session.answer(to_text(answer, memory::TimeWriter(store)), to_json(answer));
        };
      }};
}

}  // namespace loci::apps
