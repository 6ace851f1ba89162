#include "perception/search/http_post.h"

#include <fmt/format.h>
#include <httplib.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <regex>
#include <thread>

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

}  // namespace

HttpAddress HttpAddress::parse(const std::string& url) {
  static const std::regex form(R"((https?://(?:\[[0-9a-fA-F:.]+\]|[^/?#:\s]+)(?::[0-9]{1,5})?)(/[^#\s]*)?)");
  std::smatch found;
  if (!std::regex_match(url, found, form))
    throw Error("'" + url + "' is no address of a server", {}, "give one like http://127.0.0.1:8600");
  return {found[1], found[2].length() > 0 ? found.str(2) : "/"};
}

HttpAnswer http_post(const HttpAddress& address, const std::string& body, double timeout_s,
                     size_t max_bytes) {
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

}  // namespace loci::perception
