#include <gmock/gmock.h>

#define ZX_USE_UTF8 1
#include <ZXing/BitMatrix.h>
#include <ZXing/MultiFormatWriter.h>

#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/barcode_reader.h"
#include "perception/recognition/text_reader.h"

namespace loci::perception {
namespace {

using ::testing::Contains;
using ::testing::Field;

/// A photograph, blurred.
cv::Mat hard_barcode() {
  return mapping::read_color(std::filesystem::path(LOCI_SOURCE_DIR) / "tests/data/images/ean13.png");
}

TEST(Barcodes, APreparedImageIsReadWhereItIsNotAsItIs) {
  cv::Mat image = hard_barcode();
  cv::resize(image, image, {}, 0.8, 0.8, cv::INTER_AREA);
  EXPECT_TRUE(read_barcodes(image, false).empty());
  const auto codes = read_barcodes(image);
  ASSERT_EQ(codes.size(), 1u);
  EXPECT_EQ(codes[0].symbology, "EAN-13");
  EXPECT_EQ(codes[0].code, "9780441014989");
  EXPECT_FALSE(codes[0].preparation.empty());
}

/// A code as ZXing draws it, black on white.
cv::Mat drawn_code(ZXing::BarcodeFormat format, const std::string& content, int width, int height) {
  const ZXing::Matrix<uint8_t> bits =
      ZXing::ToMatrix<uint8_t>(ZXing::MultiFormatWriter(format).setMargin(20).encode(content, width, height));
  cv::Mat image(bits.height() + 80, bits.width() + 80, CV_8UC1, cv::Scalar(255));
  cv::Mat(bits.height(), bits.width(), CV_8UC1, const_cast<uint8_t*>(bits.data()))
      .copyTo(image(cv::Rect(40, 40, bits.width(), bits.height())));
  return image;
}

TEST(Barcodes, CodesOfAreasAreReadInAnyOrientation) {
  for (const auto& [format, name] :
       {std::pair(ZXing::BarcodeFormat::DataMatrix, "Data Matrix"),
        std::pair(ZXing::BarcodeFormat::PDF417, "PDF417"), std::pair(ZXing::BarcodeFormat::Aztec, "Aztec")}) {
    const cv::Mat image = drawn_code(format, "Best before 2026-11-23", 240, 240);
    for (const double turn : {0.0, 90.0, 180.0, 30.0}) {
      cv::Mat seen;
      const cv::Point2f middle(static_cast<float>(image.cols) / 2, static_cast<float>(image.rows) / 2);
      cv::warpAffine(image, seen, cv::getRotationMatrix2D(middle, turn, 0.8), image.size(), cv::INTER_LINEAR,
                     cv::BORDER_CONSTANT, cv::Scalar(255));
      const auto codes = read_barcodes(seen);
      ASSERT_EQ(codes.size(), 1U) << name << " turned by " << turn;
      EXPECT_EQ(codes[0].symbology, name);
      EXPECT_EQ(codes[0].code, "Best before 2026-11-23");
      EXPECT_FALSE((codes[0].region & cv::Rect({}, image.size())).empty());
    }
  }
}

TEST(Barcodes, WhatBothReadersReadIsReportedOnce) {
  const cv::Mat image = drawn_code(ZXing::BarcodeFormat::UPCA, "036000291452", 240, 100);
  const auto codes = read_barcodes(image);
  ASSERT_EQ(codes.size(), 1U);
  EXPECT_EQ(codes[0].symbology, "UPC-A");
}

TEST(Barcodes, NoiseHoldsNone) {
  cv::Mat noise(120, 160, CV_8UC1);
  cv::RNG random(3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_TRUE(read_barcodes(noise).empty());
}

TEST(Text, PrintedWordsAreReadWhereTheyStand) {
  cv::Mat image(200, 500, CV_8UC3, cv::Scalar(255, 255, 255));
  cv::putText(image, "Vanilla", {60, 110}, cv::FONT_HERSHEY_SIMPLEX, 2, cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
  const auto words = TextReader().read(image);
  ASSERT_THAT(words, Contains(Field(&TextWord::text, "Vanilla")));
  for (const TextWord& word : words)
    if (word.text == "Vanilla") {
      EXPECT_NEAR(word.region.x, 60, 12);
      EXPECT_NEAR(word.region.br().y, 110, 12);
    }
}

/// A label of two words that is turned clockwise.
cv::Mat turned_label(const std::vector<std::string>& words, double degrees) {
  cv::Mat label(140, 220, CV_8UC3, cv::Scalar(235, 240, 240)),
      image(300, 300, CV_8UC3, cv::Scalar(200, 210, 215));
  for (size_t i = 0; i < words.size(); ++i)
    cv::putText(label, words[i], {10, 55 + static_cast<int>(i) * 55}, cv::FONT_HERSHEY_DUPLEX, 1.2,
                {30, 20, 60}, 2, cv::LINE_AA);
  cv::Mat image_from_label = cv::getRotationMatrix2D({110, 70}, -degrees, 1);
  image_from_label.at<double>(0, 2) += 40;
  image_from_label.at<double>(1, 2) += 80;
  cv::warpAffine(label, image, image_from_label, image.size(), cv::INTER_AREA, cv::BORDER_TRANSPARENT);
  cv::GaussianBlur(image, image, {}, 0.7);
  return image;
}

TEST(Text, IsReadInAnyOrientation) {
  const TextReader reader;
  const std::vector<std::vector<std::string>> labels = {
      {"ORGANIC", "MILK"}, {"PEPPER", "sauce"}, {"garden", "honey"}};
  size_t all = 0, read = 0;
  double off_by = 3;
  for (const std::vector<std::string>& label : labels) {
    for (int degrees = 0; degrees < 360; degrees += 45) {
      const std::vector<TextWord> found = reader.read(turned_label(label, degrees + off_by));
      for (const std::string& word : label) {
        const auto hit = std::ranges::find(found, word, &TextWord::text);
        ++all;
        if (hit == found.end()) continue;
        ++read;
        EXPECT_TRUE(cv::Rect(20, 20, 260, 260).contains((hit->region.tl() + hit->region.br()) / 2));
      }
    }
    off_by -= 4;
  }
  std::printf("turned labels: %zu of %zu words read\n", read, all);
  EXPECT_GE(read * 100, all * 90);
}

TEST(Text, WordsAreRankedByHowOftenTheyOccur) {
  const auto ranked = rank_words({{"http://milk.com", 0.9, {}},
                                  {"MILK", 0.8, {}},
                                  {"oat", 0.7, {}},
                                  {"1l", 0.9, {}},
                                  {"Bar", 0.95, {}}});
  ASSERT_EQ(ranked.size(), 3u);
  EXPECT_EQ(ranked[0].word, "milk");
  EXPECT_EQ(ranked[0].count, 2);
  EXPECT_EQ(ranked[1].word, "Bar");
  EXPECT_EQ(ranked[2].word, "oat");
}

TEST(Text, ALanguageWithoutDataIsRefused) {
  EXPECT_THROW(TextReader("xx-none"), Error);
}

}  // namespace
}  // namespace loci::perception
