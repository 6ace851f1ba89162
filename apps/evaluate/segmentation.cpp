#include "apps/evaluate/commands.h"
#include "apps/evaluate/segmentation/comparison.h"
#include "apps/evaluate/segmentation/flat_comparison.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

using namespace segmentation_evaluation;

struct Arguments {
  std::string folder;
  std::string pipeline;
  std::string images;
  segmentation_evaluation::ComparisonOptions comparison;
  int stacks = 0;
  int tables = 0;
  int seed = 1;
  bool flat = false;
  segmentation_evaluation::FlatComparisonOptions flat_comparison;
  perception::FlatOptions flat_options;
};

void run(Arguments& given, Session& session) {
  table_of(given.comparison).validate();
  table_of(given.flat_comparison).validate();
  if (given.folder.empty() && given.stacks == 0 && given.tables == 0 && !given.flat)
    throw Error("nothing was chosen to measure", {}, "give RECORDING, --stacks, --tables or --flat");
  std::string text;
  Json json = Json::object();
  const auto judge = [&](const LabelledScenes& scenes) {
    const Comparison comparison = compare(scenes, given.pipeline, given.images, given.comparison,
                                          session.progress(), session.warnings());
    text += comparison.text(session.flags().verbose);
    return comparison.to_json();
  };
  if (!given.folder.empty()) json = judge(open_labelled_scenes(given.folder));
  if (given.stacks > 0)
    json["stacks"] = judge(drawn_tables(mapping::Arrangement::stacked, given.stacks, given.seed));
  if (given.tables > 0)
    json["tables"] = judge(drawn_tables(mapping::Arrangement::spread, given.tables, given.seed));
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
          {"loci-evaluate segmentation tests/data/blocks", "loci-evaluate segmentation --stacks 2 --no-peers",
           "loci-evaluate segmentation --flat --flat-workspaces 1 --flat-images 2 --flat-empty 10 --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<Arguments>();
            table.positional("[RECORDING]", &given->folder,
                             "Recording with FRAME_label.png for its depth images: 0 not judged, 1 to 19 "
                             "table, from 20 on tens are objects");
            table.option("--stacks N", &given->stacks, "Measure stacks of objects on N rendered tables, too");
            table.option("--tables N", &given->tables,
                         "Measure objects apart from each other on N rendered tables, too");
            table.option("--seed N", &given->seed, "Seed of these tables");
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
