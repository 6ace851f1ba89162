#include "perception/search/search_client.h"

#include <gmock/gmock.h>
#include <httplib.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "perception/search/protocol.h"
#include "tests/perception/search/local_server.h"
#include "tests/perception/search/wire.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using Server = testing_support::LocalServer;

/// Takes one connection after the other, says something that is no HTTP (or nothing), and waits.
class RawServer {
 public:
  explicit RawServer(std::string says) : says_(std::move(says)) {
    listening_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listening_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listening_, 8), 0);
    ::getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~RawServer() {
    done_ = true;
    ::shutdown(listening_, SHUT_RDWR);
    thread_.join();
    ::close(listening_);
  }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

 private:
  void serve() {
    while (!done_) {
      const int connection = ::accept(listening_, nullptr, nullptr);
      if (connection < 0) return;
      // A byte every 50 ms, again and again: each read of the client succeeds.
      for (size_t i = 0; !done_ && !says_.empty(); ++i) {
        if (::send(connection, &says_[i % says_.size()], 1, MSG_NOSIGNAL) <= 0) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
      while (!done_ && says_.empty()) {
        char byte = 0;
        if (::recv(connection, &byte, 1, MSG_DONTWAIT) == 0) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      ::close(connection);
    }
  }

  std::string says_;
  int listening_ = -1, port_ = 0;
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

cv::Mat image(int seed = 1) {
  cv::Mat image(120, 160, CV_8UC3);
  cv::RNG random(static_cast<uint64_t>(seed));
  cv::Mat small(6, 8, CV_8UC3);
  random.fill(small, cv::RNG::UNIFORM, 0, 255);
  cv::resize(small, image, image.size(), 0, 0, cv::INTER_CUBIC);
  return image;
}

SearchOptions options_for(const std::string& url) {
  SearchOptions options;
  options.server = url;
  options.timeout_s = 0.5;
  options.pause_s = 0.01;
  return options;
}

std::string failure_of(const SearchOptions& options) {
  SearchClient client(options);
  try {
    client.search(image());
  } catch (const Error& error) {
    return error.what();
  }
  return "it did not fail";
}

const std::string kLogo = wire::info("Kaba", "Logo", wire::text(1, wire::coords(10, 20, 30, 40)));

TEST(SearchClient, SendsAJpegAndReadsTheAnswer) {
  std::string sent, type;
  const Server server([&](const httplib::Request& request, httplib::Response& response) {
    sent = request.body;
    type = request.get_header_value("Content-Type");
    response.set_content(kLogo, "application/x-protobuf");
  });
  SearchClient client(options_for(server.url()));
  const auto outcome = client.search(image());
  ASSERT_EQ(outcome.answer.results.size(), 1U);
  EXPECT_EQ(outcome.answer.results[0].title, "Kaba");
  EXPECT_EQ(outcome.answer.results[0].region, cv::Rect(10, 20, 30, 40));
  EXPECT_EQ(type, "application/x-protobuf");
  EXPECT_TRUE(decode_request(sent).jpeg.starts_with("\xff\xd8\xff"));
  EXPECT_TRUE(decode_request(sent).details);
}

TEST(SearchClient, LargeImagesAreSentSmallerAndPlacesAreThoseOfTheLargeOne) {
  const Server server(
      [&](const httplib::Request&, httplib::Response& response) { response.set_content(kLogo, "x"); });
  SearchOptions options = options_for(server.url());
  options.side_px = 80;
  SearchClient client(options);
  // 80 x 60 were sent, and of the region only a part lies in the image.
  EXPECT_EQ(client.search(image()).answer.results[0].region, cv::Rect(20, 40, 60, 80));
}

TEST(SearchClient, AnAlikeImageIsNotSentAgain) {
  std::atomic<int> requests = 0;
  const Server server([&](const httplib::Request&, httplib::Response& response) {
    ++requests;
    response.set_content(kLogo, "x");
  });
  SearchClient client(options_for(server.url()));
  client.search(image());
  cv::Mat noisy = image(), noise(noisy.size(), CV_8UC3);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 12);
  noisy += noise;
  cv::resize(noisy, noisy, {}, 0.5, 0.5, cv::INTER_AREA);
  const auto outcome = client.search(noisy);
  EXPECT_TRUE(outcome.remembered);
  EXPECT_EQ(outcome.answer.results.at(0).region, cv::Rect(5, 10, 15, 20));
  EXPECT_EQ(requests, 1);
  EXPECT_FALSE(client.search(image(2)).remembered);
  // The same in other colours is another flavour.
  cv::Mat other;
  cv::cvtColor(image(), other, cv::COLOR_BGR2RGB);
  EXPECT_FALSE(client.search(other).remembered);
  EXPECT_EQ(requests, 3);
}

TEST(SearchClient, ABusyServerIsAskedAgain) {
  std::atomic<int> requests = 0;
  const Server server([&](const httplib::Request&, httplib::Response& response) {
    if (++requests <= 2)
      response.status = 503;
    else
      response.set_content(kLogo, "x");
  });
  SearchClient client(options_for(server.url()));
  const auto outcome = client.search(image());
  EXPECT_EQ(outcome.attempts, 3);
  EXPECT_EQ(outcome.answer.results.size(), 1U);
}

TEST(SearchClient, GarbageIsToldAfterAllAttempts) {
  std::atomic<int> requests = 0;
  const Server server([&](const httplib::Request&, httplib::Response& response) {
    ++requests;
    response.set_content("<html>Welcome to the hotel</html>", "text/html");
  });
  EXPECT_THAT(failure_of(options_for(server.url())),
              HasSubstr("what came is no response of the visual-search protocol"));
  EXPECT_EQ(requests, 3);
}

TEST(SearchClient, ARefusalIsNotTriedAgainAndItsReasonTold) {
  std::atomic<int> requests = 0;
  const Server server([&](const httplib::Request&, httplib::Response& response) {
    ++requests;
    response.status = 400;
    response.set_content("the image is no JPEG\n", "text/plain");
  });
  EXPECT_THAT(failure_of(options_for(server.url())), HasSubstr("answered 400: the image is no JPEG"));
  EXPECT_EQ(requests, 1);
}

TEST(SearchClient, APathThatIsNotThereIsTold) {
  const Server server([](const httplib::Request&, httplib::Response&) {});
  EXPECT_THAT(failure_of(options_for(server.url() + "/elsewhere")), HasSubstr("answered 404"));
}

TEST(SearchClient, AnswersThatAreTooLargeAreRefused) {
  const Server server([](const httplib::Request&, httplib::Response& response) {
    response.set_content(std::string(100000, 'x'), "x");
  });
  SearchOptions options = options_for(server.url());
  options.max_mb = 0.05;
  EXPECT_THAT(failure_of(options), HasSubstr("more than 50000 bytes"));
}

TEST(SearchClient, AServerThatIsNotThereIsTold) {
  std::string url;
  {
    const RawServer server("");
    url = server.url();
  }
  EXPECT_THAT(failure_of(options_for(url)), HasSubstr("cannot be reached"));
}

void expect_given_up(const std::string& url) {
  SearchOptions options = options_for(url);
  options.retry = 1;
  const Stopwatch watch;
  EXPECT_THAT(failure_of(options), HasSubstr("did not answer within 0.5 s"));
  EXPECT_GT(watch.seconds(), 0.9);
  EXPECT_LT(watch.seconds(), 3);
}

TEST(SearchClient, AServerThatNeverAnswersIsGivenUpInTime) {
  const RawServer server("");
  expect_given_up(server.url());
}

TEST(SearchClient, AServerWhoseAnswerDripsIsGivenUpInTime) {
  const RawServer server("HTTP/1.1 200 OK\r\nX-Header: and so on and on and on and on and on and on\r\n");
  expect_given_up(server.url());
}

TEST(SearchClient, ASlowBodyIsGivenUpInTime) {
  const Server server([](const httplib::Request&, httplib::Response& response) {
    response.set_content_provider(1000, "x", [](size_t, size_t, httplib::DataSink& sink) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      return sink.write("x", 1);
    });
  });
  expect_given_up(server.url());
}

