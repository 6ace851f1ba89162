#include <fmt/format.h>

#include <filesystem>

#include "apps/perceive/commands.h"
#include "mapping/base/json.h"
#include "mapping/base/stopwatch.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/product_index.h"

namespace loci::apps {
namespace {

struct IndexArguments {
  std::string catalogue, out;
};

struct RecogniseArguments {
  std::vector<std::string> images;
  std::string index;
  size_t most = 5;
  perception::RecognitionOptions options;
};

perception::ProductIndex build_index(const std::string& catalogue, Session& session) {
  return perception::ProductIndex::build(perception::read_catalogue(catalogue), session.flags().threads,
                                         session.progress(), session.warnings());
}

perception::ProductIndex open_index(const std::string& path, Session& session) {
  return std::filesystem::is_directory(path) ? build_index(path, session)
                                             : perception::ProductIndex::load(path);
}

void make_index(const IndexArguments& given, Session& session) {
  const perception::ProductIndex index = build_index(given.catalogue, session);
  index.save(given.out);
  session.answer(fmt::format("{} images, {} features, {} words in {}\n", index.products().size(),
                             index.features(), index.words(), given.out),
                 {{"images", index.products().size()},
                  {"features", index.features()},
                  {"words", index.words()},
                  {"out", given.out}});
}

Json to_json(const perception::ProductMatch& match, const perception::Product& product) {
  Json properties = Json::object();
  for (const auto& [key, value] : product.properties) properties[key] = value;
  const cv::Rect& region = match.region;
  return {{"name", product.name},
          {"verified", match.verified},
          {"inliers", match.inliers},
          {"score", match.score},
          {"share", match.share},
          {"presence", match.presence},
          {"region", {region.x, region.y, region.width, region.height}},
          {"properties", properties}};
}

void recognise(RecogniseArguments& given, Session& session) {
  table_of(given.options).validate();
  const perception::ProductIndex index = open_index(given.index, session);
  std::string text;
  Json answers = Json::array();
  for (const std::string& path : given.images) {
    const cv::Mat image = mapping::read_color(path);
    const Stopwatch watch;
    const std::vector<perception::ProductMatch> matches =
        index.recognise(image, given.options, session.flags().threads, given.most);
    session.timing(path, watch.seconds());
    Json products = Json::array();
    text += path + (matches.empty() || !matches[0].verified ? ": nothing sure\n" : "\n");
    for (const perception::ProductMatch& match : matches) {
      const perception::Product& product = index.products()[match.product];
      text +=
          fmt::format("  {:40} {:3} features agree{}\n", product.name, match.inliers,
                      match.verified ? fmt::format(", confidence {:.2f}", match.confidence()) : ": not sure");
      products.push_back(to_json(match, product));
    }
    answers.push_back({{"image", path}, {"products", products}});
  }
  session.answer(text, answers);
}

}  // namespace

Command index_command() {
  return {"index",
          "Makes an index of products from a folder of images and descriptions",
          {"loci-perceive index tests/data/products -o demo-output/products.index",
           "loci-perceive index tests/data/products -o demo-output/products.index --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<IndexArguments>();
            table.positional("CATALOGUE", &given->catalogue,
                             "Folder with catalogue.csv, saved web pages, or images named after products");
            table.option("-o,--output", &given->out, "The index", {.required = true});
            return [given](Session& session) { make_index(*given, session); };
          }};
}

Command recognise_command() {
  return {"recognise",
          "Which products of an index images show",
          {"loci-perceive recognise tests/data/images/Alpro-Blueberry-Soyghurt_001.jpg --index "
           "tests/data/products",
           "loci-perceive recognise tests/data/images/Alpro-Blueberry-Soyghurt_001.jpg --index "
           "tests/data/products --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<RecogniseArguments>();
            table.positional("IMAGE...", &given->images, "Images (PNG, JPEG)");
            table.option("--index", &given->index, "Made by `loci-perceive index`, or a catalogue's folder",
                         {.required = true});
            table.option("--most", &given->most, "So many products of each image");
            table.options(table_of(given->options));
            return [given](Session& session) { recognise(*given, session); };
          }};
}

}  // namespace loci::apps
