#include "apps/evaluate/commands.h"
#include "apps/evaluate/segmentation/comparison.h"
#include "apps/evaluate/segmentation/flat_comparison.h"
#include "mapping/base/json.h"

namespace loci::apps {
namespace {

using namespace segmentation_evaluation;

struct Arguments {
  std::string folder;
  std::string pipeline;
  std::string images;
  segmentation_evaluation::ComparisonOptions comparison;
  bool flat = false;
  segmentation_evaluation::FlatComparisonOptions flat_comparison;
  perception::FlatOptions flat_options;
};

void run(Arguments& given, Session& session) {
  table_of(given.comparison).validate();
  table_of(given.flat_comparison).validate();
  if (given.folder.empty() && !given.flat)
    throw Error("nothing was chosen to measure", {}, "give RECORDING or --flat");
  std::string text;
  Json json = Json::object();
  if (!given.folder.empty()) {
    const segmentation_evaluation::Comparison comparison = compare(
        given.folder, given.pipeline, given.images, given.comparison, session.progress(), session.warnings());
    text += comparison.text(session.flags().verbose);
    json = comparison.to_json();
  }
  if (given.flat) {
    const segmentation_evaluation::FlatComparison comparison =
        compare_flat(given.flat_comparison, given.flat_options, given.images, session.progress());
    text += comparison.text();
    json["flat"] = comparison.to_json();
  }
  session.answer(text, json);
}

}  // namespace

Command segmentation_command() {
  return {"segmentation",
          "Object hypotheses against labelled scenes and PCL",
          {"loci-evaluate segmentation tests/data/blocks",
           "loci-evaluate segmentation --flat --flat-workspaces 1 --flat-images 2 --flat-empty 10 --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<Arguments>();
            table.positional("[RECORDING]", &given->folder,
                             "Recording with FRAME_label.png for its depth images: 0 not judged, 1 to 19 "
                             "table, from 20 on tens are objects");
            table.flag("--flat", given->flat, "Measure flat objects (10 mm) in simulated workspaces, too");
            table.option("--pipeline FILE", &given->pipeline, "Pipeline as YAML instead of the tabletop one");
            table.option("-o,--output FOLDER", &given->images,
                         "Folder for images: colour, truth, and what each method found");
            table.options(table_of(given->comparison), "Comparison");
            table.options(table_of(given->flat_comparison), "Flat objects");
            return [given](Session& session) { run(*given, session); };
          }};
}

}  // namespace loci::apps
