#include "apps/evaluate/commands.h"
#include "apps/evaluate/segmentation/comparison.h"

namespace loci {
namespace {

using namespace segmentation_evaluation;

struct Arguments {
  std::string folder;
  std::string pipeline;
  std::string pictures;
  ComparisonOptions comparison;
};

void run(Arguments& given, Session& session) {
  table_of(given.comparison).validate();
  const Comparison comparison = compare(given.folder, given.pipeline, given.pictures, given.comparison,
                                        session.progress(), session.warnings());
  session.answer(comparison.text(session.flags().verbose), comparison.to_json());
}

}  // namespace

Command segmentation_command() {
  return {
      "segmentation",
      "Object hypotheses against labelled scenes, beside PCL",
      {"loci-evaluate segmentation tests/data/blocks", "loci-evaluate segmentation tests/data/blocks --json"},
      [](CLI::App& app) {
        auto given = std::make_shared<Arguments>();
        app.add_option("DIR", given->folder,
                       "Recording with FRAME_label.png beside the depth pictures: 0 not judged, 1 to 19 "
                       "table, from 20 on tens are objects")
            ->required();
        app.add_option("--pipeline", given->pipeline, "Pipeline as YAML instead of the tabletop one");
        app.add_option("-o,--output", given->pictures,
                       "Folder for pictures: colour, truth, ours, PCL's methods");
        add_options(app, table_of(given->comparison));
        return [given](Session& session) { run(*given, session); };
      }};
}

}  // namespace loci
