#include "perception/search/search_server.h"

#include <gmock/gmock.h>
#include <httplib.h>

#include <filesystem>
#include <list>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/image/image_io.h"
#include "perception/search/protocol.h"
#include "perception/search/search_client.h"
#include "tests/perception/search/wire.h"
#include "tests/support/raw_connection.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;
using loci::testing_support::RawConnection;
using testing::Contains;
using testing::HasSubstr;

const fs::path kData = fs::path(LOCI_SOURCE_DIR) / "tests/data";

/// The products of the tests, and the same images as other kinds of things.
ProductIndex index_of(const std::vector<Product>& more = {}) {
  std::vector<Product> catalogue = read_catalogue(kData / "products");
  catalogue.insert(catalogue.end(), more.begin(), more.end());
  NoProgress progress;
  Warnings warnings;
  return ProductIndex::build(catalogue, 2, progress, warnings);
}

std::string jpeg_of(const cv::Mat& image) {
  const std::vector<unsigned char> bytes = mapping::encode_image(image, ".jpg");
  return {bytes.begin(), bytes.end()};
}

class SearchServing : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    service_ = std::make_unique<SearchService>(index_of(), ServiceOptions());
    ServerOptions options;
    options.port = 0;
    options.limits.max_mb = 0.5;
    options.max_megapixels = 2;
    options.limits.request_s = 60;
    options.images = (kData / "products").string();
    server_ = std::make_unique<SearchServer>(*service_, options, 2);
  }
  static void TearDownTestSuite() {
    server_.reset();
    service_.reset();
  }

  httplib::Result post(const std::string& body, const std::string& path = "/") const {
    httplib::Client client(server_->url());
    return client.Post(path, body, "application/x-protobuf");
  }
  void expect_refused(const std::string& body, int status, const std::string& why) const {
    const httplib::Result result = post(body);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->status, status);
    EXPECT_THAT(result->body, HasSubstr(why));
  }

  static std::unique_ptr<SearchService> service_;
  static std::unique_ptr<SearchServer> server_;
};

std::unique_ptr<SearchService> SearchServing::service_;
std::unique_ptr<SearchServer> SearchServing::server_;

TEST_F(SearchServing, AProductIsRecognisedWithWhatTheCatalogueSays) {
  SearchOptions options;
  options.server = server_->url();
  options.timeout_s = 60;
  SearchClient client(options);
  const SearchAnswer answer =
      client.search(mapping::read_color(kData / "images/Alpro-Blueberry-Soyghurt_001.jpg")).answer;
  EXPECT_TRUE(answer.unknown.empty());
  ASSERT_FALSE(answer.results.empty());
  const SearchResult& first = answer.results[0];
  EXPECT_EQ(first.category, SearchCategory::kProduct);
  EXPECT_EQ(first.title, "Alpro-Blueberry-Soyghurt");
  EXPECT_EQ(first.property("category"), "soyghurt");
  EXPECT_GT(std::stod(first.property("confidence")), 0.5);
  EXPECT_FALSE(first.region.empty());
  // Its image is at the address that it names.
  httplib::Client web(server_->url());
  const httplib::Result shown = web.Get(first.preview_url.substr(server_->url().size()));
  ASSERT_TRUE(shown);
  EXPECT_EQ(shown->status, 200);
  EXPECT_TRUE(shown->body.starts_with("\xff\xd8\xff"));
}

TEST_F(SearchServing, ARequestByHandIsAnsweredWithTitlesAloneUnlessItAsksForMore) {
  const std::string image =
      wire::text(1, wire::text(1, wire::text(1, jpeg_of(mapping::read_color(kData / "images/ean13.png")))));
  const httplib::Result brief = post(image);
  ASSERT_TRUE(brief);
  EXPECT_EQ(brief->status, 200);
  EXPECT_EQ(brief->get_header_value("Content-Type"), "application/x-protobuf");
  const std::vector<SearchResult> results = decode_response(brief->body).results;
  const auto code = std::find_if(results.begin(), results.end(), [](const auto& result) {
    return result.category == SearchCategory::kBarcode;
  });
  ASSERT_NE(code, results.end());
  EXPECT_EQ(code->category_text, "EAN-13 Barcode");
  EXPECT_EQ(code->title.size(), 13U);
  EXPECT_TRUE(code->region.empty());
  const httplib::Result full =
      post(image + wire::text(10, wire::text(wire::kEnableUi, wire::number(1, 1) + wire::number(7, 1))));
  ASSERT_TRUE(full);
  const std::vector<SearchResult> detailed = decode_response(full->body).results;
  ASSERT_EQ(detailed.size(), results.size());
  EXPECT_FALSE(detailed[static_cast<size_t>(code - results.begin())].region.empty());
}

