#include "perception/search/search_server.h"

#include <fmt/format.h>
#include <algorithm>
#include <future>
#include <mutex>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/text.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/barcode_reader.h"
#include "perception/search/protocol.h"

namespace loci::perception {
namespace {

using mapping::HttpReply;
using mapping::HttpRequest;
using mapping::HttpServer;

constexpr size_t kCandidates = 10;

std::string property_of(const Product& product, const std::string& key) {
  for (const auto& [name, value] : product.properties)
    if (name == key) return value;
  return {};
}

SearchCategory category_of(const Product& product) {
  const std::string kind = lower_case(property_of(product, "kind"));
  if (kind == "logo") return SearchCategory::kLogo;
  if (kind == "landmark") return SearchCategory::kLandmark;
  if (kind == "user submitted" || !property_of(product, "uploader").empty())
    return SearchCategory::kUserSubmitted;
  if (kind == "book" || !property_of(product, "isbn").empty() || !property_of(product, "authors").empty())
    return SearchCategory::kBook;
  return SearchCategory::kProduct;
}

/// Digits alone: ISBN are printed with dashes.
std::string digits_of(const std::string& text) {
  std::string digits;
  for (const char c : text)
    if (c >= '0' && c <= '9') digits += c;
  return digits;
}

/// UPC-A is an EAN-13 with a leading zero.
bool same_code(const std::string& a, const std::string& b) {
  const auto without_zeros = [](const std::string& code) {
    return code.substr(std::min(code.find_first_not_of('0'), code.size()));
  };
  return !a.empty() && !b.empty() && without_zeros(a) == without_zeros(b);
}

bool is_isbn(const Barcode& code) {
  return code.symbology == "EAN-13" && (code.code.starts_with("978") || code.code.starts_with("979"));
}

/// The words of a name: "God-Morgon-Orange-Juice".
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (c != '-' && c != '_' && c != ' ')
      words.back() += c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::string joined(const std::vector<std::string>& words, size_t count) {
  std::string text;
  for (size_t i = 0; i < count; ++i) text += (i == 0 ? "" : " ") + words[i];
  return text;
}

/// Tesseract reads edges and patterns as signs.
bool is_word(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                  (static_cast<unsigned char>(c) & 0xC0) == 0xC0;
         }) >= 2;
}

void set_confidence(SearchResult& result, double confidence) {
  result.properties.emplace_back("confidence", fmt::format("{:.3f}", confidence));
}

constexpr const char* kContentType = "application/x-protobuf";
constexpr const char* kWelcome =
    "This is a visual-search server of loci. POST a request of the protocol (application/x-protobuf) here:\n"
    "  loci-perceive search IMAGE --server URL\n";

/// What the client did wrong.
class BadRequest : public Error {
 public:
  using Error::Error;
};

cv::Mat image_of(const std::string& jpeg, double max_megapixels) {
  if (jpeg.empty()) throw BadRequest("the request holds no image");
  if (!jpeg.starts_with("\xff\xd8\xff")) throw BadRequest("the image is no JPEG");
  try {
    return mapping::decode_color(jpeg, "the image", static_cast<uint64_t>(1e6 * max_megapixels));
  } catch (const Error& error) {
    throw BadRequest(error.what());
  }
}

HttpReply refusal(int status, const std::string& why) {
  return {status, why + "\n"};
}

