#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "mapping/base/files.h"
#include "mapping/base/math/random.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/image_features.h"
#include "perception/recognition/product_index.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;

const fs::path kData = fs::path(LOCI_SOURCE_DIR) / "tests/data";

ProductIndex sample_index(int threads = 2) {
  NoProgress progress;
  Warnings warnings;
  return ProductIndex::build(read_catalogue(kData / "products"), threads, progress, warnings);
}

fs::path scratch(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / ("loci_products_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  return folder / name;
}

/// A product held obliquely, small, before something else.
cv::Mat seen_obliquely(const cv::Mat& image, double turn_deg, double scale) {
  cv::Mat scene(480, 640, CV_8UC3, cv::Scalar(90, 110, 120)), map;
  map = cv::getRotationMatrix2D(cv::Point2f(99, 99), turn_deg, scale);
  map.at<double>(0, 2) += 200;
  map.at<double>(1, 2) += 120;
  cv::warpAffine(image, scene, map, scene.size(), cv::INTER_AREA, cv::BORDER_TRANSPARENT);
  return scene;
}

TEST(Products, AreRecognisedTurnedAndSmallAndBeforeSomethingElse) {
  const ProductIndex index = sample_index();
  for (const Product& product : index.products()) {
    if (product.name == "Golden-Delicious") continue;  // An apple has next to no texture.
    const cv::Mat scene = seen_obliquely(mapping::read_color(product.image), 130, 1.2);
    const auto matches = index.recognise(scene, {}, 2);
    ASSERT_FALSE(matches.empty()) << product.name;
    EXPECT_EQ(index.products()[matches[0].product].name, product.name);
    EXPECT_TRUE(matches[0].verified) << product.name;
    EXPECT_TRUE(matches[0].region.contains({299, 219})) << product.name << " " << matches[0].region;
  }
}

TEST(Products, WhatIsNoProductIsNotBelieved) {
  const ProductIndex index = sample_index();
  Random random(5);
  int believed = 0;
  for (int i = 0; i < 30; ++i) {  // Boxes and lines in many colours: features, but of nothing known.
    cv::Mat image(200, 200, CV_8UC3, cv::Scalar(90, 110, 120));
    const auto at = [&] {
      return cv::Point(static_cast<int>(random.index(200)), static_cast<int>(random.index(200)));
    };
    for (int k = 0; k < 40; ++k) {
      const cv::Scalar color(static_cast<double>(random.index(256)), static_cast<double>(random.index(256)),
                             static_cast<double>(random.index(256)));
      if (k % 2 == 0)
        cv::rectangle(image, at(), at(), color, 1 + k % 5);
      else
        cv::putText(image, std::string(1, static_cast<char>('A' + random.index(26))), at(), k % 8, 0.8,
                    color);
    }
    const auto matches = index.recognise(image, {}, 2);
    if (matches.empty() || !matches[0].verified) continue;
    ++believed;
    EXPECT_LT(matches[0].confidence(), 0.9);
  }
  EXPECT_LE(believed, 2);
}

TEST(SimilarityFit, ChanceBringsFewInliersButNotMany) {
  Random random(3);
  std::vector<Correspondence> pairs;
  const auto any = [&](double most) { return static_cast<float>(random.uniform(0, most)); };
  for (int i = 0; i < 200; ++i)
    pairs.push_back(
        {{any(200), any(200), 4 + any(12), any(6)}, {any(200), any(200), 4 + any(12), any(6)}, 1});
  const ImageFit chance = fit_images(pairs, 6);
  EXPECT_GT(log_false_alarms(pairs, chance, 6, {200, 200}, 40), -1);
  for (size_t i = 0; i < 20; ++i) {
    pairs[i].to = pairs[i].from;
    pairs[i].to.x += 3;
  }
  const ImageFit shifted = fit_images(pairs, 6);
  EXPECT_GE(shifted.inliers.size(), 20U);
  EXPECT_LT(log_false_alarms(pairs, shifted, 6, {200, 200}, 40), -5);
}

TEST(Products, APhotographIsRecognisedAndAnEmptyImageIsNothing) {
  const ProductIndex index = sample_index();
  const auto matches =
      index.recognise(mapping::read_color(kData / "images/Alpro-Blueberry-Soyghurt_001.jpg"), {}, 2);
  ASSERT_FALSE(matches.empty());
  EXPECT_EQ(index.products()[matches[0].product].name, "Alpro-Blueberry-Soyghurt");
  EXPECT_TRUE(index.recognise(cv::Mat(100, 100, CV_8UC3, cv::Scalar(200, 10, 10)), {}, 2).empty());
}

TEST(Products, TheAnswerDependsOnNoThreadsAndAKeptIndexAnswersAlike) {
  const ProductIndex index = sample_index(1), other = sample_index(3);
  const fs::path one = scratch("one"), two = scratch("two");
  index.save(one);
  other.save(two);
  EXPECT_EQ(read_file(one), read_file(two));
  const ProductIndex loaded = ProductIndex::load(one);
  const cv::Mat image = mapping::read_color(kData / "images/Alpro-Blueberry-Soyghurt_001.jpg");
  const auto a = index.recognise(image, {}, 1), b = loaded.recognise(image, {}, 3);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].product, b[i].product);
    EXPECT_EQ(a[i].score, b[i].score);
  }
  EXPECT_EQ(loaded.products()[0].properties, index.products()[0].properties);
}

