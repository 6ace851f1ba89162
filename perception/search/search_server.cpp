#include "perception/search/search_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <opencv2/imgproc.hpp>
#include <thread>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/image/image_io.h"
#include "perception/search/protocol.h"

namespace loci::perception {
namespace {

constexpr const char* kContentType = "application/x-protobuf";
constexpr const char* kWelcome =
    "This is a visual-search server of loci. POST a request of the protocol (application/x-protobuf) here:\n"
    "  loci-perceive search IMAGE --server URL\n";

/// What the client did wrong.
class BadRequest : public Error {
 public:
  using Error::Error;
};

cv::Mat image_of(const std::string& jpeg, double max_megapixels) {
  if (jpeg.empty()) throw BadRequest("the request holds no image");
  if (!jpeg.starts_with("\xff\xd8\xff")) throw BadRequest("the image is no JPEG");
  try {
    const mapping::ImageHeader header = mapping::parse_image_header(jpeg, "the image");
    if (1e-6 * header.width * header.height > max_megapixels)
      throw BadRequest(
          fmt::format("the image has {} x {} pixels, which are too many", header.width, header.height));
    const cv::Mat image = mapping::decode_image({jpeg.begin(), jpeg.end()}, "the image");
    if (image.channels() == 3) return image;
    cv::Mat color;
    cv::cvtColor(image, color, image.channels() == 1 ? cv::COLOR_GRAY2BGR : cv::COLOR_BGRA2BGR);
    return color;
  } catch (const Error& error) {
    throw BadRequest(error.what());
  }
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(why + "\n", "text/plain");
}

std::string url_of(const std::string& address, int port) {
  return address.find(':') == std::string::npos ? fmt::format("http://{}:{}", address, port)
                                                : fmt::format("http://[{}]:{}", address, port);
}

}  // namespace

void ServerOptions::declare(OptionTable& table) {
  table.text("address", address, "Of this machine; 127.0.0.1 is reached from this machine alone.");
  table.integer("port", port, "", "0 = any that is free.", 0, 65535);
  table.number("max_mb", max_mb, "MB", "Larger requests are refused.", 0.001, 1000);
  table.number("max_megapixels", max_megapixels, "MP", "Larger images are refused.", 0.01, 1000);
}

struct SearchServer::Running {
  const SearchService& service;
  ServerOptions options;
  int threads = 0;
  Log log;
  httplib::Server server;
  int port = 0;
  std::mutex logging;
  std::thread thread;

  Running(const SearchService& its_service, const ServerOptions& its_options, int its_threads, Log its_log)
      : service(its_service), options(its_options), threads(its_threads), log(std::move(its_log)) {}

  void set_up() {
    server.set_payload_max_length(static_cast<size_t>(options.max_mb * 1e6));
    server.set_keep_alive_max_count(1);  // Nobody keeps the server from stopping.
    // The library would share the port with another server, which then gets half of the requests.
    server.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server.Post("/", [this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
    });
    server.Get("/", [](const httplib::Request&, httplib::Response& response) {
      response.set_content(kWelcome, "text/plain");
    });
    server.Get(R"(/image/(\d{1,9}))", [this](const httplib::Request& request, httplib::Response& response) {
      show_image(std::stoul(request.matches[1]), response);
    });
    server.set_exception_handler(
        [](const httplib::Request&, httplib::Response& response, const std::exception_ptr& failure) {
          try {
            std::rethrow_exception(failure);
          } catch (const std::exception& error) {
            refuse(response, 500, error.what());
          } catch (...) {
            refuse(response, 500, "an unknown exception");
          }
        });
    server.set_error_handler([](const httplib::Request& request, httplib::Response& response) {
      if (!response.body.empty()) return;
      const char* why = response.status == 413   ? "the request is too large"
                        : response.status == 404 ? "there is nothing here; requests are POSTed to /"
                                                 : "this is no request that the server understands";
      refuse(response, response.status, why + (request.path.empty() ? "" : " (" + request.path + ")"));
    });
  }

  void say(const std::string& line) {
    if (!log) return;
    const std::lock_guard lock(logging);
    log(line);
  }

  void answer(const httplib::Request& request, httplib::Response& response) {
    const Stopwatch watch;
    try {
      const std::string url = request.has_header("Host") ? "http://" + request.get_header_value("Host")
                                                         : url_of(options.address, port);
      SearchRequest asked;
      try {
        asked = decode_request(request.body);
      } catch (const Error& error) {
        throw BadRequest(error.what());
      }
      const cv::Mat image = image_of(asked.jpeg, options.max_megapixels);
      const std::vector<SearchResult> results = service.look(image, threads, url + "/image/");
      response.set_content(encode(results, asked.details), kContentType);
      say(fmt::format("{}: {} x {} pixels, {} results, {:.2f} s", request.remote_addr, image.cols, image.rows,
                      results.size(), watch.seconds()));
    } catch (const BadRequest& error) {
      refuse(response, 400, error.what());
      say(fmt::format("{}: refused: {}", request.remote_addr, error.what()));
    }
  }

  void show_image(size_t number, httplib::Response& response) {
    if (number >= service.images()) return refuse(response, 404, "there is no such image");
    try {
      const std::filesystem::path& path = service.image(number);
      response.set_content(read_file(path), path.extension() == ".png" ? "image/png" : "image/jpeg");
    } catch (const Error&) {
      refuse(response, 404, "the image is not where it was when the index was made");
    }
  }
};

SearchServer::SearchServer(const SearchService& service, const ServerOptions& options, int threads, Log log)
    : running_(std::make_unique<Running>(service, options, threads, std::move(log))) {
  running_->set_up();
  httplib::Server& server = running_->server;
  if (options.port == 0)
    running_->port = server.bind_to_any_port(options.address);
  else if (server.bind_to_port(options.address, options.port))
    running_->port = options.port;
  if (running_->port <= 0)
    throw Error(
        fmt::format("port {} of {} cannot be listened at", options.port, options.address), {},
        "another program may have it, or the address is not this machine's; --port 0 takes a free one");
  running_->thread = std::thread([&server] { server.listen_after_bind(); });
  while (!server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

SearchServer::~SearchServer() {
  running_->server.stop();
  running_->thread.join();
}

int SearchServer::port() const {
  return running_->port;
}

std::string SearchServer::url() const {
  return url_of(running_->options.address, running_->port);
}

}  // namespace loci::perception
