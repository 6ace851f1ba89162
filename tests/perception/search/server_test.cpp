#include "perception/search/search_server.h"

#include <gmock/gmock.h>
#include <httplib.h>

#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "mapping/image/image_io.h"
#include "perception/search/protocol.h"
#include "perception/search/search_client.h"
#include "tests/perception/search/wire.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;
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
    options.max_mb = 0.5;
    options.max_megapixels = 2;
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
      400, "too many");
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
  const std::string expected = post(body)->body;
  std::vector<std::string> answers(4);
  std::vector<std::thread> threads;
  for (std::string& answer : answers) threads.emplace_back([&] { answer = post(body)->body; });
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
