#include <gmock/gmock.h>

#include <filesystem>

#include "mapping/base/config.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/description/recognition_annotators.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

const fs::path kTestData = fs::path(LOCI_SOURCE_DIR) / "tests/data";

/// A scene of one cluster with this image, cut out at (10, 20) of the image.
void show(cas::Cas& cas, const cv::Mat& image) {
  const types::SceneCas scene(cas);
  scene.create_scene();
  const auto roi = types::StandaloneImageROI::create(cas);
  roi.roi.set(types::to(cas, cv::Rect(10, 20, image.cols, image.rows)));
  roi.image.set(types::to(cas, image));
  const auto cluster = types::Cluster::create(cas);
  cluster.hypotheses.push_back(roi);
  scene.add_cluster(cluster);
}

types::Cluster annotated(const std::string& name, const Json& options, const cv::Mat& image, cas::Cas& cas) {
  AnnotatorRegistry registry;
  add_annotators(registry);
  const auto annotator = registry.make(name);
  OptionTable table;
  annotator->declare(table);
  table.read(Config::parse(options.dump(), "options"));
  show(cas, image);
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 2, {}};
  annotator->start(context);
  annotator->process(cas, context);
  return types::SceneCas(cas).clusters().at(0);
}

TEST(RecognitionAnnotators, AProductComesWithWhatTheCatalogueSays) {
  const TemporaryFolder folder("loci_test");
  const fs::path index = folder.path() / "products.index";
  NoProgress progress;
  Warnings warnings;
  ProductIndex::build(read_catalogue(kTestData / "products"), 2, progress, warnings).save(index);
  cas::Cas cas(types::type_system());
  const auto cluster =
      annotated("ProductRecognition", {{"index", index.string()}},
                mapping::read_color(kTestData / "images/Alpro-Blueberry-Soyghurt_001.jpg"), cas);
  const auto product = cluster.annotations.first<types::ProductAnnotation>();
  ASSERT_TRUE(product);
  EXPECT_EQ(product.name.get(), "Alpro-Blueberry-Soyghurt");
  EXPECT_EQ(cluster.annotations.first<types::ClassificationAnnotation>().label.get(), "soyghurt");
}

TEST(RecognitionAnnotators, AProductNeedsAnIndex) {
  cas::Cas cas(types::type_system());
  EXPECT_THROW(annotated("ProductRecognition", Json::object(), cv::Mat(9, 9, CV_8UC3, cv::Scalar(1)), cas),
               Error);
}

TEST(RecognitionAnnotators, ABarcodeLiesInTheSceneWhereItIsOnTheObject) {
  cas::Cas cas(types::type_system());
  const auto cluster = annotated("BarcodeReader", {{"thorough", true}},
                                 mapping::read_color(kTestData / "images/ean13.png"), cas);
  const auto code = cluster.annotations.first<types::BarcodeAnnotation>();
  ASSERT_TRUE(code);
  EXPECT_EQ(code.code.get(), "9780441014989");
  EXPECT_GE(types::from<cv::Rect>(code.roi.get()).y, 20);
}

TEST(RecognitionAnnotators, OneTextForEachWord) {
  cas::Cas cas(types::type_system());
  const cv::Mat image = mapping::read_color(kTestData / "products/Oatly-Oat-Milk.jpg");
  const auto cluster = annotated("TextReader", {{"min_confidence", 0}}, image, cas);
  const auto text = cluster.annotations.first<types::TextAnnotation>();
  ASSERT_TRUE(text);
  EXPECT_EQ(text.words.size(), 1u);
}

}  // namespace
}  // namespace loci::perception
