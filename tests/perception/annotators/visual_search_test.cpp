#include "perception/annotators/description/visual_search.h"

#include <gmock/gmock.h>

#include <atomic>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "mapping/base/config.h"
#include "mapping/base/text/json.h"
#include "perception/annotators/annotators.h"
#include "perception/conversions/opencv.h"
#include "perception/pipeline/flow.h"
#include "perception/search/protocol.h"
#include "tests/perception/search/local_server.h"

namespace loci::perception {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A server that answers every image with the same results.
class Server {
 public:
  explicit Server(const std::vector<SearchResult>& results, int status = 200)
      : server_([this, body = encode(results), status](const auto&, httplib::Response& response) {
          ++requests;
          response.status = status;
          response.set_content(body, "application/x-protobuf");
        }) {}
  std::string url() const { return server_.url(); }
  std::atomic<int> requests = 0;

 private:
  testing_support::LocalServer server_;
};

cv::Mat image(int seed) {
  cv::Mat small(6, 8, CV_8UC3), image;
  cv::RNG(static_cast<uint64_t>(seed)).fill(small, cv::RNG::UNIFORM, 0, 255);
  cv::resize(small, image, {160, 120}, 0, 0, cv::INTER_CUBIC);
  return image;
}

/// A scene of clusters with these images, cut out at (10, 20) of the image.
void show(cas::Cas& cas, const std::vector<cv::Mat>& images) {
  const types::SceneCas scene(cas);
  scene.create_scene();
  for (const cv::Mat& image : images) {
    const auto roi = types::StandaloneImageROI::create(cas);
    roi.roi.set(types::to(cas, cv::Rect(10, 20, image.cols, image.rows)));
    roi.image.set(types::to(cas, image));
    const auto cluster = types::Cluster::create(cas);
    cluster.hypotheses.push_back(roi);
    scene.add_cluster(cluster);
  }
}

/// Runs a flow of these steps, and returns what was warned of.
std::vector<std::string> run(const std::string& steps, cas::Cas& cas) {
  AnnotatorRegistry registry;
  add_annotators(registry);
  Flow flow = read_flow(Config::parse("flow:\n" + steps, "test"), "flow", registry);
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 2, {}};
  std::vector<Step*> all;
  collect_steps(flow, all);
  for (Step* step : all) step->start(context);
  run_flow(flow, cas, context);
  return warnings.texts();
}

std::string step(const std::string& url, const std::string& more = "") {
  return "  - VisualSearch: {server: '" + url + "', retry: 0, timeout_s: 10}\n" + more;
}

SearchResult result_of(SearchCategory category, const std::string& title, const Properties& properties = {}) {
  SearchResult result;
  result.category = category;
  result.title = title;
  result.region = {1, 2, 30, 40};
  result.properties = properties;
  return result;
}

