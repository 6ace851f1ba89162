#include "apps/evaluate/commands.h"
#include "apps/evaluate/description/drawn_codes.h"
#include "apps/evaluate/description/household.h"
#include "apps/evaluate/description/images.h"
#include "apps/evaluate/description/primitives.h"
#include "apps/evaluate/description/products.h"
#include "apps/evaluate/description/reading.h"
#include "apps/evaluate/description/service.h"
#include "apps/evaluate/description/shapes.h"
#include "apps/evaluate/description/templates.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

using namespace description_evaluation;

struct Arguments {
  std::string catalogue;
  description_evaluation::ProductsOptions products;
  perception::RecognitionOptions recognition;
  std::string codes;
  bool drawn_codes = false;
  bool service = false;
  bool shapes = false;
  bool primitives = false;
  std::string images;
  std::string templates;
  description_evaluation::ImagesOptions image_options;
  std::vector<std::string> folders;
  description_evaluation::ShapesOptions shape_options;
  bool household = false;
  std::string model_out;
  description_evaluation::HouseholdOptions household_options;
};

void run(Arguments& given, Session& session) {
  table_of(given.products).validate();
  table_of(given.recognition).validate();
  table_of(given.shape_options).validate();
  table_of(given.household_options).validate();
  if (given.catalogue.empty() && given.codes.empty() && !given.shapes && !given.primitives &&
      given.images.empty() && given.templates.empty() && !given.household && !given.drawn_codes)
    throw Error("nothing was chosen to measure", {},
                "give --catalogue DIR, --codes DIR, --drawn-codes, --shapes, --household, --images DIR, "
                "--templates DIR or --primitives");
  if (given.service && given.catalogue.empty())
    throw Error("--service needs a catalogue", {}, "give --catalogue DIR");
  std::string text;
  Json json = Json::object();
  if (given.service) {
    const description_evaluation::ServiceResult result = description_evaluation::evaluate_service(
        given.catalogue, given.codes, given.products.every, session.flags().threads, session.progress(),
        session.warnings());
    text += result.text();
    json["service"] = result.to_json();
  } else if (!given.catalogue.empty()) {
    const description_evaluation::ProductsResult result =
        evaluate_products(given.catalogue, given.products, given.recognition, session.flags().threads,
                          session.progress(), session.warnings());
    text += result.text();
    json["products"] = result.to_json();
  }
  if (!given.codes.empty() && !given.service) {
    const description_evaluation::ReadingResult result =
        description_evaluation::evaluate_reading(given.codes, given.catalogue, session.progress());
    text += result.text();
    json["reading"] = result.to_json();
  }
  if (given.drawn_codes) {
    const description_evaluation::DrawnCodesResult result = evaluate_drawn_codes(session.progress());
    text += result.text();
    json["drawn_codes"] = result.to_json();
  }
  if (given.shapes) {
    const description_evaluation::ShapesResult result = evaluate_shapes(
        given.folders, given.shape_options, session.flags().threads, session.progress(), session.warnings());
    text += result.text();
    json["shapes"] = result.to_json();
  }
  if (given.household) {
    const description_evaluation::HouseholdResult result =
        evaluate_household(given.folders, given.household_options, given.model_out, session.flags().threads,
                           session.progress(), session.warnings());
    text += result.text();
    json["household"] = result.to_json();
  }
  if (!given.images.empty()) {
    const description_evaluation::ImagesResult result =
        evaluate_images(given.images, given.image_options, session.flags().threads, session.progress());
    text += result.text();
    json["images"] = result.to_json();
  }
  if (!given.templates.empty()) {
    const description_evaluation::TemplatesResult result =
        description_evaluation::evaluate_templates(given.templates, session.progress());
    text += result.text();
    json["templates"] = result.to_json();
  }
  if (given.primitives) {
    const description_evaluation::ShapesOptions& options = given.shape_options;
    const description_evaluation::PrimitivesResult result = description_evaluation::evaluate_primitives(
        static_cast<size_t>(options.test_scenes), Random(static_cast<uint64_t>(options.seed)).fork(1),
        session.progress(), session.warnings());
    text += result.text();
    json["primitives"] = result.to_json();
  }
  session.answer(text, json);
}

}  // namespace

Command description_command() {
  return {"description",
          "Shape classes, products against brute-force SIFT, codes, words and visual search",
          {"loci-evaluate description --catalogue tests/data/products",
           "loci-evaluate description --catalogue tests/data/products --service",
           "loci-evaluate description --primitives --test-scenes 4",
           "loci-evaluate description --shapes --train-scenes 10 --test-scenes 3 --folds 2 --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<Arguments>();
            table.option("--catalogue FOLDER", &given->catalogue,
                         "Catalogue of products with labels.csv: images and what they show");
            table.option(
                "--codes FOLDER", &given->codes,
                "Folder with images and expected.csv (file, symbology, text): codes and printed numbers");
            table.flag("--drawn-codes", given->drawn_codes,
                       "Measure the reading of codes that zint draws, distorted in thirteen ways");
            table.flag("--service", given->service,
                       "Send the images of the catalogue (and the codes) to a visual-search server");
            table.flag("--shapes", given->shapes, "Measure shape classes, trained on simulated clusters");
            table.flag(
                "--household", given->household,
                "Measure the names that the shipped classifier gives to rendered and labelled objects");
            table.option("--model-out FILE", &given->model_out,
                         "Write the classifier that --household-train made", {.replaces = true});
            table.option(
                "--images FOLDER", &given->images,
                "Folder with labels.csv: image experts are trained on some images and tested on the others");
            table.option("--templates RECORDING", &given->templates,
                         "Labelled recording: templates of every other image are detected in the others");
            table.flag("--primitives", given->primitives,
                       "Measure primitive shapes in the simulated test scenes");
            table.positional("[RECORDING...]", &given->folders,
                             "Recordings with FRAME_label.png and scenes.csv (category: boxes, cylindric "
                             "objects) for the classes of shape, too");
            table.options(table_of(given->products), "Products");
            table.options(table_of(given->shape_options), "Shapes");
            table.options(table_of(given->household_options), "Names");
            table.options(table_of(given->image_options), "Images");
            table.options(table_of(given->recognition), "Recognition");
            return [given](Session& session) { run(*given, session); };
          }};
}

}  // namespace loci::apps
