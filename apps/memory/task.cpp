#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"

namespace loci::apps {

Command task_command() {
  return {"task",
          "What a task needs: the objects, where they are, where to, and what is missing",
          {"loci-memory task set table --for breakfast -m demo-output/memory.loci",
           "loci-memory task stow red --to drawer_1 -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> words;
              std::string to, occasion;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("WORD...", &arguments->words, "bring X, stow X, set PLACE, or clean [PLACE]");
            table.option("--to", &arguments->to, "stow: the place to put it",
                         {.default_text = "where it usually is"});
            table.option("--for", &arguments->occasion, "set: the occasion, e.g. breakfast");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              memory::CommandLine command{.verb = "task", .words = arguments->words};
              if (!arguments->to.empty()) command.options["to"] = {arguments->to};
              if (!arguments->occasion.empty()) command.options["for"] = {arguments->occasion};
              const memory::AnyAnswer answer = run_question(store, command, arguments->memory.as_of(store));
              session.answer(to_text(answer, memory::TimeWriter(store)), to_json(answer));
            };
          }};
}

}  // namespace loci::apps
