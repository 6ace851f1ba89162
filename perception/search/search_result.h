#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "perception/recognition/product_catalogue.h"
#include "perception/recognition/text_reader.h"

namespace loci::perception {

/// Kinds of results of a visual search (§5.4.1).
enum class SearchCategory {
  kProduct,
  kText,
  kBook,
  kLogo,
  kLandmark,
  kSimilarImage,
  kBarcode,
  kUserSubmitted,
  kOther,
};

/// "Product", "Text", "Book", "Logo", "Landmark", "Similar Image", "Barcode", "User Submitted Result",
/// "Other".
const std::string& name_of(SearchCategory category);

struct SearchWord {
  std::string text;
  cv::Rect region;                   ///< pixels of the image that was sent
  std::vector<cv::Rect> characters;  ///< of its characters, where the server tells
};

struct SearchResult {
  SearchCategory category = SearchCategory::kOther;
  /// As the server words it ("EAN-13 Barcode"): a subtitle of the title, at times the name of a web site.
  std::string category_text;
  std::string title;     ///< product, brand, number of the barcode, what is read
  cv::Rect region;       ///< pixels of the image that was sent; empty = not told
  std::string language;  ///< "en"
  std::string text;      ///< further text
  std::string description;
  std::string preview_url;                                 ///< an image of the result
  std::vector<std::pair<std::string, std::string>> links;  ///< name and address
  /// What else the category brings: manufacturer, price, store, category; authors, publisher, year, isbn;
  /// location; uploader, uploader_url, image_url, comment; and what the server adds.
  Properties properties;
  std::vector<SearchWord> words;
  std::vector<std::string> translations;

  /// "" when there is none.
  std::string property(const std::string& key) const;
};

struct SearchAnswer {
  std::vector<SearchResult> results;
  /// What the answer holds and the protocol does not name (§5.4.2): "info[0].ui_info.99: varint 7".
  std::vector<std::string> unknown;
};

/// The words that describe what was searched for (§5.4.5): those that the titles, texts, descriptions,
/// properties, translations and links of the whole answer hold most often. Words that belong to the service
/// ("translate", "similar") do not count.
std::vector<RankedWord> terms_of(const SearchAnswer& answer, size_t most = 5);

}  // namespace loci::perception
