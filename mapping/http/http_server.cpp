#include "mapping/http/http_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <charconv>
#include <chrono>
#include <list>
#include <optional>
#include <thread>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/text/text.h"

namespace loci::mapping {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using Code = boost::system::error_code;

constexpr uint32_t kMaxHeader = 8192;        // bytes
constexpr size_t kMaxIgnored = 64'000'000;   // bytes of a refused request that are still taken from the line
constexpr std::chrono::seconds kGoodbye{1};  // for what is left to send when the server stops

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(1000 * seconds));
}

/// Takes as long for a wrong text as for the right one.
bool same_secret(std::string_view given, std::string_view secret) {
  unsigned difference = given.size() == secret.size() ? 0 : 1;
  for (size_t i = 0; i < given.size(); ++i)
    difference |=
        static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(i < secret.size() ? secret[i] : 0);
  return difference == 0;
}

std::string text_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// Whether a Host header names this machine: other names reach it through a hostile name server.
bool is_local(const std::string& host) {
  const size_t end = host.starts_with('[') ? host.find(']') : host.find(':');
  const std::string name = lower_case(host.substr(0, end));
  if (name == "localhost" || name.empty()) return true;
  Code code;
  const auto address = asio::ip::make_address(name.starts_with('[') ? name.substr(1) : name, code);
  return !code && address.is_loopback();
}

tcp::endpoint endpoint_of(asio::io_context& context, const std::string& address, int port) {
  Code code;
  const auto found =
      tcp::resolver(context).resolve(address, std::to_string(port), tcp::resolver::passive, code);
  if (code || found.empty()) throw Error(fmt::format("'{}' is no address: {}", address, code.message()));
  return found.begin()->endpoint();
}

}  // namespace

class HttpServer::Loop {
 public:
  Loop(const std::string& address, int port, const HttpLimits& limits, Handler handler)
      : limits_(limits),
        token_(limits.token_file.empty() ? "" : read_token(limits.token_file)),
        handler_(std::move(handler)),
        workers_(std::max(2U, std::thread::hardware_concurrency())) {
    listen(address, port);
    accept();
    thread_ = std::thread([this] { context_.run(); });
  }

  ~Loop() {
    stopping_ = true;
    asio::post(context_, [this] { stop(); });
    workers_.join();
    thread_.join();
  }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  int port() const { return port_; }

 private:
  class Connection;
  friend class Connection;

  void listen(const std::string& address, int port) {
    const tcp::endpoint endpoint = endpoint_of(context_, address, port);
    if (!endpoint.address().is_loopback() && token_.empty())
      throw Error(fmt::format("{} can be reached from other machines", address), {},
                  "give a secret with --token-file, or listen at 127.0.0.1");
    Code code;
    acceptor_.open(endpoint.protocol(), code);
    if (!code) acceptor_.set_option(asio::socket_base::reuse_address(true), code);
    if (!code) acceptor_.bind(endpoint, code);
    if (!code) acceptor_.listen(asio::socket_base::max_listen_connections, code);
    if (code)
      throw Error(
          fmt::format("port {} of {} cannot be listened at: {}", port, address, code.message()), {},
          "another program may have it, or the address is not this machine's; --port 0 takes a free one");
    port_ = acceptor_.local_endpoint().port();
  }

  void accept();
  void accept_later();
  bool make_room();
  void stop();

  size_t max_body() const { return static_cast<size_t>(limits_.max_mb * 1e6); }

  HttpLimits limits_;
  std::string token_;  ///< empty = none is asked for
  Handler handler_;
  asio::io_context context_;
  tcp::acceptor acceptor_{context_};
  asio::steady_timer retry_{context_};
  int port_ = 0;
  std::list<Connection*> connections_;  ///< the oldest first; of the loop's thread alone
  std::atomic<bool> stopping_ = false;
  asio::thread_pool workers_;
  std::thread thread_;
};

