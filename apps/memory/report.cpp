#include "apps/memory/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "memory/report/memory_report.h"

namespace loci {

Command report_command() {
  return {"report",
          "Writes a self-contained HTML page about a memory",
          {"loci-memory report -m demo-output/memory.loci -o demo-output/memory.html",
           "loci-memory report -m demo-output/memory.loci --append-to demo-output/report.html"},
          [](CLI::App& app) {
            struct Arguments {
              std::string memory, output, append_to;
            };
            auto arguments = std::make_shared<Arguments>();
            app.add_option("-m,--memory", arguments->memory, "The memory")->required();
            auto* output = app.add_option("-o,--output", arguments->output, "The page to write");
            auto* append =
                app.add_option("--append-to", arguments->append_to,
                               "A page of loci-map's report, to which the memory's sections are added");
            append->excludes(output);
            return [arguments](Session& session) {
              const bool append_to_page = !arguments->append_to.empty();
              const std::string target = append_to_page ? arguments->append_to : arguments->output;
              if (target.empty()) throw Error("nowhere to write to", {}, "give -o FILE or --append-to PAGE");
              std::optional<std::string> page;
              if (append_to_page) page = read_file(target);
              write_file_atomically(target, memory_report(Store::open_read(arguments->memory), page));
              session.answer("report " + target, Json{{"report", target}});
            };
          }};
}

}  // namespace loci
