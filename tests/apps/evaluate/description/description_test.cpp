#include <gmock/gmock.h>

#include <filesystem>
#include <numeric>

#include "apps/evaluate/description/drawn_codes.h"
#include "apps/evaluate/description/reading.h"
#include "apps/evaluate/description/service.h"
#include "apps/evaluate/description/words.h"
#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"

namespace loci::apps::description_evaluation {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

const fs::path kData = fs::path(LOCI_SOURCE_DIR) / "tests/data";

TEST(DescriptionEvaluation, WordsAreComparedWithoutCaseAndSigns) {
  EXPECT_EQ(folded("ÄPPLE,"), folded("äpple"));
  EXPECT_EQ(folded("Mild!"), "mild");
  EXPECT_NE(folded("Mjölk"), folded("Mjolk"));
  EXPECT_THAT(folded_words("God-Morgon_Juice"), ElementsAre("god", "juice", "morgon"));
}

TEST(DescriptionEvaluation, CodesThatAreReadMissedAndWrongAreCounted) {
  const TemporaryFolder temporary("loci_test");
  const fs::path& folder = temporary.path();
  fs::create_directories(folder / "images");
  fs::copy_file(kData / "images/ean13.png", folder / "images/right.png",
                fs::copy_options::overwrite_existing);
  fs::copy_file(kData / "images/ean13.png", folder / "images/other.png",
                fs::copy_options::overwrite_existing);
  write_file_atomically(
      folder / "expected.csv",
      "file,symbology,text\nright.png,EAN-13,9780441014989\nother.png,EAN-13,4000000000006\n");
  NoProgress progress;
  const ReadingResult result = evaluate_reading(folder, "", progress);
  EXPECT_EQ(result.codes.at("EAN-13").images, 2);
  EXPECT_EQ(result.codes.at("EAN-13").right, 1);
  EXPECT_EQ(result.wrong, 1);
  EXPECT_THAT(result.missed, ElementsAre("other.png"));
}

TEST(DescriptionEvaluation, DrawnCodesAreReadAsDistorted) {
  if (!can_draw_codes()) GTEST_SKIP() << "zint is not installed";
  NoProgress progress;
  const DrawnCodesResult result = evaluate_drawn_codes(progress, {"Aztec", "Data Matrix"});
  EXPECT_EQ(result.all.images, 26);
  EXPECT_GE(result.all.right, 20);
  EXPECT_EQ(result.wrong, 0);
  EXPECT_EQ(result.by_distortion.at("upside down").right, 2);
}

TEST(DescriptionEvaluation, OurServiceIsAskedAboutEveryImage) {
  NoProgress progress;
  Warnings warnings;
  const ServiceResult result = evaluate_service(kData / "products", "", 1, 2, progress, warnings);
  EXPECT_GT(result.images, 0);
  EXPECT_EQ(static_cast<int>(result.seconds.size()), result.images);
  EXPECT_EQ(std::accumulate(result.relevant.begin(), result.relevant.end(), 0), result.images);
  EXPECT_GT(result.categories.at("Product"), 0);
  EXPECT_EQ(result.alike_asked, result.images);
}

}  // namespace
}  // namespace loci::apps::description_evaluation
