#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command usual_command() {
  return {"usual",
          "Where an object usually is, by hour and weekday",
          {"loci-memory usual red -m demo-output/memory.loci",
           "loci-memory usual object_5 --during morning -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
              std::string during;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("OBJECT...", &arguments->subject,
                             "object_12, a name, a colour, a size, \"on table_1\"");
            table.option("--during", &arguments->during,
                         "Only what was seen then: \"noon\", \"9 to 11\", \"Mondays\", \"weekend morning\"");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              answer_question(session, store,
                              memory::UsualQuestion{joined(arguments->subject), as_of, arguments->during});
            };
          }};
}

}  // namespace loci::apps
