#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "apps/evaluate/system/experiment.h"
#include "apps/evaluate/system/household.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"

namespace loci::apps::system_evaluation {
namespace {

const std::filesystem::path kSamples = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples";

TEST(SceneCounts, HaveThePublishedHistogramsWhateverTheSeed) {
  for (const uint64_t seed : {1U, 2U, 77U}) {
    Histogram flat, solid, total;
    for (const SceneCount& count : scene_counts(103, Random(seed))) {
      ++flat[count.flat];
      ++solid[count.solid];
      ++total[count.flat + count.solid];
    }
    std::erase_if(total, [](const auto& entry) { return entry.second == 0; });
    EXPECT_EQ(flat, published_flat());
    EXPECT_EQ(solid, published_solid());
    EXPECT_EQ(total, published_total());
  }
}

TEST(SceneCounts, AddUpToThePublished587Observations) {
  int sum = 0;
  for (const SceneCount& count : scene_counts(103, Random(1))) sum += count.flat + count.solid;
  EXPECT_EQ(sum, 587);
}

TEST(Household, SetsUpWhatTheCountsSayOnBothCountersInTurn) {
  Warnings warnings;
  const auto map = perception::KnownMap::load(kSamples / "kitchen_l.urdf", {}, warnings);
  const std::vector<SceneCount> counts = {{6, 6}, {0, 3}, {2, 4}};
  const mapping::Scenario scenario =
      household_scenario(*map, household(kSamples / "labels"), counts, Random(3));
  ASSERT_EQ(scenario.scenes.size(), 3U);
  std::vector<std::string> counters;
  for (size_t i = 0; i < counts.size(); ++i) {
    int placed = 0;
    for (const mapping::Action& action : scenario.scenes[i].actions) {
      if (action.kind != mapping::Action::Kind::place) continue;
      ++placed;
      if (counters.size() <= i) counters.push_back(action.support);
      EXPECT_EQ(action.support, counters.back());
    }
    EXPECT_EQ(placed, counts[i].flat + counts[i].solid);
  }
  EXPECT_NE(counters[0], counters[1]);
  EXPECT_EQ(counters[0], counters[2]);
}

class SystemEvaluation : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("loci_system_" + std::to_string(getpid()));
    make_folder(folder);
    options.map = kSamples / "kitchen_l.urdf";
    options.scenes = 3;
    options.words = false;
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  SystemResult run(int threads) {
    options.threads = threads;
    Warnings warnings;
    return run_system(options, folder / std::to_string(threads), silent, warnings);
  }

  std::filesystem::path folder;
  SystemOptions options;
  NoProgress silent;
};

TEST_F(SystemEvaluation, FindsSolidThingsAndDescribesEveryCluster) {
  const SystemResult result = run(1);
  const KindScore solid = result.sum(false, true);
  ASSERT_GT(solid.there, 5U);
  EXPECT_GE(solid.found * 10, solid.there * 9);
  EXPECT_LE(result.false_clusters, 1U);
  for (const char* type : {"Cluster", "ReferenceClusterPoints", "StandaloneImageROI", "GeometryAnnotation",
                           "ColorHistogram", "TFLocationAnnotation"}) {
    const auto found = std::find_if(result.cluster_types.begin(), result.cluster_types.end(),
                                    [&](const TypeCount& each) { return each.type == type; });
    ASSERT_NE(found, result.cluster_types.end()) << type;
    EXPECT_EQ(found->count, result.clusters) << type;
  }
  const auto tracked = std::ranges::find(result.cluster_types, "TrackingAnnotation", &TypeCount::type);
  ASSERT_NE(tracked, result.cluster_types.end());
  EXPECT_GE(tracked->count, result.clusters) << "simple trackers vote beside who it is";
  EXPECT_NE(result.figure.find("GeometryAnnotation"), std::string::npos);
  EXPECT_GT(result.throughput.frames_per_second(), 0);
}

TEST_F(SystemEvaluation, TellsTheSameOnAnyNumberOfThreads) {
  Json one = json_of(run(1)), two = json_of(run(2));
  for (Json* json : {&one, &two})
    for (const char* measured : {"steps", "throughput"}) json->erase(measured);
  EXPECT_EQ(one, two);
}

}  // namespace
}  // namespace loci::apps::system_evaluation
