#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace loci::perception {

struct HttpRequest {
  std::string method;  ///< "POST"
  std::string path;    ///< "/image/3", without the query
  std::string host;    ///< as the client calls the server ("127.0.0.1:8600"); empty = it does not
  std::string client;  ///< address of the client
  std::string body;
};

struct HttpReply {
  int status = 200;
  std::string body;
  std::string content_type = "text/plain";
};

/// What a client may take.
struct HttpLimits {
  size_t max_body = 16'000'000;  ///< bytes, in however many pieces they come
  double seconds = 10;           ///< for sending a request, for its answer, and for fetching that, each
  int connections = 64;          ///< at the same time
  int workers = 2;               ///< requests that are answered at the same time
  std::string token;             ///< requests without it are refused; empty = none is asked for
};

/// A small HTTP/1.1 server for hostile networks: one request per connection, limits on everything, and a slow
/// client delays nobody. All connections are read and written by one thread without blocking, so that an open
/// one costs memory only; when there are too many, the one that has been sending its request for longest is
/// closed. Whole requests are answered by the workers. Compressed bodies are refused.
///
/// Without a token it is for programs of this machine: requests of web pages (Origin) and such that reach it
/// under a foreign name (Host) are refused.
class HttpServer {
 public:
  /// Called by several threads. What it throws becomes status 500 with the text.
  using Handler = std::function<HttpReply(const HttpRequest&)>;

  /// Listens, at any free port when it is 0. Error when the port is taken, the address is not this machine's,
  /// or it can be reached from other machines and there is no token.
  HttpServer(const std::string& address, int port, const HttpLimits& limits, Handler handler);
  /// Answers what was begun, then stops.
  ~HttpServer();

  int port() const;

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace loci::perception
