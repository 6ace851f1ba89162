#include "perception/search/search_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>

#include "perception/recognition/barcode_reader.h"

namespace loci::perception {
namespace {

constexpr size_t kCandidates = 10;

std::string property_of(const Product& product, const std::string& key) {
  for (const auto& [name, value] : product.properties)
    if (name == key) return value;
  return {};
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

SearchCategory category_of(const Product& product) {
  const std::string kind = lower(property_of(product, "kind"));
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

}  // namespace

void ServiceOptions::declare(OptionTable& table) {
  recognition.declare(table);
  table.text("language", language, "Of printed text, as Tesseract names it.");
  table.number("min_confidence", min_confidence, "", "Words that are less sure are left out.", 0, 1);
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
    words = reader_->read(image, options_.min_confidence);
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

}  // namespace loci::perception