TEST_F(SearchServing, WhatIsNoRequestIsRefusedWithTheReason) {
  expect_refused("<html>", 400, "no request of the visual-search protocol");
  expect_refused("", 400, "holds no image");
  expect_refused(encode(SearchRequest{"GIF89a", "en", "US", true}), 400, "no JPEG");
  const std::string jpeg = jpeg_of(cv::Mat(100, 100, CV_8UC3, cv::Scalar(9, 9, 9)));
  expect_refused(encode(SearchRequest{jpeg.substr(0, jpeg.size() / 2), "en", "US", true}), 400, "the image");
  expect_refused(
      encode(SearchRequest{jpeg_of(cv::Mat(1500, 1500, CV_8UC3, cv::Scalar(9, 9, 9))), "en", "US", true}),
      400, "too large");
  expect_refused(std::string(600000, 'x'), 413, "too large");
}

TEST_F(SearchServing, OtherPathsAreNotFound) {
  const httplib::Result result = post("", "/goggles");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->status, 404);
  httplib::Client web(server_->url());
  EXPECT_EQ(web.Get("/image/999999")->status, 404);
  EXPECT_EQ(web.Get("/../setup")->status, 404);
  EXPECT_THAT(web.Get("/")->body, HasSubstr("visual-search server"));
}