/// Whether a path lies in a folder, links resolved.
bool lies_below(const std::filesystem::path& path, const std::filesystem::path& folder) {
  std::error_code code;
  const auto whole = std::filesystem::canonical(path, code);
  if (code) return false;
  const auto parent = std::filesystem::canonical(folder, code);
  if (code) return false;
  const auto relative = whole.lexically_relative(parent);
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

void ServiceOptions::declare(OptionTable& table) {
  recognition.declare(table);
  table.text("language", language, "Of printed text, as Tesseract names it.");
  table.number("min_confidence", min_confidence, "", "Minimum confidence of a word.", 0, 1);
  table.flag("text", text, "Read printed text.");
  table.flag("thorough", thorough, "Look for barcodes in changed images, too.");
  table.integer("similar", similar, "", "Most similar images of an answer.", 0, 9);
}

SearchService::SearchService(ProductIndex index, const ServiceOptions& options)
    : index_(std::move(index)), options_(options) {
  if (options.text) reader_.emplace(options.language);
}

std::vector<SearchResult> SearchService::look(const cv::Mat& image, int threads,
                                              const std::string& images) const {
  // Reading takes as long as everything else.
  auto reading =
      std::async(threads == 1 ? std::launch::deferred : std::launch::async, [&] { return read_text(image); });
  std::vector<SearchResult> results = look_for_products(image, threads, images);
  for (SearchResult& result : look_for_codes(image, images)) results.push_back(std::move(result));
  if (auto text = reading.get()) results.push_back(std::move(*text));
  return results;
}

SearchResult SearchService::result_of(size_t number, const std::string& images) const {
  const Product& product = index_.products()[number];
  SearchResult result;
  result.category = category_of(product);
  result.title = product.name;
  for (const auto& [key, value] : product.properties) {
    if (key == "description")
      result.description = value;
    else if (key != "kind" && key != "confidence")
      result.properties.emplace_back(key, value);
  }
  if (!images.empty()) result.preview_url = images + std::to_string(number);
  return result;
}

std::vector<SearchResult> SearchService::look_for_products(const cv::Mat& image, int threads,
                                                           const std::string& images) const {
  std::vector<ProductMatch> matches = index_.recognise(image, options_.recognition, threads, kCandidates);
  std::erase_if(matches, [](const ProductMatch& match) { return !match.verified; });
  std::vector<SearchResult> results;
  for (size_t i = 0; i < matches.size() && i <= static_cast<size_t>(options_.similar); ++i) {
    SearchResult result = result_of(matches[i].product, images);
    if (i > 0) result.category = SearchCategory::kSimilarImage;
    result.region = matches[i].region;
    set_confidence(result, matches[i].confidence());
    results.push_back(std::move(result));
  }
  if (auto logo = logo_of(matches)) results.push_back(std::move(*logo));
  return results;
}

std::optional<SearchResult> SearchService::logo_of(const std::vector<ProductMatch>& believed) const {
  if (believed.empty()) return {};
  const auto product = [&](size_t i) -> const Product& { return index_.products()[believed[i].product]; };
  std::string brand = property_of(product(0), "brand");
  const std::vector<std::string> words = words_of(product(0).name);
  SearchResult logo;
  logo.category = SearchCategory::kLogo;
  logo.region = believed[0].region;
  double share = believed[0].share;
  size_t common = 0;
  for (size_t i = 1; i < believed.size(); ++i) {
    const std::vector<std::string> others = words_of(product(i).name);
    const auto [end, other_end] = std::mismatch(words.begin(), words.end(), others.begin(), others.end());
    const auto alike = static_cast<size_t>(end - words.begin());
    const bool same = brand.empty() ? alike > 0 : property_of(product(i), "brand") == brand;
    if (!same) continue;
    if (brand.empty()) common = common == 0 ? alike : std::min(common, alike);
    share += believed[i].share;
    const cv::Rect both = logo.region & believed[i].region;
    if (!both.empty()) logo.region = both;
  }
  logo.title = brand.empty() ? joined(words, common) : brand;
  if (logo.title.empty()) return {};
  set_confidence(logo, believed[0].presence * std::min(1.0, share));
  return logo;
}

std::vector<SearchResult> SearchService::look_for_codes(const cv::Mat& image,
                                                        const std::string& images) const {
  std::vector<SearchResult> results;
  for (const Barcode& code : read_barcodes(image, options_.thorough)) {
    SearchResult result;
    result.category = SearchCategory::kBarcode;
    result.category_text = code.symbology + (code.symbology == "QR" ? " Code" : " Barcode");
    result.title = code.code;
    result.region = code.region;
    results.push_back(result);
    const size_t before = results.size();
    for (size_t i = 0; i < index_.products().size(); ++i) {
      const Product& product = index_.products()[i];
      if (!same_code(property_of(product, "barcode"), code.code) &&
          !(is_isbn(code) && same_code(digits_of(property_of(product, "isbn")), code.code)))
        continue;
      results.push_back(result_of(i, images));
      results.back().region = code.region;
      break;
    }
    if (!is_isbn(code) || results.size() > before) continue;
    result.category = SearchCategory::kBook;
    result.category_text.clear();
    result.title = "ISBN " + code.code;
    result.properties.emplace_back("isbn", code.code);
    results.push_back(result);
  }
  return results;
}

std::optional<SearchResult> SearchService::read_text(const cv::Mat& image) const {
  if (!reader_) return {};
  std::vector<TextWord> words;
  {
    const std::lock_guard lock(reading_);
    // People hold what they ask for upright, and are waiting.
    words = reader_->read(image, options_.min_confidence, TextOrientation::upright);
  }
  std::erase_if(words, [](const TextWord& word) { return !is_word(word.text); });
  if (words.empty()) return {};
  SearchResult result;
  result.category = SearchCategory::kText;
  double confidence = 0;
  for (const TextWord& word : words) {
    // Two looks at the image read most words twice; told is the first.
    const bool known = std::any_of(result.words.begin(), result.words.end(), [&](const SearchWord& other) {
      return other.text == word.text && !(other.region & word.region).empty();
    });
    if (known) continue;
    result.words.push_back({word.text, word.region, {}});
    result.title += (result.title.empty() ? "" : " ") + word.text;
    result.region = result.region.empty() ? word.region : result.region | word.region;
    confidence += word.confidence;
  }
  result.text = result.title;
  set_confidence(result, confidence / static_cast<double>(words.size()));
  return result;
}

void ServerOptions::declare(OptionTable& table) {
  table.text("address", address, "Of this machine; 127.0.0.1 is reached from this machine alone.");
  table.integer("port", port, "", "0 = any that is free.", 0, 65535);
  limits.declare(table);
  table.number("max_megapixels", max_megapixels, "MP", "Larger images are refused.", 0.01, 134);
  table.text("images", images, "Folder of the catalogue's images; those outside are not served.");
}

struct SearchServer::Running {
  const SearchService& service;
  ServerOptions options;
  int threads = 0;
  Log log;
  std::mutex logging;
  std::optional<HttpServer> server;  ///< last: it stops before the others go

  Running(const SearchService& its_service, const ServerOptions& its_options, int its_threads, Log its_log)
      : service(its_service), options(its_options), threads(its_threads), log(std::move(its_log)) {
    server.emplace(options.address, options.port, options.limits,
                   [this](const HttpRequest& request) { return answer(request); });
  }

  void say(const std::string& line) {
    if (!log) return;
    const std::lock_guard lock(logging);
    log(line);
  }

  HttpReply answer(const HttpRequest& request) {
    constexpr std::string_view kImage = "/image/";
    if (request.path == "/" && request.method == "POST") return search(request);
    if (request.method != "GET") return refusal(404, "there is nothing here; requests are POSTed to /");
    if (request.path == "/") return {200, kWelcome};
    const std::string number = request.path.substr(std::min(kImage.size(), request.path.size()));
    const bool digits = !number.empty() && number.size() < 10 && std::ranges::all_of(number, is_digit);
    if (request.path.starts_with(kImage) && digits) return image(std::stoul(number));
    return refusal(404, "there is nothing here; requests are POSTed to /");
  }

  HttpReply search(const HttpRequest& request) {
    const Stopwatch watch;
    try {
      const std::string url = request.host.empty() ? server->url() : "http://" + request.host;
      SearchRequest asked;
      try {
        asked = decode_request(request.body);
      } catch (const Error& error) {
        throw BadRequest(error.what());
      }
      const cv::Mat image = image_of(asked.jpeg, options.max_megapixels);
      const std::vector<SearchResult> results = service.look(image, threads, url + "/image/");
      say(fmt::format("{}: {} x {} pixels, {} results, {:.2f} s", request.client, image.cols, image.rows,
                      results.size(), watch.seconds()));
      return {200, encode(results, asked.details), kContentType};
    } catch (const BadRequest& error) {
      say(fmt::format("{}: refused: {}", request.client, error.what()));
      return refusal(400, error.what());
    }
  }

  /// An index may come from others: it does not choose which files of this machine are shown.
  HttpReply image(size_t number) const {
    if (number >= service.images()) return refusal(404, "there is no such image");
    const std::filesystem::path& path = service.image(number);
    if (options.images.empty() || !lies_below(path, options.images))
      return refusal(404, "the image is not below the folder of images");
    try {
      mapping::read_image_header(path);
      return {200, read_file(path), path.extension() == ".png" ? "image/png" : "image/jpeg"};
    } catch (const Error&) {
      return refusal(404, "the image is not where it was when the index was made");
    }
  }
};

SearchServer::SearchServer(const SearchService& service, const ServerOptions& options, int threads, Log log)
    : running_(std::make_unique<Running>(service, options, threads, std::move(log))) {}

SearchServer::~SearchServer() = default;

int SearchServer::port() const {
  return running_->server->port();
}

std::string SearchServer::url() const {
  return running_->server->url();
}

}  // namespace loci::perception
