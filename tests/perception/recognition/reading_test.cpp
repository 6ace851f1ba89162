#include <gmock/gmock.h>

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

/// A photograph, blurred, in which ZBar alone finds nothing.
cv::Mat hard_barcode() {
  return mapping::read_color(std::filesystem::path(LOCI_SOURCE_DIR) / "tests/data/images/ean13.png");
}

TEST(Barcodes, APreparedImageIsReadWhereItIsNotAsItIs) {
  const cv::Mat image = hard_barcode();
  EXPECT_TRUE(read_barcodes(image, false).empty());
  const auto codes = read_barcodes(image);
  ASSERT_EQ(codes.size(), 1u);
  EXPECT_EQ(codes[0].symbology, "EAN-13");
  EXPECT_EQ(codes[0].code, "9780441014989");
  EXPECT_FALSE(codes[0].preparation.empty());
}

TEST(Barcodes, NoiseHoldsNone) {
  cv::Mat noise(240, 320, CV_8UC1);
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
