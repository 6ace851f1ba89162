#include "apps/evaluate/commands.h"
#include "apps/evaluate/description/products.h"
#include "mapping/base/json.h"

namespace loci {
namespace {

using namespace description_evaluation;

struct Arguments {
  std::string catalogue;
  ProductsOptions products;
  RecognitionOptions recognition;
};

void run(Arguments& given, Session& session) {
  table_of(given.products).validate();
  table_of(given.recognition).validate();
  if (given.catalogue.empty()) throw Error("there is nothing to measure", {}, "give --catalogue DIR");
  std::string text;
  Json json = Json::object();
  if (!given.catalogue.empty()) {
    const ProductsResult result =
        evaluate_products(given.catalogue, given.products, given.recognition, session.flags().threads,
                          session.progress(), session.warnings());
    text += result.text();
    json["products"] = result.to_json();
  }
  session.answer(text, json);
}

}  // namespace

Command description_command() {
  return {"description",
          "Products recognised in pictures, against brute-force SIFT",
          {"loci-evaluate description --catalogue tests/data/products",
           "loci-evaluate description --catalogue tests/data/products --json"},
          [](CLI::App& app) {
            auto given = std::make_shared<Arguments>();
            app.add_option("--catalogue", given->catalogue,
                           "Catalogue of products with labels.csv: pictures and what they show");
            add_options(app, table_of(given->products));
            add_options(app, table_of(given->recognition));
            return [given](Session& session) { run(*given, session); };
          }};
}

}  // namespace loci
