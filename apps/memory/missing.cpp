#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command missing_command() {
  return {"missing",
          "What is missing from the arrangement at a place",
          {"loci-memory missing table_1 -m demo-output/memory.loci",
           "loci-memory missing table_1 --for breakfast -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> place;
              std::string occasion;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("[PLACE...]", &arguments->place, "The place, e.g. table_1",
                             {.default_text = "every place"});
            table.option("--for", &arguments->occasion, "Only its hours: breakfast, lunch, tea, dinner",
                         {.default_text = "any"});
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store,
                              memory::MissingQuestion{joined(arguments->place), arguments->occasion, as_of});
            };
          }};
}

}  // namespace loci::apps
