#pragma once

#include <cstdint>
#include <list>
#include <mutex>

#include "mapping/base/options.h"
#include "perception/search/http_post.h"
#include "perception/search/search_result.h"

namespace loci::perception {

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
  SearchCache cache_;
};

}  // namespace loci::perception
