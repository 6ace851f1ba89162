#include "mapping/simulation/record.h"

#include "apps/simulate/commands.h"
#include "mapping/base/text/json.h"

namespace loci::apps {

Command record_command() {
  return {"record",
          "Render a scenario as a recording",
          {"loci-simulate record apps/samples/day.yaml -o demo-output/day",
           "loci-simulate record apps/samples/openings.yaml -o demo-output/openings --seed 2 --noise none"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string scenario, output;
              mapping::RecordOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("SCENARIO", &arguments->scenario, "Scenario (YAML)");
            table.output("FOLDER", &arguments->output, "Folder of the recording", {.replaces = true});
            table.package_path(&arguments->options.package_paths);
            table.options(table_of(arguments->options), "Rendering");
            return [arguments](Session& session) {
              arguments->options.threads = session.flags().threads;
              arguments->options.force = session.flags().force;
              const mapping::RecordResult result =
                  record(mapping::read_scenario(arguments->scenario), arguments->output, arguments->options,
                         session.progress(), session.warnings());
              session.answer(result.summary(), result.report());
            };
          }};
}

}  // namespace loci::apps
