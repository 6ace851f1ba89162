#include <fmt/format.h>

#include "apps/evaluate/commands.h"
#include "apps/evaluate/detection/detector_figures.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

using namespace detection_evaluation;

struct Arguments {
  std::string network, images;
  int tables = 100, seed = 1;
};

void run(const Arguments& given, Session& session) {
  if (given.network.empty() == given.images.empty())
    throw Error("nothing was chosen to do", {},
                "give the description of a network, or --training-images FOLDER");
  const Random random(static_cast<uint64_t>(given.seed));
  if (!given.images.empty()) {
    write_training_images({given.tables, random.fork(0)}, given.images, session.flags().threads,
                          session.progress());
    session.answer(fmt::format("{} images with labels in {}", given.tables, given.images),
                   {{"tables", given.tables}, {"classes", rendered_classes()}});
    return;
  }
  const DetectorFigures figures = evaluate_detector(perception::ObjectDetector(given.network),
                                                    {given.tables, random.fork(1)}, session.progress());
  session.answer(figures.text(), figures.to_json());
}

}  // namespace

Command detection_command() {
  return {"detection",
          "Recall and precision of a detector (ONNX) on rendered tables, and images to train one",
          {"loci-evaluate detection tests/data/detector/household.yaml --tables 10",
           "loci-evaluate detection --training-images /tmp/tables --tables 10"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<Arguments>();
            table.positional("[NETWORK]", &given->network, "Description of a network (YAML)");
            table.option("--training-images FOLDER", &given->images,
                         "Write images and labels (YOLO) of other tables instead");
            table.option("--tables N", &given->tables, "Number of tables", {.min = 1, .max = 1000000});
            table.option("--seed N", &given->seed, "Seed of the tables; 1 was trained with", {.min = 0});
            return [given](Session& session) { run(*given, session); };
          }};
}

}  // namespace loci::apps
