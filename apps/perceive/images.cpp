// Single images: read, index, recognise, search, serve.

#include <fmt/format.h>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>

#include "apps/perceive/commands.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/barcode_reader.h"
#include "perception/recognition/product_index.h"
#include "perception/recognition/text_reader.h"
#include "perception/search/search_client.h"
#include "perception/search/search_server.h"

namespace loci::apps {

namespace {

constexpr const char* kIndexDescription = "Index made by `loci-perceive index`, or folder of a catalogue";

struct ReadArguments {
  std::vector<std::string> images;
  std::string language = "eng";
  double min_confidence = 0.5;
  bool no_text = false;
};

Json region_json(const cv::Rect& region) {
  return {region.x, region.y, region.width, region.height};
}

void read(const ReadArguments& given, Session& session) {
  std::optional<perception::TextReader> reader;
  if (!given.no_text) reader.emplace(given.language);
  std::string text;
  Json answers = Json::array();
  for (const std::string& path : given.images) {
    const cv::Mat image = mapping::read_color(path);
    const Stopwatch watch;
    Json codes = Json::array(), words = Json::array(), terms = Json::array();
    text += path + "\n";
    for (const perception::Barcode& code : perception::read_barcodes(image)) {
      text += fmt::format("  {} {}{}\n", code.symbology, code.code,
                          code.preparation.empty() ? "" : " (image " + code.preparation + ")");
      codes.push_back({{"symbology", code.symbology},
                       {"code", code.code},
                       {"preparation", code.preparation},
                       {"region", region_json(code.region)}});
    }
    const std::vector<perception::TextWord> found =
        reader ? reader->read(image, given.min_confidence) : std::vector<perception::TextWord>();
    for (const perception::TextWord& word : found)
      words.push_back(
          {{"text", word.text}, {"confidence", word.confidence}, {"region", region_json(word.region)}});
    for (const perception::RankedWord& word : rank_words(found)) {
      text += fmt::format("  {} {}\n", word.count, word.word);
      terms.push_back({{"word", word.word}, {"count", word.count}, {"confidence", word.confidence}});
    }
    session.timing(path, watch.seconds());
    answers.push_back({{"image", path}, {"barcodes", codes}, {"terms", terms}, {"words", words}});
  }
  session.answer(text, answers);
}

}  // namespace

Command read_command() {
  return {"read",
          "Read barcodes, QR codes and printed words in images",
          {"loci-perceive read tests/data/images/ean13.png",
           "loci-perceive read tests/data/images/ean13.png tests/data/products/Oatly-Oat-Milk.jpg --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<ReadArguments>();
            table.positional("IMAGE...", &given->images, "Images (PNG, JPEG)");
            table.option("--language CODE", &given->language, "Language of the text, as named by Tesseract");
            table.option("--min-confidence NUMBER", &given->min_confidence, "Minimum confidence of a word",
                         {.min = 0.0, .max = 1.0});
            table.flag("--no-text", given->no_text, "Read codes only");
            return [given](Session& session) { read(*given, session); };
          }};
}

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
  return {{"name", product.name},
          {"verified", match.verified},
          {"inliers", match.inliers},
          {"score", match.score},
          {"share", match.share},
          {"presence", match.presence},
          {"region", region_json(match.region)},
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
          "Build an index of products from images and descriptions",
          {"loci-perceive index tests/data/products -o demo-output/products.index",
           "loci-perceive index tests/data/products -o demo-output/products.index --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<IndexArguments>();
            table.positional("CATALOGUE", &given->catalogue,
                             "Folder with catalogue.csv, saved web pages, or images named after products");
            table.output("FILE", &given->out, "The index", {.replaces = true});
            return [given](Session& session) { make_index(*given, session); };
          }};
}

Command recognise_command() {
  return {"recognise",
          "Recognise the products in images",
          {"loci-perceive recognise tests/data/images/Alpro-Blueberry-Soyghurt_001.jpg --index "
           "tests/data/products",
           "loci-perceive recognise tests/data/images/Alpro-Blueberry-Soyghurt_001.jpg --index "
           "tests/data/products --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<RecogniseArguments>();
            table.positional("IMAGE...", &given->images, "Images (PNG, JPEG)");
            table.option("--index PATH", &given->index, kIndexDescription, {.required = true});
            table.option("--max-products N", &given->most, "Maximum number of products per image");
            table.options(table_of(given->options), "Recognition");
            return [given](Session& session) { recognise(*given, session); };
          }};
}

