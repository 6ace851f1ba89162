#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mapping/base/options.h"

namespace loci::mapping {

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  std::string method;  ///< "POST"
  std::string path;    ///< "/image/3", without the query
  std::string host;    ///< as the client calls the server ("127.0.0.1:8600"); empty = it does not
  std::string client;  ///< address of the client
  HttpHeaders headers;
  std::string body;

  /// The value of a header, whatever the case of its name; empty = it is not there.
  std::string header(const std::string& name) const;
};

struct HttpReply {
  int status = 200;
  std::string body = {};
  std::string content_type = "text/plain";
  HttpHeaders headers = {};  ///< beside those that every reply has
};

/// What clients may take, and what they have to give.
struct HttpLimits {
  double max_mb = 16;
  double request_s = 30;
  int connections = 64;
  std::string token_file = {};

  void declare(OptionTable& table);
};

/// A small HTTP/1.1 server for hostile networks: one request per connection, limits on everything, and a slow
/// client delays nobody. All connections are read and written by one thread without blocking, so that an open
/// one costs memory only; when there are too many, the one that has been sending its request for longest is
/// closed. Whole requests are answered by the workers, one for each core and at least two. Compressed bodies
/// are refused, and so are requests of web pages (Origin).
///
/// Without a token it is for programs of this machine: requests that reach it under a foreign name (Host) are
/// refused.
class HttpServer {
 public:
  /// Called by several threads. What it throws becomes status 500 with the text.
  using Handler = std::function<HttpReply(const HttpRequest&)>;

  /// Listens, at any free port when it is 0. Error when the port is taken, the address is not this machine's,
  /// the file holds no token, or the address can be reached from other machines and there is no token.
  HttpServer(const std::string& address, int port, const HttpLimits& limits, Handler handler);
  /// Answers what was begun, then stops.
  ~HttpServer();

  int port() const;
  /// "http://127.0.0.1:8600"
  std::string url() const;

 private:
  class Loop;
  std::string address_;
  std::unique_ptr<Loop> loop_;
};

/// Where a server listens.
struct HttpAddress {
  std::string address = "127.0.0.1";
  int port = 0;
};
/// Of "127.0.0.1:8642", "[::1]:8642", or a port alone, which is at 127.0.0.1. Error for anything else.
HttpAddress read_http_address(const std::string& text);

/// The secret in a file: its first line, of at least 16 printable characters. Error when there is none.
std::string read_token(const std::filesystem::path& file);

}  // namespace loci::mapping
