#pragma once

#include <cstdint>
#include <list>
#include <mutex>
#include <string>

#include "mapping/base/error.h"
#include "mapping/base/options.h"
#include "perception/search/search_result.h"

namespace loci::perception {

/// The server could not be reached, did not answer in time, or broke off: trying again may help.
class ServerAway : public Error {
 public:
  using Error::Error;
};

struct HttpAnswer {
  int status = 0;
  std::string body;
};

/// Where requests go: "http://127.0.0.1:8600/path", https as well. Error for what is no such address.
struct HttpAddress {
  std::string server;  ///< "http://127.0.0.1:8600"
  std::string path = "/";

  static HttpAddress parse(const std::string& url);
};

/// Sends `body` and waits for the answer, at most `timeout_s` for all of it, however slowly it drips in.
/// Throws ServerAway, or Error when the answer has more than `max_bytes`.
/// `token` is the server's secret, if it asks for one.
HttpAnswer http_post(const HttpAddress& address, const std::string& body, double timeout_s, size_t max_bytes,
                     const std::string& token = {});

struct SearchOptions {
  std::string server = "http://127.0.0.1:8600";
  double timeout_s = 5;
  int retry = 2;
  double pause_s = 0.2;
  int side_px = 584;
  std::string language = "en", country = "US";
  int alike_bits = 4;
  double alike_color = 8;
  int remembered = 500;
  double max_mb = 16;
  std::string unknown;
  std::string token_file;

  void declare(OptionTable& table);
};

/// Answers by what images look like (§5.4.5): a perceptual hash of few different bits, and like colours.
class SearchCache {
 public:
  SearchCache(int alike_bits, double alike_color, size_t most);
  struct Look {
    uint64_t hash = 0;
    cv::Mat colors;  ///< CV_32FC3, Lab, small
  };
  static Look look_at(const cv::Mat& image);
  /// The answer to the image that is most alike; false when none is alike.
  bool find(const Look& look, SearchAnswer& answer) const;
  /// The oldest ones are forgotten.
  void remember(const Look& look, const SearchAnswer& answer);

 private:
  int alike_bits_;
  double alike_color_;
  size_t most_;
  mutable std::mutex mutex_;
  std::list<std::pair<Look, SearchAnswer>> entries_;  ///< the newest first
};

/// Asks a visual-search server about images (§5.4). Any number of threads may ask at the same time.
class SearchClient {
 public:
  /// Error for an address that is none.
  explicit SearchClient(const SearchOptions& options);

  struct Outcome {
    SearchAnswer answer;      ///< with regions in pixels of the given image, and within it
    bool remembered = false;  ///< from the cache
    int attempts = 0;
    double seconds = 0;
  };
  /// What the server says about an image (CV_8UC3, BGR; sent as JPEG, larger ones made smaller). Tried
  /// again, with longer and longer pauses, when the server is away, busy, or answers what is no response.
  /// Throws ServerAway or Error when it stays so; Error at once when the server refuses.
  Outcome search(const cv::Mat& image);

 private:
  SearchAnswer ask(const cv::Mat& image, int& attempts) const;
  SearchAnswer try_once(const std::string& request) const;
  void keep_unknown(const SearchAnswer& answer, const std::string& bytes) const;

  SearchOptions options_;
  HttpAddress address_;
  std::string token_;
  SearchCache cache_;
};

}  // namespace loci::perception
