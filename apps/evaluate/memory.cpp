#include "apps/evaluate/commands.h"
#include "apps/evaluate/memory/figures.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"

namespace loci::apps {

Command memory_command() {
  return {"memory",
          "Large memories: import through the full reasoning, questions, concurrent readers, recovery",
          {"loci-evaluate memory --observations 600 -o demo-output/memory-figures",
           "loci-evaluate memory --observations 400 --kills 2 -o demo-output/memory-figures --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              memory_experiment::MemoryOptions options;
              std::string folder;
            };
            auto arguments = std::make_shared<Arguments>();
            table.options(table_of(arguments->options));
            table.output("FOLDER", &arguments->folder, "Folder for the memory");
            return [arguments](Session& session) {
              table_of(arguments->options).validate();
              make_folder(arguments->folder);
              const memory_experiment::MemoryFigures figures =
                  memory_experiment::measure(arguments->options, arguments->folder, session.progress());
              session.answer(text_of(figures), json_of(figures));
            };
          }};
}

}  // namespace loci::apps