TEST(VisualSearchAnnotator, EveryCategoryBecomesAnAnnotation) {
  SearchResult text = result_of(SearchCategory::kText, "Kaba Banane");
  text.words = {{"Kaba", {1, 2, 10, 5}, {}}, {"Banane", {12, 2, 15, 5}, {}}};
  text.translations = {"Kaba banana"};
  SearchResult code = result_of(SearchCategory::kBarcode, "4000000000001");
  code.category_text = "EAN-13 Barcode";
  const Server server(
      {result_of(SearchCategory::kProduct, "Kaba", {{"manufacturer", "Mondelez"}, {"confidence", "0.75"}}),
       text,
       result_of(SearchCategory::kBook, "A Book",
                 {{"authors", "Ann"}, {"publisher", "Press"}, {"year", "2014"}, {"isbn", "978"}}),
       result_of(SearchCategory::kLogo, "Kaba"),
       result_of(SearchCategory::kLandmark, "Tower", {{"location", "Paris"}}),
       result_of(SearchCategory::kSimilarImage, "Tin",
                 {{"image_url", "http://p"}, {"image_site", "http://s"}}),
       code,
       result_of(SearchCategory::kUserSubmitted, "my tin", {{"uploader", "Ann"}, {"user_text", "yellow"}})});
  cas::Cas cas(types::type_system());
  show(cas, {image(1)});
  EXPECT_THAT(run(step(server.url()), cas), ElementsAre());
  const types::Cluster cluster = types::SceneCas(cas).clusters().at(0);
  const auto& annotations = cluster.annotations;
  EXPECT_EQ(annotations.filter<types::VisualSearchAnnotation>().size(), 8U);
  const auto product = annotations.first<types::ProductAnnotation>();
  EXPECT_EQ(product.name.get(), "Kaba");
  EXPECT_DOUBLE_EQ(product.confidence.get(), 0.75);
  EXPECT_EQ(product.source.get(), "VisualSearch");
  EXPECT_EQ(types::KeyValue(product.properties[0]).key.get(), "manufacturer");
  const auto book = annotations.first<types::BookAnnotation>();
  EXPECT_EQ(book.name.get(), "A Book");
  EXPECT_EQ(book.authors.get() + book.publisher.get() + book.year.get() + book.isbn.get(), "AnnPress2014978");
  const auto read = annotations.first<types::TextAnnotation>();
  EXPECT_EQ(read.text.get(), "Kaba Banane");
  EXPECT_THAT(read.words.to_vector(), ElementsAre("Kaba", "Banane"));
  EXPECT_THAT(read.translations.to_vector(), ElementsAre("Kaba banana"));
  EXPECT_EQ(types::from<cv::Rect>(read.word_places[1].roi.get()), cv::Rect(22, 22, 15, 5));
  EXPECT_EQ(annotations.first<types::LogoAnnotation>().brand.get(), "Kaba");
  EXPECT_EQ(types::from<cv::Rect>(annotations.first<types::LogoAnnotation>().roi.get()),
            cv::Rect(11, 22, 30, 40));
  EXPECT_EQ(annotations.first<types::LandmarkAnnotation>().location.get(), "Paris");
  EXPECT_EQ(annotations.first<types::SimilarImageAnnotation>().site_url.get(), "http://s");
  EXPECT_EQ(annotations.first<types::BarcodeAnnotation>().symbology.get(), "EAN-13");
  EXPECT_EQ(annotations.first<types::BarcodeAnnotation>().code.get(), "4000000000001");
  EXPECT_EQ(annotations.first<types::UserSubmittedAnnotation>().text.get(), "yellow");
  EXPECT_EQ(annotations.first<types::TermsAnnotation>().terms.get()[0], "Kaba");
  EXPECT_TRUE(cluster.hypotheses.first<types::StandaloneImageROI>().phash.is_set());
}

TEST(VisualSearchAnnotator, RunsBesideTheOthers) {
  const Server server({result_of(SearchCategory::kLogo, "Kaba")});
  cas::Cas first(types::type_system());
  show(first, {image(1), image(2), image(3)});
  EXPECT_THAT(run(step(server.url(), "    asynchronous: true\n  - BarcodeReader\n"), first), ElementsAre());
  EXPECT_EQ(server.requests, 3);
  for (const types::Cluster& cluster : types::SceneCas(first).clusters()) {
    EXPECT_TRUE(cluster.annotations.first<types::LogoAnnotation>());
    EXPECT_TRUE(cluster.hypotheses.first<types::StandaloneImageROI>().phash.is_set());
  }
}

TEST(VisualSearchAnnotator, AServerThatIsAwayIsLeftToThePolicy) {
  std::string url;
  {
    const Server server({});
    url = server.url();
  }
  cas::Cas cas(types::type_system());
  show(cas, {image(1)});
  EXPECT_THROW(run(step(url), cas), Error);
  cas::Cas again(types::type_system());
  show(again, {image(1)});
  EXPECT_THAT(run(step(url, "    on_error: skip\n"), again), ElementsAre(HasSubstr("cannot be reached")));
}

TEST(VisualSearchAnnotator, AImageThatIsRefusedIsAWarning) {
  const Server server({}, 400);
  cas::Cas cas(types::type_system());
  show(cas, {image(1)});
  EXPECT_THAT(run(step(server.url()), cas), ElementsAre(HasSubstr("answered 400")));
}

TEST(VisualSearchAnnotator, NeedsAServer) {
  cas::Cas cas(types::type_system());
  show(cas, std::vector<cv::Mat>{});
  EXPECT_THROW(run("  - VisualSearch\n", cas), Error);
}

}  // namespace
}  // namespace loci::perception
