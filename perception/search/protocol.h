#pragma once

#include <string>
#include <string_view>

#include "perception/search/search_result.h"

namespace loci::perception {

/// A request of the visual-search protocol (§5.4.3).
struct SearchRequest {
  std::string jpeg;
  std::string language = "en", country = "US";
  bool details = true;  ///< false: the answer carries titles and categories alone
};

/// Messages of goggles.proto as bytes and back. Reading throws Error for what is no such message.
std::string encode(const SearchRequest& request);
SearchRequest decode_request(std::string_view bytes);
/// `details` as in the request.
std::string encode(const std::vector<SearchResult>& results, bool details = true);
/// Results of the response and of its alternatives. Text that is no UTF-8 is mended. Coordinates are as they
/// came, but within ±2^20.
SearchAnswer decode_response(std::string_view bytes);

}  // namespace loci::perception
