#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command on_command() {
  return {"on",
          "What is on a place",
          {"loci-memory on table_1 -m demo-output/memory.loci",
           "loci-memory on table_1 -m demo-output/memory.loci --at 08:30"},
          [](CLI::App& app) {
            struct Arguments {
              MemoryArguments memory;
              std::string place;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(app);
            app.add_option("place", arguments->place, "The place, e.g. table_1")->required();
            return [arguments](Session& session) {
              const Store store = Store::open_read(arguments->memory.memory);
              const AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store, ContentsQuestion{.place = arguments->place, .as_of = as_of});
            };
          }};
}

}  // namespace loci
