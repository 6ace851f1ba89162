#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command where_command() {
  return {"where",
          "Where an object is",
          {"loci-memory where red -m demo-output/memory.loci",
           "loci-memory where object_1 -m demo-output/memory.loci --at 08:30 --json"},
          [](CLI::App& app) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(app);
            app.add_option("object", arguments->subject,
                           "object_12, a name, a colour, a size, \"on table_1\"")
                ->required();
            return [arguments](Session& session) {
              const Store store = Store::open_read(arguments->memory.memory);
              const AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store,
                              WhereQuestion{.subject = joined(arguments->subject), .as_of = as_of});
            };
          }};
}

}  // namespace loci
