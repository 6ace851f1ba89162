#include <gtest/gtest.h>

#include <set>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/support/box_table.h"

namespace loci::apps::test {
namespace {

using loci::test::table_camera;

TEST(Detections2D, NameTheClustersOfAPipeline) {
  const std::string folder = fresh_folder();
  loci::test::record_table(
      folder + "/recording", 1, [](int64_t) { return loci::test::BoxTable{table_camera(0.15)}; },
      [](int64_t) { return std::optional(table_camera(0.15)); });
  // The boxes left and right of the middle, in fractions of the image, and one outside of what has depth.
  make_folder(folder + "/yolo");
  write_file_atomically(folder + "/yolo/classes.txt", "mug\ntea\n");
  write_file_atomically(folder + "/yolo/000000.txt",
                        "0 0.34 0.53 0.13 0.17 0.9\n1 0.66 0.53 0.13 0.17 0.8\n");
  write_file_atomically(folder + "/pipeline.yaml",
                        "flow:\n  - NormalEstimator\n  - PlaneClusterExtractor\n"
                        "  - Detections2D: {detections: " +
                            folder + "/yolo}\n");
  const Outcome outcome =
      run("loci-perceive run " + folder + "/recording --json --pipeline " + folder + "/pipeline.yaml");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  std::set<std::string> labels;
  const Json clusters = parse_json(outcome.out, "run")["scenes"][0]["clusters"];
  for (const Json& cluster : clusters)
    for (const Json& annotation : cluster["annotations"])
      if (annotation["type"] == "ClassificationAnnotation") labels.insert(annotation["label"]);
  EXPECT_EQ(labels, (std::set<std::string>{"mug", "tea"})) << outcome.out;
}

TEST(Detections2D, NeedDetections) {
  const std::string folder = fresh_folder();
  loci::test::record_table(
      folder + "/recording", 1, [](int64_t) { return loci::test::BoxTable{table_camera(0.15)}; },
      [](int64_t) { return std::optional(table_camera(0.15)); });
  write_file_atomically(folder + "/pipeline.yaml", "flow:\n  - NormalEstimator\n  - Detections2D\n");
  const Outcome outcome =
      run("loci-perceive run " + folder + "/recording --pipeline " + folder + "/pipeline.yaml");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.error.find("Detections2D has no detections"), std::string::npos) << outcome.error;
}

}  // namespace
}  // namespace loci::apps::test
