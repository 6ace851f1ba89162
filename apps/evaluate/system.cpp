#include "apps/evaluate/commands.h"
#include "apps/evaluate/system/experiment.h"
#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  system_evaluation::SystemOptions options;
  std::string output;
};

void run(Arguments& arguments, Session& session) {
  table_of(arguments.options).validate();
  arguments.options.threads = session.flags().threads;
  const TemporaryFolder scratch("loci-evaluate-system");
  const std::filesystem::path folder =
      arguments.output.empty() ? scratch.path() : std::filesystem::path(arguments.output);
  make_folder(folder);
  const system_evaluation::SystemResult result =
      run_system(arguments.options, folder, session.progress(), session.warnings());
  const Json json = json_of(result);
  if (!arguments.output.empty()) {
    write_file_atomically(folder / "figure_8_1.svg", result.figure);
    write_json(folder / "system.json", json);
  }
  session.answer(text_of(result), json);
}

}  // namespace

Command system_command() {
  return {"system",
          "Household scenes on two counters through the whole system: objects, annotations, time",
          {"loci-evaluate system --scenes 4", "loci-evaluate system --scenes 4 --json -o demo-output/system"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.option("--map MAP", &arguments->options.map, "URDF of a kitchen with counters");
            table.option("--pipeline FILE", &arguments->options.pipeline,
                         "Pipeline as YAML instead of the evaluation's own");
            table.option("-o,--output FOLDER", &arguments->output,
                         "Keep recording, memory, figures (JSON) and figure 8.1 (SVG) in this folder");
            table.options(table_of(arguments->options));
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
