#include "apps/memory/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "memory/report/memory_report.h"

namespace loci::apps {

Command report_command() {
  return {"report",
          "Writes a self-contained HTML page about a memory",
          {"loci-memory report -m demo-output/memory.loci -o demo-output/memory.html",
           "loci-memory report -m demo-output/memory.loci --append-to demo-output/report.html"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, output, append_to;
              memory::ReportOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.memory(arguments->memory);
            table.option("-o,--output", &arguments->output, "The page to write");
            table.option("--append-to", &arguments->append_to,
                         "A page of loci-map's report, to which the memory's sections are added",
                         {.excludes = {"--output"}});
            table.option("--objects", &arguments->options.objects, "So many objects at most get a card");
            table.option("--scenes", &arguments->options.scenes,
                         "So many scenes at most, the last ones, in timeline, decisions and log", {.min = 1});
            return [arguments](Session& session) {
              const bool append_to_page = !arguments->append_to.empty();
              const std::string target = append_to_page ? arguments->append_to : arguments->output;
              if (target.empty()) throw Error("nowhere to write to", {}, "give -o FILE or --append-to PAGE");
              std::optional<std::string> page;
              if (append_to_page) page = read_file(target);
              write_file_atomically(target, memory_report(memory::Store::open_read(arguments->memory), page,
                                                          arguments->options, session.progress()));
              session.answer("report " + target, Json{{"report", target}});
            };
          }};
}

}  // namespace loci::apps