TEST(Products, ADamagedIndexAndOtherFilesAreRefused) {
  const fs::path path = scratch("damaged");
  sample_index().save(path);
  std::string bytes = read_file(path);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_file_atomically(path, bytes);
  EXPECT_THROW(ProductIndex::load(path), Error);
  write_file_atomically(path, "hello");
  EXPECT_THROW(ProductIndex::load(path), Error);
}

TEST(Products, ABrokenImageIsLeftOutWithAWarning) {
  std::vector<Product> catalogue = read_catalogue(kData / "products");
  const fs::path broken = scratch("broken.jpg");
  write_file_atomically(broken, "no image");
  catalogue.push_back({"Broken", {}, broken});
  NoProgress progress;
  Warnings warnings;
  const ProductIndex index = ProductIndex::build(catalogue, 1, progress, warnings);
  EXPECT_EQ(index.products().size() + 1, catalogue.size());
  ASSERT_EQ(warnings.texts().size(), 1u);
  EXPECT_THAT(warnings.texts()[0], HasSubstr("broken.jpg"));
}

TEST(Products, DescriptionsBecomeKeysAndValues) {
  const Properties said = properties_of_text("Net Weight: 500 g\nIngredient: oats, salt\nKeep refrigerated.");
  EXPECT_THAT(said, Contains(Pair("weight", "500 g")));
  EXPECT_THAT(said, Contains(Pair("ingredients", "oats, salt")));
  EXPECT_THAT(said, Contains(Pair("perishable", "yes")));
  const Properties kept = properties_of_text("1.5 l of oat drink. Can be stored at room temperature.");
  EXPECT_THAT(kept, Contains(Pair("volume", "1.5 l")));
  EXPECT_THAT(kept, Contains(Pair("perishable", "no")));
  EXPECT_TRUE(properties_of_text("").empty());
  EXPECT_EQ(normalised_key("Nutrition Facts (per 100 g)"), "nutrition_facts_per_100_g");
}

TEST(Products, ColoursAgreeWithThemselvesAndNotWithOthers) {
  cv::Mat red(100, 100, CV_8UC3, cv::Scalar(30, 30, 200)), green(100, 100, CV_8UC3, cv::Scalar(30, 200, 30));
  const cv::Matx23d same(1, 0, 0, 0, 1, 0);
  const cv::Mat a = chroma_of(red, 48), b = chroma_of(green, 128);
  EXPECT_NEAR(color_agreement(a, red.size(), chroma_of(red, 128), red.size(), same), 1, 1e-9);
  EXPECT_LT(color_agreement(a, red.size(), b, green.size(), same), 0.01);
}

TEST(ImageFit, FindsTheMapAmongOutliers) {
  std::vector<Correspondence> pairs;
  for (int i = 0; i < 40; ++i) {
    const auto x = static_cast<float>(i % 8 * 20), y = static_cast<float>(i / 8 * 30);
    const bool outlier = i % 2 == 1;
    // Turned by 90 degrees and twice as large: (x, y) becomes (-2 y, 2 x).
    const Keypoint to{outlier ? static_cast<float>(i * 37 % 300) : 300 - 2 * y,
                      outlier ? static_cast<float>(i * 53 % 300) : 2 * x, 8, 1.5707963f};
    pairs.push_back({{x, y, 4, 0}, to, 1});
  }
  const ImageFit fit = fit_images(pairs, 3);
  EXPECT_GE(fit.inliers.size(), 20u);
  EXPECT_NEAR(fit.to_from_from(0, 1), -2, 0.05);
  EXPECT_NEAR(fit.to_from_from(1, 0), 2, 0.05);
  EXPECT_NEAR(fit.to_from_from(0, 2), 300, 3);
}

}  // namespace
}  // namespace loci::perception
