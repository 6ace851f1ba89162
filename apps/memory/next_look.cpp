#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command next_look_command() {
  return {"next-look",
          "Where to look next for an object",
          {"loci-memory next-look red -m demo-output/memory.loci",
           "loci-memory next-look red --from 1.0,0.5 -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
              std::vector<double> from;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("OBJECT...", &arguments->subject,
                             "object_12, a name, a colour, a size, \"on table_1\"");
            table.option("--from", &arguments->from, "Where one stands, x,y in the map",
                         {.default_text = "the last camera", .values = 2});
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              memory::NextLookQuestion question{.subject = joined(arguments->subject)};
              question.as_of = arguments->memory.as_of(store);
              if (!arguments->from.empty()) question.from = Vector2d(arguments->from[0], arguments->from[1]);
              answer_question(session, store, question);
            };
          }};
}

}  // namespace loci::apps
