#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>

#include "apps/perceive/commands.h"
#include "mapping/base/json.h"
#include "mapping/image/image_io.h"
#include "perception/search/search_client.h"
#include "perception/search/search_server.h"

namespace loci::apps {
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

perception::ProductIndex open_index(const std::string& path, Session& session) {
  if (!std::filesystem::is_directory(path)) return perception::ProductIndex::load(path);
  return perception::ProductIndex::build(perception::read_catalogue(path), session.flags().threads,
                                         session.progress(), session.warnings());
}

void serve(ServeArguments& given, Session& session) {
  table_of(given.service).validate();
  table_of(given.server).validate();
  const perception::SearchService service(open_index(given.index, session), given.service);
  session.show_warnings();
  const bool quiet = session.flags().quiet;
  const perception::SearchServer server(service, given.server, session.flags().threads,
                                        [&](const std::string& line) {
                                          if (!quiet) fmt::print(stderr, "{}\n", line);
                                        });
  session.answer(fmt::format("{} images, answering at {} (Ctrl-C stops)\n", service.images(), server.url()),
                 {{"images", service.images()}, {"url", server.url()}, {"port", server.port()}});
  std::fflush(stdout);
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

Json region_json(const cv::Rect& region) {
  return {region.x, region.y, region.width, region.height};
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
      "Answers visual searches over HTTP: products, logos, text and codes, from an index and experts",
      {"timeout --preserve-status -s INT 3 loci-perceive serve --index tests/data/products --port 0",
       "timeout --preserve-status -s INT 3 loci-perceive serve --index tests/data/products --port 0 --json"},
      [](ArgumentTable& table) {
        auto given = std::make_shared<ServeArguments>();
        table.option("--index", &given->index, "Made by `loci-perceive index`, or a catalogue's folder",
                     {.required = true});
        table.options(table_of(given->server));
        table.options(table_of(given->service));
        return [given](Session& session) { serve(*given, session); };
      }};
}

Command search_command() {
  return {"search",
          "What a visual-search server says about images",
          {"loci-perceive search tests/data/images/Alpro-Blueberry-Soyghurt_001.jpg --index "
           "tests/data/products",
           "loci-perceive search tests/data/images/ean13.png --index tests/data/products --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<SearchArguments>();
            table.positional("IMAGE...", &given->images, "Images (PNG, JPEG)");
            table.option("--index", &given->index,
                         "Ask a server of this command's own, at a free port of this machine, instead");
            table.options(table_of(given->options));
            return [given](Session& session) { search(*given, session); };
          }};
}

}  // namespace loci::apps