namespace {

struct ServeArguments {
  std::string index;
  perception::ServiceOptions service;
  perception::ServerOptions server;
};

struct SearchArguments {
  std::vector<std::string> images;
  std::string index;
  perception::SearchOptions options;
};

/// The images of a catalogue lie in its folder, those of an index below the folder that it lies in.
std::string images_folder(const std::filesystem::path& index) {
  if (std::filesystem::is_directory(index)) return index.string();
  return index.has_parent_path() ? index.parent_path().string() : ".";
}

void serve(ServeArguments& given, Session& session) {
  table_of(given.service).validate();
  table_of(given.server).validate();
  const perception::SearchService service(open_index(given.index, session), given.service);
  session.show_warnings();
  if (given.server.images.empty()) given.server.images = images_folder(given.index);
  const perception::SearchServer server(service, given.server, session.flags().threads,
                                        [&](const std::string& line) { session.log(line); });
  session.answer(fmt::format("{} images, answering at {} (Ctrl-C stops)\n", service.images(), server.url()),
                 {{"images", service.images()}, {"url", server.url()}, {"port", server.port()}});
  std::fflush(stdout);
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

Json to_json(const perception::SearchResult& result) {
  Json json = {{"category", name_of(result.category)},
               {"category_text", result.category_text},
               {"title", result.title},
               {"language", result.language},
               {"text", result.text},
               {"description", result.description},
               {"preview_url", result.preview_url},
               {"translations", result.translations}};
  json["region"] = result.region.empty() ? Json() : region_json(result.region);
  json["links"] = Json::array();
  for (const auto& [name, url] : result.links) json["links"].push_back({{"name", name}, {"url", url}});
  json["properties"] = Json::object();
  for (const auto& [key, value] : result.properties) json["properties"][key] = value;
  json["words"] = Json::array();
  for (const perception::SearchWord& word : result.words)
    json["words"].push_back({{"text", word.text}, {"region", region_json(word.region)}});
  return json;
}

/// A server of our own at a free port of this machine, while the command runs.
struct OwnServer {
  perception::SearchService service;
  perception::SearchServer server;
  OwnServer(perception::ProductIndex index, int threads)
      : service(std::move(index), {}), server(service, {"127.0.0.1", 0}, threads) {}
};

void search(SearchArguments& given, Session& session) {
  table_of(given.options).validate();
  std::optional<OwnServer> own;
  if (!given.index.empty()) {
    own.emplace(open_index(given.index, session), session.flags().threads);
    given.options.server = own->server.url();
  }
  perception::SearchClient client(given.options);
  std::string text;
  Json answers = Json::array();
  for (const std::string& path : given.images) {
    const perception::SearchClient::Outcome outcome = client.search(mapping::read_color(path));
    session.timing(path, outcome.seconds);
    Json results = Json::array(), terms = Json::array();
    text += path + (outcome.answer.results.empty() ? ": no results\n"
                    : outcome.remembered           ? " (as before)\n"
                                                   : "\n");
    for (const perception::SearchResult& result : outcome.answer.results) {
      text += fmt::format("  {:22} {}\n", name_of(result.category), result.title);
      results.push_back(to_json(result));
    }
    for (const perception::RankedWord& word : terms_of(outcome.answer)) {
      text += fmt::format("  {:4} {}\n", word.count, word.word);
      terms.push_back({{"word", word.word}, {"count", word.count}});
    }
    for (const std::string& unknown : outcome.answer.unknown)
      session.warnings().add("the protocol does not name " + unknown);
    answers.push_back({{"image", path},
                       {"seconds", outcome.seconds},
                       {"attempts", outcome.attempts},
                       {"remembered", outcome.remembered},
                       {"results", results},
                       {"terms", terms},
                       {"unknown", outcome.answer.unknown}});
  }
  session.answer(text, answers);
}

}  // namespace

Command serve_command() {
  return {
      "serve",
      "Serve visual search over HTTP: products, logos, text and codes",
      {"timeout --preserve-status -s INT 3 loci-perceive serve --index tests/data/products --port 0",
       "timeout --preserve-status -s INT 3 loci-perceive serve --index tests/data/products --port 0 --json"},
      [](ArgumentTable& table) {
        auto given = std::make_shared<ServeArguments>();
        table.option("--index PATH", &given->index, kIndexDescription, {.required = true});
        table.options(table_of(given->server), "Server");
        table.options(table_of(given->service), "Search");
        return [given](Session& session) { serve(*given, session); };
      }};
}

Command search_command() {
  return {"search",
          "Send images to a visual-search server",
          {"loci-perceive search tests/data/images/Alpro-Blueberry-Soyghurt_001.jpg --index "
           "tests/data/products",
           "loci-perceive search tests/data/images/ean13.png --index tests/data/products --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<SearchArguments>();
            table.positional("IMAGE...", &given->images, "Images (PNG, JPEG)");
            table.option("--index PATH", &given->index,
                         "Ask a local server over this index instead, started for this command");
            table.options(table_of(given->options), "Client");
            return [given](Session& session) { search(*given, session); };
          }};
}

}  // namespace loci::apps
