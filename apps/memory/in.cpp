#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command in_command() {
  return {"in",
          "What is in a place",
          {"loci-memory in drawer_1 -m demo-output/memory.loci",
           "loci-memory in drawer_1 -m demo-output/memory.loci --at 08:30"},
          [](CLI::App& app) {
            struct Arguments {
              MemoryArguments memory;
              std::string place;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(app);
            app.add_option("place", arguments->place, "The place, e.g. drawer_1")->required();
            return [arguments](Session& session) {
              const Store store = Store::open_read(arguments->memory.memory);
              const AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store, ContentsQuestion{.place = arguments->place, .as_of = as_of});
            };
          }};
}

}  // namespace loci