TEST(SearchClient, WhatIsNoHttpIsTold) {
  const RawServer server("what?\r\n\r\n");
  EXPECT_THAT(failure_of(options_for(server.url())), HasSubstr("is no HTTP"));
}

TEST(SearchClient, AnswersWithUnknownFieldsAreKept) {
  const Server server([](const httplib::Request&, httplib::Response& response) {
    response.set_content(kLogo + wire::number(77, 5), "x");
  });
  SearchOptions options = options_for(server.url());
  const fs::path folder = fs::temp_directory_path() / ("loci_unknown_" + std::to_string(::getpid()));
  options.unknown = folder.string();
  SearchClient client(options);
  EXPECT_THAT(client.search(image()).answer.unknown, ElementsAre("77: varint 5"));
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    ++files;
    EXPECT_EQ(read_file(entry.path()),
              entry.path().extension() == ".txt" ? "77: varint 5\n" : kLogo + wire::number(77, 5));
  }
  EXPECT_EQ(files, 2);
  fs::remove_all(folder);
}

TEST(SearchClient, AddressesAreChecked) {
  EXPECT_EQ(HttpAddress::parse("http://localhost:80/a/b?c=d").path, "/a/b?c=d");
  EXPECT_EQ(HttpAddress::parse("https://[::1]:8600").server, "https://[::1]:8600");
  for (const char* bad : {"", "localhost:80", "ftp://a", "http://", "http:// a", "http://a:123456"})
    EXPECT_THROW(HttpAddress::parse(bad), Error) << bad;
}

}  // namespace
}  // namespace loci::perception
