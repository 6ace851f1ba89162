#include "perception/search/search_result.h"

#include <array>
#include <set>

namespace loci::perception {
namespace {

/// Keys whose values are no words about the object.
bool is_address(const std::string& key) {
  return key.ends_with("_url") || key.ends_with("_site") || key == "confidence" || key == "uploader_image" ||
         key == "product_id";
}

}  // namespace

const std::string& name_of(SearchCategory category) {
  static const std::array<std::string, 9> names = {
      "Product", "Text", "Book", "Logo", "Landmark", "Similar Image", "Barcode", "User Submitted Result",
      "Other"};
  return names.at(static_cast<size_t>(category));
}

std::string SearchResult::property(const std::string& key) const {
  for (const auto& [name, value] : properties)
    if (name == key) return value;
  return {};
}

std::vector<RankedWord> terms_of(const SearchAnswer& answer, size_t most) {
  std::vector<TextWord> texts;
  const auto add = [&](const std::string& text) { texts.push_back({text, 1, {}}); };
  for (const SearchResult& result : answer.results) {
    add(result.title);
    if (result.text != result.title) add(result.text);
    add(result.description);
    for (const auto& [key, value] : result.properties)
      if (!is_address(key)) add(value);
    for (const std::string& translation : result.translations) add(translation);
    for (const auto& [name, url] : result.links) add(name);
    if (result.title.empty() && result.text.empty())
      for (const SearchWord& word : result.words) add(word.text);
  }
  static const std::set<std::string> service = {"translate", "translation", "similar", "image",  "images",
                                                "search",    "google",      "goggles", "report", "abuse",
                                                "store",     "buy",         "isbn"};
  std::vector<RankedWord> words = rank_words(texts, texts.size() * 1000);
  std::erase_if(words, [](const RankedWord& word) {
    std::string name = word.word;
    for (char& c : name)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return service.contains(name);
  });
  if (words.size() > most) words.resize(most);
  return words;
}

}  // namespace loci::perception
