#include "apps/map/commands.h"
#include "mapping/articulation/articulation.h"

namespace loci {

Command articulate_command() {
  return {
      "articulate",
      "Joints from recorded tracks",
      {"loci-map articulate --track apps/samples/tracks/door.csv",
       "loci-map articulate --track apps/samples/tracks/drawer.csv --json"},
      [](CLI::App& app) {
        struct Arguments {
          std::string track;
          TrackOptions options;
        };
        auto arguments = std::make_shared<Arguments>();
        app.add_option("--track", arguments->track, "CSV with x, y, z and maybe qx, qy, qz, qw")->required();
        add_options(app, table_of(arguments->options));
        return [arguments](Session& session) {
          const TrackResult result = fit_track(read_track(arguments->track), arguments->options);
          session.answer(result.summary() + "\n", result.report());
        };
      }};
}

}  // namespace loci
