#include "apps/evaluate/description/service.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "apps/evaluate/description/words.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/search/search_client.h"
#include "perception/search/search_server.h"

namespace loci::apps::description_evaluation {
namespace {

namespace fs = std::filesystem;

constexpr size_t kExamples = 6;
const std::array<double, 9> kSteps_s = {0.1, 0.2, 0.3, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2};

struct Asked {
  std::string file;  ///< for people
  fs::path path;
  std::string truth;
  std::set<std::string> relevant;  ///< empty: nobody says what it is called
};

std::vector<Asked> images_of(const fs::path& folder, const std::vector<perception::Product>& catalogue,
                             int every) {
  std::map<std::string, std::set<std::string>> known, visible;
  for (const perception::Product& product : catalogue) {
    std::set<std::string>& words = known[product.name];
    words.merge(folded_words(product.name));
    for (const auto& [key, value] : product.properties)
      if (key == "category" || key == "brand" || key == "manufacturer") words.merge(folded_words(value));
  }
  if (fs::exists(folder / "visible_text.csv")) {
    const CsvTable table = CsvTable::read(folder / "visible_text.csv");
    for (size_t row = 0; row < table.rows(); ++row)
      visible[table.cell(row, table.require_column("file"))] =
          folded_words(table.cell(row, table.require_column("words")));
  }
  const CsvTable labels = CsvTable::read(folder / "labels.csv");
  std::vector<Asked> asked;
  for (size_t row = 0; row < labels.rows(); row += static_cast<size_t>(every)) {
    const std::string& file = labels.cell(row, labels.require_column("file"));
    const std::string& name = labels.cell(row, labels.require_column("class_name"));
    asked.push_back({fs::path(file).stem().string(), folder / file, name, known[name]});
    asked.back().relevant.merge(visible[file]);
  }
  return asked;
}

void add_codes(const fs::path& folder, int every, std::vector<Asked>& asked) {
  const CsvTable table = CsvTable::read(folder / "expected.csv");
  for (size_t row = 0; row < table.rows(); row += static_cast<size_t>(every)) {
    const std::string& file = table.cell(row, table.require_column("file"));
    const std::string& text = table.cell(row, table.require_column("text"));
    asked.push_back({fs::path(file).stem().string(), folder / "images" / file, text, {}});
  }
}

std::string category_of(const perception::SearchResult& result) {
  return result.category == perception::SearchCategory::kBarcode ? result.category_text
                                                                 : name_of(result.category);
}

void count(const Asked& asked, const perception::SearchAnswer& answer, ServiceResult& result) {
  result.results += static_cast<int>(answer.results.size());
  for (const perception::SearchResult& each : answer.results) ++result.categories[category_of(each)];
  if (asked.relevant.empty()) return;
  ++result.named;
  const std::vector<perception::RankedWord> terms = terms_of(answer);
  const auto is_relevant = [&](const perception::RankedWord& term) {
    return asked.relevant.contains(folded(term.word));
  };
  ++result.relevant.at(static_cast<size_t>(std::count_if(terms.begin(), terms.end(), is_relevant)));
  result.first_relevant += !terms.empty() && is_relevant(terms[0]);
  if (terms.size() < 5) return;
  ServiceResult::Example& example = result.examples.emplace_back();
  example.image = asked.file;
  for (const perception::RankedWord& term : terms) example.terms.emplace_back(term.word, term.count);
}

/// A few, from the beginning to the end.
void thin_out(std::vector<ServiceResult::Example>& examples) {
  std::vector<ServiceResult::Example> few;
  for (size_t i = 0; i < std::min(kExamples, examples.size()); ++i)
    few.push_back(examples[i * examples.size() / std::min(kExamples, examples.size())]);
  examples = std::move(few);
}

/// Whether a cache that knows all images before would have sent each.
void try_cache(const std::vector<Asked>& asked, ServiceResult& result) {
  const perception::SearchOptions options;
  perception::SearchCache cache(options.alike_bits, options.alike_color, asked.size());
  for (const Asked& each : asked) {
    const perception::SearchCache::Look look =
        perception::SearchCache::look_at(mapping::read_color(each.path));
    perception::SearchAnswer answer;
    ++result.alike_asked;
    if (cache.find(look, answer)) {
      ++result.alike_remembered;
      result.alike_wrong += answer.results.at(0).title != each.truth;
    }
    perception::SearchResult own;
    own.title = each.truth;
    cache.remember(look, {{own}, {}});
  }
}

}  // namespace

ServiceResult evaluate_service(const fs::path& folder, const fs::path& codes, int every, int threads,
                               Progress& progress, Warnings& warnings) {
  const std::vector<perception::Product> catalogue = perception::read_catalogue(folder);
  std::vector<Asked> asked = images_of(folder, catalogue, every);
  if (!codes.empty()) add_codes(codes, every, asked);
  PartialProgress building(progress, 0, 0.1);
  const perception::SearchService service(
      perception::ProductIndex::build(catalogue, threads, building, warnings), perception::ServiceOptions());
  perception::ServerOptions server_options;
  server_options.port = 0;
  const perception::SearchServer server(service, server_options, threads);
  perception::SearchOptions options;
  options.server = server.url();
  options.timeout_s = 60;
  options.alike_bits = -1;
  perception::SearchClient client(options);
  ServiceResult result;
  for (const Asked& each : asked) {
    progress.check(0.1 + 0.9 * result.images / static_cast<double>(asked.size()), "searches");
    const perception::SearchClient::Outcome outcome = client.search(mapping::read_color(each.path));
    result.seconds.push_back(outcome.seconds);
    count(each, outcome.answer, result);
    ++result.images;
  }
  std::sort(result.seconds.begin(), result.seconds.end());
  thin_out(result.examples);
  try_cache(asked, result);
  return result;
}

std::string ServiceResult::text() const {
  const auto share = [](size_t part, size_t whole) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(std::max<size_t>(1, whole));
  };
  const auto all = static_cast<size_t>(images);
  std::string text = fmt::format("visual search: {} results for {} images, {:.1f} each\n", results, images,
                                 static_cast<double>(results) / std::max(1, images));
  text += "  categories (Table 5.3)\n";
  std::vector<std::pair<std::string, int>> sorted(categories.begin(), categories.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [name, times] : sorted)
    text += fmt::format("    {:24}{:>5}{:>8.1f} %\n", name, times,
                        share(static_cast<size_t>(times), static_cast<size_t>(results)));
  text += "  terms (Table 5.4)\n";
  for (const Example& example : examples) {
    text += "    " + example.image + ":";
    for (const auto& [term, times] : example.terms) text += fmt::format(" {} {}", times, term);
    text += "\n";
  }
  text += "  relevant terms among five (Table 5.5)\n";
  for (size_t i = 0; i < relevant.size(); ++i)
    text += fmt::format("    {}{:>8}{:>8.1f} %\n", i, relevant[i],
                        share(static_cast<size_t>(relevant[i]), static_cast<size_t>(named)));
  text += fmt::format("    the most frequent one is relevant in {} of {}\n", first_relevant, named);
  text += "  time of a request (Table 5.6)\n";
  double before = 0;
  for (const double step : kSteps_s) {
    const auto within = static_cast<size_t>(
        std::count_if(seconds.begin(), seconds.end(), [&](double s) { return s > before && s <= step; }));
    text += fmt::format("    {:.1f} s < t <= {:.1f} s{:>6}{:>8.1f} %\n", before, step, within,
                        share(within, all));
    before = step;
  }
  const auto more = static_cast<size_t>(
      std::count_if(seconds.begin(), seconds.end(), [&](double s) { return s > before; }));
  text += fmt::format("    {:.1f} s < t         {:>6}{:>8.1f} %\n", before, more, share(more, all));
  if (!seconds.empty())
    text += fmt::format(
        "    mean {:.3f} s, from {:.3f} to {:.3f} s\n",
        std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size()),
        seconds.front(), seconds.back());
  return text + fmt::format(
                    "  cache: of {} different images {} are taken for one seen before, {} of these show "
                    "something else\n",
                    alike_asked, alike_remembered, alike_wrong);
}

Json ServiceResult::to_json() const {
  Json json = {{"images", images},
               {"results", results},
               {"categories", categories},
               {"named", named},
               {"relevant", relevant},
               {"first_relevant", first_relevant},
               {"seconds", seconds},
               {"alike", {{"asked", alike_asked}, {"remembered", alike_remembered}, {"wrong", alike_wrong}}}};
  json["examples"] = Json::array();
  for (const Example& example : examples) {
    Json terms = Json::array();
    for (const auto& [term, times] : example.terms) terms.push_back({{"word", term}, {"count", times}});
    json["examples"].push_back({{"image", example.image}, {"terms", terms}});
  }
  return json;
}

}  // namespace loci::apps::description_evaluation
