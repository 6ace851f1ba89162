#include "perception/search/search_client.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <httplib.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <opencv2/imgproc.hpp>
#include <regex>
#include <thread>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/hash.h"
#include "mapping/http/http_server.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/image_features.h"
#include "perception/search/protocol.h"

namespace loci::perception {
namespace {

using Seconds = std::chrono::duration<double>;
using Clock = std::chrono::steady_clock;

/// Breaks a connection off when its time is up: the library's own limits are for single reads.
class Deadline {
 public:
  Deadline(httplib::Client& client, Seconds limit)
      : end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(limit)),
        thread_([this, &client] { watch(client); }) {}
  ~Deadline() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  bool is_over() const { return Clock::now() >= end_; }

 private:
  void watch(httplib::Client& client) {
    std::unique_lock lock(mutex_);
    if (wake_.wait_until(lock, end_, [this] { return done_; })) return;
    // Again and again: a connection that is still being made cannot be stopped.
    while (!wake_.wait_for(lock, std::chrono::milliseconds(20), [this] { return done_; })) client.stop();
  }

  Clock::time_point end_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::thread thread_;
};

std::string reason_of(httplib::Error error) {
  switch (error) {
    case httplib::Error::Connection:
    case httplib::Error::ConnectionTimeout:
      return "cannot be reached";
    case httplib::Error::SSLConnection:
    case httplib::Error::SSLLoadingCerts:
    case httplib::Error::SSLServerVerification:
      return "cannot be trusted: its certificate is not accepted";
    default:
      return "broke off, or what it answered is no HTTP";
  }
}

constexpr double kBytesPerMegabyte = 1e6;

/// The server cannot do it now, or what it says makes no sense: the next attempt may do better.
class TryAgain : public Error {
 public:
  using Error::Error;
};

/// A line of text from a server, if it is one.
std::string line_of(const std::string& body) {
  const std::string line = body.substr(0, std::min<size_t>(body.find('\n'), 200));
  const bool readable = std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; });
  return readable && !line.empty() ? ": " + line : "";
}

cv::Rect scaled(const cv::Rect& region, double scale_x, double scale_y, const cv::Size& size) {
  if (region.empty()) return {};
  const cv::Point low(cvRound(region.x * scale_x), cvRound(region.y * scale_y));
  const cv::Point high(cvRound(region.br().x * scale_x), cvRound(region.br().y * scale_y));
  return cv::Rect(low, high) & cv::Rect({}, size);
}

void scale_regions(SearchAnswer& answer, double scale_x, double scale_y, const cv::Size& size) {
  for (SearchResult& result : answer.results) {
    result.region = scaled(result.region, scale_x, scale_y, size);
    for (SearchWord& word : result.words) {
      word.region = scaled(word.region, scale_x, scale_y, size);
      for (cv::Rect& character : word.characters) character = scaled(character, scale_x, scale_y, size);
    }
  }
}

}  // namespace

HttpAddress HttpAddress::parse(const std::string& url) {
  static const std::regex form(R"((https?://(?:\[[0-9a-fA-F:.]+\]|[^/?#:\s]+)(?::[0-9]{1,5})?)(/[^#\s]*)?)");
  std::smatch found;
  if (!std::regex_match(url, found, form))
    throw Error("'" + url + "' is no address of a server", {}, "give one like http://127.0.0.1:8600");
  return {found[1], found[2].length() > 0 ? found.str(2) : "/"};
}

HttpAnswer http_post(const HttpAddress& address, const std::string& body, double timeout_s, size_t max_bytes,
                     const std::string& token) {
  httplib::Client client(address.server);
  const Seconds limit(timeout_s);
  client.set_connection_timeout(limit);
  client.set_read_timeout(limit);
  client.set_write_timeout(limit);
  std::string received;
  bool too_large = false;
  httplib::Request request;
  request.method = "POST";
  request.path = address.path;
  request.headers = {{"Content-Type", "application/x-protobuf"}, {"Accept", "application/x-protobuf"}};
  if (!token.empty()) request.headers.emplace("Authorization", "Bearer " + token);
  request.body = body;
  request.content_receiver = [&](const char* data, size_t length, uint64_t, uint64_t) {
    too_large = length > max_bytes - received.size();
    if (!too_large) received.append(data, length);
    return !too_large;
  };
  Deadline deadline(client, limit);
  const httplib::Result result = client.send(request);
  if (too_large) throw Error(fmt::format("{} answered with more than {} bytes", address.server, max_bytes));
  if (result) return {result->status, std::move(received)};
  if (deadline.is_over())
    throw ServerAway(fmt::format("{} did not answer within {} s", address.server, timeout_s));
  throw ServerAway(address.server + " " + reason_of(result.error()));
}

void SearchOptions::declare(OptionTable& table) {
  table.text("server", server, "Address of the server, e.g. of `loci-perceive serve`.");
  table.number("timeout_s", timeout_s, "s", "Time limit of a request.", 0.01, 3600);
  table.integer("retry", retry, "",
                "Number of retries when the server is unreachable, busy or answers invalid data.", 0, 100);
  table.number("pause_s", pause_s, "s", "Wait before the first retry; doubles with each further one.", 0, 60);
  table.integer("side_px", side_px, "px", "Maximum length of the longer side of an image that is sent.", 32,
                10000);
  table.text("language", language, "Language of the results.");
  table.text("country", country, "Country of the results.");
  table.integer("alike_bits", alike_bits, "",
                "Maximum number of different bits (of 64) of the perceptual hashes for a cached result to be "
                "used; -1 = no cache.",
                -1, 64);
  table.number("alike_color", alike_color, "",
               "Maximum mean colour distance for a cached result to be used (CIE Lab).", 0, 200);
  table.integer("remembered", remembered, "", "Number of cached results.", 1, 1000000);
  table.number("max_mb", max_mb, "MB", "Maximum size of an answer.", 0.001, 1000);
  table.text("unknown", unknown,
             "Folder in which answers with unknown fields are stored, with a list of the fields.");
  table.text("token_file", token_file, "File with the secret of the server.");
}

