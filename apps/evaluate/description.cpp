#include "apps/evaluate/commands.h"
#include "apps/evaluate/description/products.h"
#include "apps/evaluate/description/shapes.h"
#include "mapping/base/json.h"

namespace loci {
namespace {

using namespace description_evaluation;

struct Arguments {
  std::string catalogue;
  ProductsOptions products;
  RecognitionOptions recognition;
  bool shapes = false;
  std::vector<std::string> folders;
  ShapesOptions shape_options;
};

void run(Arguments& given, Session& session) {
  table_of(given.products).validate();
  table_of(given.recognition).validate();
  table_of(given.shape_options).validate();
  if (given.catalogue.empty() && !given.shapes)
    throw Error("there is nothing to measure", {}, "give --catalogue DIR or --shapes");
  std::string text;
  Json json = Json::object();
  if (!given.catalogue.empty()) {
    const ProductsResult result =
        evaluate_products(given.catalogue, given.products, given.recognition, session.flags().threads,
                          session.progress(), session.warnings());
    text += result.text();
    json["products"] = result.to_json();
  }
  if (given.shapes) {
    const ShapesResult result = evaluate_shapes(given.folders, given.shape_options, session.flags().threads,
                                                session.progress(), session.warnings());
    text += result.text();
    json["shapes"] = result.to_json();
  }
  session.answer(text, json);
}

}  // namespace

Command description_command() {
  return {
      "description",
      "Classes of shape from simulated clusters; products recognised in pictures, against brute-force SIFT",
      {"loci-evaluate description --catalogue tests/data/products",
       "loci-evaluate description --shapes --train-scenes 10 --test-scenes 3 --folds 2 --json"},
      [](CLI::App& app) {
        auto given = std::make_shared<Arguments>();
        app.add_option("--catalogue", given->catalogue,
                       "Catalogue of products with labels.csv: pictures and what they show");
        app.add_flag("--shapes", given->shapes, "Measures classes of shape, trained on simulated clusters");
        app.add_option("DIRS", given->folders,
                       "Recordings with FRAME_label.png and scenes.csv (category: boxes, cylindric objects) "
                       "for the classes of shape, too");
        add_options(app, table_of(given->products));
        add_options(app, table_of(given->shape_options));
        add_options(app, table_of(given->recognition));
        return [given](Session& session) { run(*given, session); };
      }};
}

}  // namespace loci
