#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command near_command() {
  return {"near",
          "What is within a radius of a point, object or place",
          {"loci-memory near red --radius 0.4 -m demo-output/memory.loci",
           "loci-memory near 2.0,1.0,0.8 --radius 1 -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
              std::string radius;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("AROUND...", &arguments->subject,
                             "x,y or x,y,z in the map, an object, or a place");
            table.option("--radius", &arguments->radius, "Between centres: metres, or \"50 cm\"",
                         {.default_text = "0.5"});
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              memory::NearQuestion question{.subject = joined(arguments->subject), .as_of = as_of};
              if (!arguments->radius.empty()) question.radius_m = memory::read_length(arguments->radius);
              answer_question(session, store, question);
            };
          }};
}

}  // namespace loci::apps
