// What happened to real objects between snapshots, beside a greedy matcher.

#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci {
namespace {

namespace fs = std::filesystem;
using apps::test::run;

TEST(RealChanges, OfTableScenesAreTold) {
  LOCI_NEEDS_SHARED("data/osd_scenes");
  const fs::path folder = apps::test::fresh_folder();
  int certain = 0, right = 0, greedy = 0;
  for (const char* name : {"osd_mixed", "osd_stacked", "osd_occluded"}) {
    fs::copy(fs::path(LOCI_SOURCE_DIR) / "tests/data/changes" / name, folder / name);
    for (const auto& image : fs::directory_iterator(apps::test::shared("data/osd_scenes")))
      if (image.path().extension() == ".png")
        fs::create_symlink(image.path(), folder / name / image.path().filename());
    const auto outcome = run("loci-evaluate changes --json " + (folder / name).string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const Json methods = parse_json(outcome.out, name).at("methods");
    certain += methods.at("loci").at("certain").get<int>();
    right += methods.at("loci").at("right").get<int>();
    greedy += methods.at("greedy").at("right").get<int>();
  }
  EXPECT_EQ(certain, 62);
  EXPECT_GE(right, 46) << "three of four";
  EXPECT_GE(right, greedy + 12);
}

}  // namespace
}  // namespace loci
