#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command together_command() {
  return {"together",
          "How often things are seen together",
          {"loci-memory together red -m demo-output/memory.loci",
           "loci-memory together red --with green -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
              std::string other;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("OBJECT...", &arguments->subject,
                             "object_12, a name, a colour, a size, \"on table_1\"");
            table.option("--with", &arguments->other, "The other object in words",
                         {.default_text = "all others"});
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store,
                              memory::TogetherQuestion{joined(arguments->subject), arguments->other, as_of});
            };
          }};
}

}  // namespace loci::apps