/// One request and its answer. It lives as long as an operation of its is under way. All members but the
/// request belong to the loop's thread.
class HttpServer::Loop::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Loop& loop, tcp::socket socket) : loop_(loop), stream_(std::move(socket)) {
    place_ = loop_.connections_.insert(loop_.connections_.end(), this);
  }
  ~Connection() { loop_.connections_.erase(place_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  enum class State { reading, working, writing, closed };
  State state() const { return state_; }
  void close() {
    state_ = State::closed;
    stream_.close();
  }

  void read_header() {
    parser_.header_limit(kMaxHeader);
    parser_.body_limit(loop_.max_body());
    stream_.expires_after(milliseconds(loop_.limits_.request_s));  // of header and body together
    http::async_read_header(stream_, buffer_, parser_, [self = shared_from_this()](Code code, size_t) {
      if (code) return self->read_failed(code);
      if (const auto refusal = self->refusal()) return self->reply(*refusal);
      const auto& header = self->parser_.get();
      if (beast::iequals(header[http::field::expect], "100-continue")) return self->invite();
      self->read_body();
    });
  }

  void stop() {
    if (state_ == State::reading) close();
    if (state_ == State::writing) stream_.expires_after(kGoodbye);
  }

 private:
  std::optional<HttpReply> refusal() const {
    const auto& header = parser_.get();
    const std::string& token = loop_.token_;
    const std::string given = text_of(header[http::field::authorization]);
    constexpr beast::string_view kScheme = "Bearer ";
    const bool has_scheme = beast::iequals(given.substr(0, kScheme.size()), kScheme);
    if (!token.empty() && (!has_scheme || !same_secret(given.substr(kScheme.size()), token)))
      return HttpReply{401, "this server asks for a token (--token-file)\n"};
    if (header.count(http::field::origin) > 0)
      return HttpReply{403, "this server is for programs, not for web pages\n"};
    if (token.empty() && !is_local(text_of(header[http::field::host])))
      return HttpReply{403, "this server is for programs of its own machine\n"};
    const auto coding = header[http::field::content_encoding];
    if (!coding.empty() && !beast::iequals(coding, "identity"))
      return HttpReply{415, "compressed requests are not read\n"};
    const auto length = parser_.content_length();
    if (length && *length > loop_.max_body()) return HttpReply{413, "the request is too large\n"};
    return std::nullopt;
  }

  /// Some clients send the body only when they are asked to.
  void invite() {
    response_.version(11);
    response_.result(http::status::continue_);
    http::async_write(stream_, response_, [self = shared_from_this()](Code code, size_t) {
      if (!code) self->read_body();
    });
  }

  void read_body() {
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](Code code, size_t) {
      if (code) return self->read_failed(code);
      self->work();
    });
  }

  void read_failed(Code code) {
    if (code == http::error::body_limit) return reply({413, "the request is too large\n"});
    if (code == http::error::header_limit) return reply({431, "the header is too large\n"});
    if (code == beast::error::timeout ||
        code.category() != http::make_error_code(http::error::bad_method).category())
      return close();
    reply({400, "this is no HTTP request: " + code.message() + "\n"});
  }

  void work() {
    state_ = State::working;
    stream_.expires_never();
    take_request();
    deadline_.expires_after(milliseconds(loop_.limits_.request_s));
    deadline_.async_wait([self = shared_from_this()](Code code) {
      if (!code && self->state_ == State::working)
        self->reply({503, "the answer takes too long, ask again later\n"});
    });
    const auto busy = asio::make_work_guard(loop_.context_);
    asio::post(loop_.workers_, [self = shared_from_this(), busy]() mutable {
      HttpReply reply{503, "the server stops\n"};
      if (!self->given_up_ && !self->loop_.stopping_) reply = self->answer();
      // The last owner of a connection is in the loop's thread, too.
      asio::io_context& context = self->loop_.context_;
      asio::post(context, [self = std::move(self), reply = std::move(reply), busy]() mutable {
        if (self->state_ == State::working) self->reply(std::move(reply));
      });
    });
  }

  void take_request() {
    auto& message = parser_.get();
    request_.method = text_of(message.method_string());
    const std::string target = text_of(message.target());
    request_.path = target.substr(0, target.find('?'));
    request_.host = text_of(message[http::field::host]);
    Code code;
    const auto peer = stream_.socket().remote_endpoint(code);
    if (!code) request_.client = peer.address().to_string();
    for (const auto& field : message)
      request_.headers.emplace_back(text_of(field.name_string()), text_of(field.value()));
    request_.body = std::move(message.body());
  }

  HttpReply answer() const {
    try {
      return loop_.handler_(request_);
    } catch (const std::exception& error) {
      return {500, std::string(error.what()) + "\n"};
    }
  }

  void reply(HttpReply reply) {
    state_ = State::writing;
    given_up_ = true;
    deadline_.cancel();
    response_ = {};
    response_.version(11);
    response_.result(static_cast<unsigned>(reply.status));
    if (!reply.body.empty()) response_.set(http::field::content_type, reply.content_type);
    for (const auto& [name, value] : reply.headers) response_.set(name, value);
    response_.set("X-Content-Type-Options", "nosniff");
    if (reply.status == 401) response_.set(http::field::www_authenticate, "Bearer");
    response_.keep_alive(false);
    response_.body() = std::move(reply.body);
    response_.prepare_payload();
    if (loop_.stopping_)
      stream_.expires_after(kGoodbye);
    else
      stream_.expires_after(milliseconds(loop_.limits_.request_s));
    http::async_write(stream_, response_, [self = shared_from_this()](Code code, size_t) {
      Code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
      if (!code) self->ignore_rest();
    });
  }

  /// Closing while data are under way would make the client's system throw the reply away.
  void ignore_rest() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(65536), [self = shared_from_this()](Code code, size_t count) {
      self->ignored_ += count;
      if (!code && self->ignored_ < kMaxIgnored) self->ignore_rest();
    });
  }

  Loop& loop_;
  std::list<Connection*>::iterator place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{1 << 17};
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
  asio::steady_timer deadline_{loop_.context_};
  HttpRequest request_;
  State state_ = State::reading;
  std::atomic<bool> given_up_ = false;  ///< the answer is not waited for any more
  size_t ignored_ = 0;
};

