#pragma once

#include <string>

#include "mapping/base/error.h"

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
HttpAnswer http_post(const HttpAddress& address, const std::string& body, double timeout_s, size_t max_bytes);

}  // namespace loci::perception
