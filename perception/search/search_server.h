#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "mapping/http/http_server.h"
#include "perception/recognition/product_index.h"
#include "perception/recognition/text_reader.h"
#include "perception/search/search_result.h"

namespace loci::perception {

struct ServiceOptions {
  RecognitionOptions recognition;
  std::string language = "eng";
  double min_confidence = 0.6;
  bool text = true;
  bool thorough = true;
  int similar = 3;

  void declare(OptionTable& table);
};

/// Answers visual searches from the local experts: products of an index, printed words, barcodes. Any number
/// of threads may ask.
///
/// What an entry of the index is follows from its property `kind` ("book", "logo", "landmark", "user
/// submitted"); entries with isbn or authors are books, others products. A Product (…) result is given for
/// the best image that is believed, a Similar Image for the next ones. A Logo, besides entries that are
/// one, is the brand that a believed product has (`brand`), or what the names of several believed products
/// begin with. A Text has all words with their places, a Barcode its number; a product or book with that
/// `barcode` or `isbn` follows.
///
/// Results have a property `confidence` (0 to 1).
class SearchService {
 public:
  SearchService(ProductIndex index, const ServiceOptions& options);

  /// For an image (CV_8UC3). `threads` = 0: all cores. `images` is the address below which the images of
  /// the index are found by their numbers ("http://127.0.0.1:8600/image/").
  std::vector<SearchResult> look(const cv::Mat& image, int threads, const std::string& images = {}) const;

  size_t images() const { return index_.products().size(); }
  const std::filesystem::path& image(size_t number) const { return index_.products()[number].image; }

 private:
  SearchResult result_of(size_t product, const std::string& images) const;
  std::vector<SearchResult> look_for_products(const cv::Mat& image, int threads,
                                              const std::string& images) const;
  std::optional<SearchResult> logo_of(const std::vector<ProductMatch>& believed) const;
  std::vector<SearchResult> look_for_codes(const cv::Mat& image, const std::string& images) const;
  std::optional<SearchResult> read_text(const cv::Mat& image) const;

  ProductIndex index_;
  ServiceOptions options_;
  mutable std::mutex reading_;  ///< Tesseract reads one image at a time
  std::optional<TextReader> reader_;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 8600;
  mapping::HttpLimits limits = {};
  double max_megapixels = 50;
  std::string images = {};

  void declare(OptionTable& table);
};

/// Answers the visual-search protocol over HTTP: requests are POSTed to "/", images of the index are at
/// "/image/NUMBER", if they lie below ServerOptions::images. It answers 400 to what is no request with a
/// JPEG, 401 (no token), 403 (web pages), 404, 413 (too large), 415 (compressed), 500, 503 (too slow), each
/// with a line of text that says why.
class SearchServer {
 public:
  /// A line for each request.
  using Log = std::function<void(const std::string& line)>;

  /// Listens, at any free port when it is 0, and answers on threads of its own. Error when the port is taken,
  /// the address is not this machine's, or can be reached from other machines and there is no token.
  /// `service` stays with the caller.
  SearchServer(const SearchService& service, const ServerOptions& options, int threads, Log log = {});
  /// Answers what was begun, then stops.
  ~SearchServer();

  int port() const;
  /// "http://127.0.0.1:8600"
  std::string url() const;

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

}  // namespace loci::perception
