#include "perception/detection/image_region.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/image/image_io.h"

namespace loci::perception {
namespace {

using nlohmann::json;

ImageRegion mask_of(const std::string& text, const std::filesystem::path& folder = {}) {
  return region_from_mask(json::parse(text), "mask", folder);
}

int pixels(const ImageRegion& region) {
  return cv::countNonZero(region.mask);
}

TEST(ImageRegion, RunLengthsGoDownTheColumns) {
  // 3 x 4 pixels (height, width): background 4, object 2, background 6.
  const ImageRegion region = mask_of(R"({"size": [3, 4], "counts": [4, 2, 6]})");
  EXPECT_EQ(region.image, cv::Size(4, 3));
  EXPECT_EQ(region.box, cv::Rect2d(1, 1, 1, 2));
  EXPECT_TRUE(region.contains(1.5, 1.5));
  EXPECT_TRUE(region.contains(1.5, 2.5));
  EXPECT_FALSE(region.contains(1.5, 0.5));
  EXPECT_FALSE(region.contains(2.5, 1.5));
}

TEST(ImageRegion, CompressedRunLengthsAreThoseOfPycocotools) {
  // pycocotools: a block of 20 x 10 pixels at (5, 3) of an image of 40 x 30 encodes to this text.
  const std::vector<uint32_t> block = runs_from_text("i4:d00000000000000000000000000000000000000o=", "mask");
  EXPECT_EQ(block[0], 153U);
  EXPECT_EQ(block[1], 10U);
  // Runs from the third on are differences to the one before the last: 6 1 40 4 5 4 5 4 21.
  EXPECT_EQ(runs_from_text("61X13mN000`0", "mask"), (std::vector<uint32_t>{6, 1, 40, 4, 5, 4, 5, 4, 21}));
}

TEST(ImageRegion, PolygonsCoverWhatTheyOutline) {
  const ImageRegion region = mask_of("[[10, 20, 30, 20, 30, 40, 10, 40]]");
  EXPECT_NEAR(pixels(region), 400, 45);
  EXPECT_TRUE(region.contains(20, 30));
  EXPECT_FALSE(region.contains(8, 30));
  EXPECT_NEAR(region.box.x, 10, 1);
  EXPECT_NEAR(region.box.width, 20, 2);
}

TEST(ImageRegion, MaskImageBelowTheFolder) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("loci_mask_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  cv::Mat image = cv::Mat::zeros(30, 40, CV_8U);
  image(cv::Rect(5, 3, 20, 10)) = 255;
  mapping::write_image(folder / "mug.png", image);
  const ImageRegion region = mask_of("\"mug.png\"", folder);
  EXPECT_EQ(region.box, cv::Rect2d(5, 3, 20, 10));
  EXPECT_EQ(pixels(region), 200);
  EXPECT_THROW(mask_of("\"../mug.png\"", folder), Error);
  EXPECT_THROW(mask_of("\"/etc/passwd\"", folder), Error);
  EXPECT_THROW(mask_of("\"none.png\"", folder), Error);
  std::filesystem::remove_all(folder);
}

TEST(ImageRegion, HostileMasksAreRefused) {
  for (const char* text : {
           R"({"size": [3, 4], "counts": [4, 2, 7]})",                     // beyond the image
           R"({"size": [3, 4], "counts": [4, 2]})",                        // too short
           R"({"size": [3, 4], "counts": [12]})",                          // empty
           R"({"size": [3, 4], "counts": [4, 4294967295, 9]})",            // overflow
           R"({"size": [3, 4], "counts": [4, 18446744073709551615, 9]})",  // overflow
           R"({"size": [3, 4], "counts": [4, -1, 9]})",
           R"({"size": [3, 4], "counts": [4.5, 1, 9]})",
           R"({"size": [0, 4], "counts": []})",
           R"({"size": [20000, 20000], "counts": [0, 400000000]})",  // needs too much memory
           R"({"size": [100000, 100000], "counts": [1]})",
           R"({"size": [3, 4], "counts": "ooooooooooooooooooooo"})",
           R"({"size": [3, 4], "counts": "\u0001"})",
           R"({"size": [3], "counts": "4"})",
           R"({"counts": "4"})",
           "[]",
           "[[1, 2, 3, 4]]",
           "[[1, 2, 3, 4, 5]]",
           "[[1, 2, 3, 4, 5, 1e300]]",
           "[[0, 0, 19999, 0, 19999, 19999, 0, 19999]]",
           "[[1, 2, 3, 4, \"a\", 6]]",
           "7",
           "null",
       })
    EXPECT_THROW(mask_of(text), Error) << text;
}

TEST(ImageRegion, HostileBoxesAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const json& box : {json{1, 2, 3}, json{1, 2, 0, 4}, json{1, 2, -3, 4}, json{1, 2, 3, 1e9},
                          json{1, 2, nan, 4}, json("box"), json{1, 2, 3, "4"}})
    EXPECT_THROW(region_from_box(box, "bbox"), Error) << box;
  EXPECT_EQ(region_from_box({1, 2, 3, 4}, "bbox").box, cv::Rect2d(1, 2, 3, 4));
}

}  // namespace
}  // namespace loci::perception
