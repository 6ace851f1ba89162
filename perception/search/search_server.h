#pragma once

#include <functional>
#include <memory>
#include <string>

#include "perception/search/search_service.h"

namespace loci::perception {

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 8600;
  double max_mb = 16;
  double max_megapixels = 50;

  void declare(OptionTable& table);
};

/// Answers the visual-search protocol over HTTP: requests are POSTed to "/", images of the index are at
/// "/image/NUMBER". It answers 400 to what is no request with a JPEG, 404, 413 (too large), 500, each with
/// a line of text that says why.
class SearchServer {
 public:
  /// A line for each request.
  using Log = std::function<void(const std::string& line)>;

  /// Listens, at any free port when it is 0, and answers on threads of its own. Error when the port is taken
  /// or the address is not this machine's. `service` stays with the caller.
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
