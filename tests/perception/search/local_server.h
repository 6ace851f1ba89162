#pragma once

#include <httplib.h>

#include <string>
#include <thread>

namespace loci::perception::testing_support {

/// A server at a free port of this machine, which answers what is POSTed to "/".
class LocalServer {
 public:
  explicit LocalServer(httplib::Server::Handler handler) {
    server_.Post("/", std::move(handler));
    port_ = server_.bind_to_any_port("127.0.0.1");
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();
  }
  ~LocalServer() {
    server_.stop();
    thread_.join();
  }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

 private:
  httplib::Server server_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace loci::perception::testing_support
