#include <fmt/format.h>

#include "apps/map/commands.h"
#include "mapping/base/json.h"
#include "mapping/fusion/fusion.h"

namespace loci::apps {

Command fuse_command() {
  return {"fuse",
          "Posed depth frames to a scan set",
          {"loci-map fuse demo-output/tour -o demo-output/scans",
           "loci-map fuse demo-output/tour -o demo-output/coarse --every 2 --voxel-m 0.02 --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string recording, out;
              mapping::FusionOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("RECORDING", &arguments->recording, "Folder of the recording");
            table.option("-o,--output", &arguments->out, "Folder of the scan set", {.required = true});
            table.options(table_of(arguments->options));
            return [arguments](Session& session) {
              arguments->options.threads = session.flags().threads;
              const auto recording = mapping::open_recording(arguments->recording);
              for (const std::string& problem : recording->info().problems) session.warnings().add(problem);
              const mapping::FusionResult result = fuse(*recording, arguments->options, session.progress());
              write_scan_set(result.scans, arguments->out);
              session.timing("fuse", result.seconds);
              Json json = result.report();
              json["out"] = arguments->out;
              session.answer(result.summary() + " in " + arguments->out, json);
            };
          }};
}

}  // namespace loci::apps