void HttpServer::Loop::accept() {
  acceptor_.async_accept([this](Code code, tcp::socket socket) {
    if (code == asio::error::operation_aborted || stopping_) return;
    if (code) return accept_later();  // out of descriptors: at once it would fail again
    if (make_room()) std::make_shared<Connection>(*this, std::move(socket))->read_header();
    accept();
  });
}

void HttpServer::Loop::accept_later() {
  retry_.expires_after(std::chrono::milliseconds(100));
  retry_.async_wait([this](Code code) {
    if (!code && !stopping_) accept();
  });
}

/// Closes the oldest connection that is slow, if there are too many. False when all are being answered.
bool HttpServer::Loop::make_room() {
  using State = Connection::State;
  if (connections_.size() < static_cast<size_t>(limits_.connections)) return true;
  for (const State slow : {State::closed, State::reading, State::writing})
    for (Connection* connection : connections_)
      if (connection->state() == slow) return connection->close(), true;
  return false;
}

void HttpServer::Loop::stop() {
  Code ignored;
  acceptor_.close(ignored);
  retry_.cancel();
  const auto connections = connections_;
  for (Connection* connection : connections) connection->stop();
}

HttpServer::HttpServer(const std::string& address, int port, const HttpLimits& limits, Handler handler)
    : address_(address), loop_(std::make_unique<Loop>(address, port, limits, std::move(handler))) {}

HttpServer::~HttpServer() = default;

int HttpServer::port() const {
  return loop_->port();
}

std::string HttpServer::url() const {
  const bool is_v6 = address_.find(':') != std::string::npos;
  return fmt::format("http://{}:{}", is_v6 ? "[" + address_ + "]" : address_, port());
}

std::string HttpRequest::header(const std::string& name) const {
  const auto found = std::ranges::find_if(
      headers, [&](const auto& header) { return lower_case(header.first) == lower_case(name); });
  return found == headers.end() ? "" : found->second;
}

void HttpLimits::declare(OptionTable& table) {
  table.number("max_mb", max_mb, "MB", "Larger requests are refused.", 0.001, 1000);
  table.number("request_s", request_s, "s", "Time limit of sending a request, and of its answer.", 0.1, 3600);
  table.integer("connections", connections, "", "Most at the same time; slow ones are closed for new ones.",
                1, 1000);
  table.text("token_file", token_file,
             "File with the secret that clients have to give; needed at addresses other machines can reach.");
}

HttpAddress read_http_address(const std::string& text) {
  const size_t colon = text.rfind(':');
  const std::string digits = text.substr(colon == std::string::npos ? 0 : colon + 1);
  HttpAddress read;
  if (colon != std::string::npos) read.address = text.substr(0, colon);
  const bool is_v6 = read.address.starts_with('[') && read.address.ends_with(']');
  if (is_v6) read.address = read.address.substr(1, read.address.size() - 2);
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), read.port);
  if (failure != std::errc() || end != digits.data() + digits.size() || read.port < 0 || read.port > 65535 ||
      read.address.empty() || (!is_v6 && read.address.find(':') != std::string::npos))
    throw Error(fmt::format("'{}' is no address to listen at", text), {},
                "write ADDRESS:PORT, e.g. 127.0.0.1:8642, or the port alone");
  return read;
}

std::string read_token(const std::filesystem::path& file) {
  constexpr size_t kMinToken = 16;
  const std::string text = read_file(file);
  std::string token = trimmed(text.substr(0, text.find('\n')));
  const bool printable = std::ranges::all_of(token, [](char c) { return c > ' ' && c <= '~'; });
  if (token.size() < kMinToken || !printable)
    throw Error("the first line is not a token", {file.string(), 1, {}},
                fmt::format("write at least {} letters and digits there", kMinToken));
  return token;
}

}  // namespace loci::mapping