SearchCache::SearchCache(int alike_bits, double alike_color, size_t most)
    : alike_bits_(alike_bits), alike_color_(alike_color), most_(most) {}

SearchCache::Look SearchCache::look_at(const cv::Mat& image) {
  return {perceptual_hash(image), cell_colors(image)};
}

bool SearchCache::find(const Look& look, SearchAnswer& answer) const {
  const std::lock_guard lock(mutex_);
  int best = alike_bits_;
  bool found = false;
  for (const auto& [known, its_answer] : entries_) {
    const int bits = hash_distance(look.hash, known.hash);
    if (bits > best || (found && bits == best)) continue;
    const cv::Scalar difference = cv::mean(cv::abs(look.colors - known.colors));
    if (difference[0] + difference[1] + difference[2] > alike_color_) continue;
    best = bits;
    found = true;
    answer = its_answer;
  }
  return found;
}

void SearchCache::remember(const Look& look, const SearchAnswer& answer) {
  const std::lock_guard lock(mutex_);
  entries_.emplace_front(look, answer);
  if (entries_.size() > most_) entries_.pop_back();
}

SearchClient::SearchClient(const SearchOptions& options)
    : options_(options),
      address_(HttpAddress::parse(options.server)),
      token_(options.token_file.empty() ? "" : mapping::read_token(options.token_file)),
      cache_(options.alike_bits, options.alike_color, static_cast<size_t>(options.remembered)) {}

SearchClient::Outcome SearchClient::search(const cv::Mat& image) {
  if (image.empty() || image.type() != CV_8UC3) throw Error("a visual search is asked for colour images");
  const Stopwatch watch;
  Outcome outcome;
  const SearchCache::Look look = SearchCache::look_at(image);
  // Remembered regions are parts of one, as alike images may differ in size.
  constexpr int kUnit = 1 << 20;
  const cv::Size unit(kUnit, kUnit);
  const double per_column = static_cast<double>(image.cols) / kUnit,
               per_row = static_cast<double>(image.rows) / kUnit;
  outcome.remembered = cache_.find(look, outcome.answer);
  if (outcome.remembered) {
    scale_regions(outcome.answer, per_column, per_row, image.size());
  } else {
    outcome.answer = ask(image, outcome.attempts);
    SearchAnswer relative = outcome.answer;
    scale_regions(relative, 1 / per_column, 1 / per_row, unit);
    cache_.remember(look, relative);
  }
  outcome.seconds = watch.seconds();
  return outcome;
}

SearchAnswer SearchClient::ask(const cv::Mat& image, int& attempts) const {
  cv::Mat sent = image;
  const double scale = static_cast<double>(options_.side_px) / std::max(image.cols, image.rows);
  if (scale < 1)
    cv::resize(image, sent,
               {std::max(1, cvRound(image.cols * scale)), std::max(1, cvRound(image.rows * scale))}, 0, 0,
               cv::INTER_AREA);
  const std::vector<unsigned char> jpeg = mapping::encode_image(sent, ".jpg");
  const std::string request = encode({{jpeg.begin(), jpeg.end()}, options_.language, options_.country, true});
  for (int left = options_.retry;; --left) {
    ++attempts;
    try {
      SearchAnswer answer = try_once(request);
      scale_regions(answer, static_cast<double>(image.cols) / sent.cols,
                    static_cast<double>(image.rows) / sent.rows, image.size());
      return answer;
    } catch (const ServerAway&) {
      if (left <= 0) throw;
    } catch (const TryAgain&) {
      if (left <= 0) throw;
    }
    const double pause_s = std::ldexp(options_.pause_s, options_.retry - left);  // twice as long each time
    std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
  }
}

SearchAnswer SearchClient::try_once(const std::string& request) const {
  const HttpAnswer reply = http_post(address_, request, options_.timeout_s,
                                     static_cast<size_t>(options_.max_mb * kBytesPerMegabyte), token_);
  const std::string says =
      fmt::format("{} answered {}{}", options_.server, reply.status, line_of(reply.body));
  if (reply.status >= 500 || reply.status == 429) throw TryAgain(says);
  if (reply.status != 200) throw Error(says);
  SearchAnswer answer;
  try {
    answer = decode_response(reply.body);
  } catch (const Error& error) {
    throw TryAgain(options_.server + ": " + error.what());
  }
  keep_unknown(answer, reply.body);
  return answer;
}

void SearchClient::keep_unknown(const SearchAnswer& answer, const std::string& bytes) const {
  if (options_.unknown.empty() || answer.unknown.empty()) return;
  make_folder(options_.unknown);
  const std::filesystem::path stem =
      std::filesystem::path(options_.unknown) / content_hash(bytes).substr(0, 16);
  write_file_atomically(stem.string() + ".bin", bytes);
  write_file_atomically(stem.string() + ".txt", fmt::format("{}\n", fmt::join(answer.unknown, "\n")));
}

}  // namespace loci::perception
