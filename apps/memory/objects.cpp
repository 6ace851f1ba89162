#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command objects_command() {
  return {"objects",
          "Lists the objects",
          {"loci-memory objects -m demo-output/memory.loci",
           "loci-memory objects red -m demo-output/memory.loci --json"},
          [](CLI::App& app) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(app);
            app.add_option("object", arguments->subject, "Only these: a colour, a size, \"on table_1\"");
            return [arguments](Session& session) {
              const Store store = Store::open_read(arguments->memory.memory);
              const AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store,
                              ObjectsQuestion{.subject = joined(arguments->subject), .as_of = as_of});
            };
          }};
}

}  // namespace loci