TEST_F(SearchServing, SeveralAreAnsweredAtTheSameTime) {
  const std::string body =
      encode(SearchRequest{jpeg_of(mapping::read_color(kData / "images/ean13.png")), "en", "US", true});
  const auto answer_of = [&] {
    const httplib::Result result = post(body);
    return result ? result->body : httplib::to_string(result.error());
  };
  const std::string expected = answer_of();
  ASSERT_NO_THROW(decode_response(expected)) << expected;
  std::vector<std::string> answers(4);
  std::vector<std::thread> threads;
  for (std::string& answer : answers) threads.emplace_back([&] { answer = answer_of(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& answer : answers) EXPECT_EQ(answer, expected);
}

TEST_F(SearchServing, APortThatIsTakenIsRefused) {
  ServerOptions options;
  options.port = server_->port();
  EXPECT_THROW(SearchServer(*service_, options, 1), Error);
  options.port = 0;
  options.address = "192.0.2.1";  // of nobody
  EXPECT_THROW(SearchServer(*service_, options, 1), Error);
}

TEST_F(SearchServing, BodiesInPiecesAreLimited) {
  const RawConnection wire(server_->port());
  wire.send("POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n");
  const std::string chunk = "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
  for (int i = 0; i < 20 && wire.send(chunk); ++i) {
  }
  EXPECT_THAT(wire.rest(), HasSubstr("413 Payload Too Large"));
}

TEST_F(SearchServing, CompressedBodiesAreRefused) {
  httplib::Client client(server_->url());
  const auto result = client.Post("/", {{"Content-Encoding", "gzip"}}, "\x1f\x8b", "application/x-protobuf");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->status, 415);
}

TEST_F(SearchServing, WebPagesAndForeignNamesAreRefused) {
  httplib::Client client(server_->url());
  EXPECT_EQ(client.Get("/", {{"Origin", "http://example.org"}})->status, 403);
  EXPECT_EQ(client.Get("/", {{"Host", "example.org"}})->status, 403);
  EXPECT_EQ(client.Get("/", {{"Host", "localhost:8600"}})->status, 200);
  EXPECT_EQ(client.Get("/", {{"Host", "[::1]:8600"}})->status, 200);
}

TEST_F(SearchServing, WhatIsNoHttpIsRefused) {
  const RawConnection wire(server_->port());
  wire.send("\x16\x03\x01 nonsense\r\n\r\n");
  EXPECT_THAT(wire.rest(), HasSubstr("400 Bad Request"));
  const RawConnection header(server_->port());
  header.send("GET / HTTP/1.1\r\nHost: " + std::string(100000, 'x') + "\r\n\r\n");
  EXPECT_THAT(header.rest(), HasSubstr("431 "));
}

TEST_F(SearchServing, ImagesOutsideTheirFolderAreNotShown) {
  const fs::path outside = kData / "images/ean13.png", inside = kData / "products/Golden-Delicious.jpg";
  const fs::path folder = fs::path(testing::TempDir()) / "search_images", link = folder / "link.png";
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::create_symlink(fs::absolute(outside), link);
  NoProgress progress;
  Warnings warnings;
  const SearchService service(
      ProductIndex::build({{"inside", {}, inside}, {"outside", {}, outside}, {"link", {}, link}}, 2, progress,
                          warnings),
      ServiceOptions());
  ServerOptions options;
  options.port = 0;
  const auto shown = [&](const fs::path& images) {
    options.images = images.string();
    const SearchServer server(service, options, 1);
    httplib::Client client(server.url());
    std::vector<int> statuses;
    for (size_t i = 0; i < service.images(); ++i)
      statuses.push_back(client.Get("/image/" + std::to_string(i))->status);
    return statuses;
  };
  EXPECT_THAT(shown(kData / "products"), testing::ElementsAre(200, 404, 404));
  EXPECT_THAT(shown(folder), testing::ElementsAre(404, 404, 404)) << "a link leads out of the folder";
  EXPECT_THAT(shown({}), testing::ElementsAre(404, 404, 404));
}

TEST_F(SearchServing, SlowClientsDelayNobody) {
  ServerOptions options;
  options.port = 0;
  options.limits.connections = 8;
  options.limits.request_s = 30;
  const SearchServer server(*service_, options, 1);
  std::list<RawConnection> slow;
  for (int i = 0; i < 40; ++i) slow.emplace_back(server.port()).send("POST / HTTP/1.1\r\nContent-Le");
  const Stopwatch watch;
  httplib::Client client(server.url());
  EXPECT_EQ(client.Get("/")->status, 200);
  EXPECT_LT(watch.seconds(), 10) << "far less than the time limit of the slow ones";
}

TEST_F(SearchServing, ARequestHasALimitedTime) {
  ServerOptions options;
  options.port = 0;
  options.limits.request_s = 0.3;
  const SearchServer server(*service_, options, 1);
  const RawConnection wire(server.port());
  wire.send("POST / HTTP/1.1\r\n");
  EXPECT_EQ(wire.rest(), "") << "closed, although nothing was wrong yet";
}

TEST_F(SearchServing, OtherMachinesNeedAToken) {
  const fs::path file = fs::path(testing::TempDir()) / "token.txt";
  ServerOptions options;
  options.port = 0;
  options.address = "0.0.0.0";
  try {
    SearchServer(*service_, options, 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("--token-file"));
  }
  write_file_atomically(file, "short\n");
  EXPECT_THROW(mapping::read_token(file), Error);
  write_file_atomically(file, "0123456789abcdef\n");
  options.limits.token_file = file.string();
  const SearchServer server(*service_, options, 1);
  const std::string url = "http://127.0.0.1:" + std::to_string(server.port());
  httplib::Client web(url);
  EXPECT_EQ(web.Get("/")->status, 401);
  EXPECT_EQ(web.Get("/", {{"Authorization", "Bearer 0123456789abcdee"}})->status, 401);
  EXPECT_EQ(web.Get("/", {{"Authorization", "Bearer 0123456789abcdef"}})->status, 200);
  SearchOptions asking;
  asking.server = url;
  asking.timeout_s = 60;
  const cv::Mat image(60, 60, CV_8UC3, cv::Scalar(9, 99, 200));
  EXPECT_THROW(SearchClient(asking).search(image), Error);
  asking.token_file = file.string();
  EXPECT_NO_THROW(SearchClient(asking).search(image));
}

std::vector<SearchResult> looked(const std::vector<Product>& more, const cv::Mat& image) {
  ServiceOptions options;
  options.text = false;
  return SearchService(index_of(more), options).look(image, 2);
}

SearchCategory category_of_entry(const Properties& properties) {
  const fs::path image = kData / "images/ean13.png";
  const auto results = looked({{"entry", properties, image}}, mapping::read_color(image));
  for (const SearchResult& result : results)
    if (result.title == "entry") return result.category;
  return SearchCategory::kOther;
}

TEST(SearchService, EntriesOfTheIndexAreWhatTheySayTheyAre) {
  EXPECT_EQ(category_of_entry({}), SearchCategory::kProduct);
  EXPECT_EQ(category_of_entry({{"isbn", "1"}}), SearchCategory::kBook);
  EXPECT_EQ(category_of_entry({{"kind", "Logo"}}), SearchCategory::kLogo);
  EXPECT_EQ(category_of_entry({{"kind", "landmark"}}), SearchCategory::kLandmark);
  EXPECT_EQ(category_of_entry({{"uploader", "Ann"}}), SearchCategory::kUserSubmitted);
}

TEST(SearchService, ABrandOfTheCatalogueIsALogo) {
  const fs::path image = kData / "images/ean13.png";
  const auto results = looked({{"entry", {{"brand", "Marca"}}, image}}, mapping::read_color(image));
  const auto logo = std::find_if(results.begin(), results.end(),
                                 [](const auto& result) { return result.category == SearchCategory::kLogo; });
  ASSERT_NE(logo, results.end());
  EXPECT_EQ(logo->title, "Marca");
}

TEST(SearchService, ABarcodeBringsTheProductThatItMarks) {
  const cv::Mat image = mapping::read_color(kData / "images/ean13.png");
  const auto alone = looked({}, image);
  const auto code = std::find_if(alone.begin(), alone.end(), [](const auto& result) {
    return result.category == SearchCategory::kBarcode;
  });
  ASSERT_NE(code, alone.end());
  std::vector<std::string> titles;
  for (const SearchResult& result :
       looked({{"marked", {{"barcode", code->title}}, kData / "products/Golden-Delicious.jpg"}}, image))
    titles.push_back(result.title);
  EXPECT_THAT(titles, Contains("marked"));
}

}  // namespace
}  // namespace loci::perception
