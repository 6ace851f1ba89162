#include "apps/evaluate/articulation/tracks.h"
#include "apps/evaluate/commands.h"
#include "mapping/base/text/json.h"

namespace loci::apps {

Command articulation_command() {
  return {"articulation",
          "Joint types of recorded tracks against labels and a least-squares baseline",
          {"loci-evaluate articulation apps/samples/tracks",
           "loci-evaluate articulation apps/samples/tracks --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string folder = "../shared/data/articulation_tracks";
              mapping::TrackOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("[FOLDER]", &arguments->folder, "Folder of tracks with index.csv");
            table.options(table_of(arguments->options), "Tracks");
            return [arguments](Session& session) {
              const articulation::TrackEvaluation evaluation = articulation::evaluate_tracks(
                  articulation::read_known_tracks(arguments->folder), arguments->options);
              session.answer(evaluation.text(), evaluation.report());
            };
          }};
}

}  // namespace loci::apps
