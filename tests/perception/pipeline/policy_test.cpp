#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <thread>

#include "tests/perception/pipeline/test_annotators.h"

namespace loci::perception {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

int64_t frame_of(cas::Cas& cas) {
  return types::SceneCas(cas).scene().frame_index.get();
}

/// Speaks, and throws at frame 11 after it has spoken; `left` says how often.
AnnotatorRegistry registry_with_failing(const std::shared_ptr<std::atomic<int>>& left) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Failing", "", {"Cluster"}, {"TextAnnotation"}}, [left](cas::Cas& cas, Context&) {
    for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) Scripted::say(cluster, "half");
    if (frame_of(cas) == 11 && (*left)-- > 0) throw Error("the lamp is out");
  });
  return registry;
}

std::shared_ptr<std::atomic<int>> times(int count) {
  return std::make_shared<std::atomic<int>>(count);
}

TEST(Policy, FailsByDefault) {
  EXPECT_EQ(refusal_of("flow: [Failing]", registry_with_failing(times(1))),
            "Failing failed at frame 11: the lamp is out");
}

TEST(Policy, SkipsTheAnnotatorAndTakesBackWhatItDid) {
  for (const std::string more : {"", ", asynchronous: true", ", timeout_s: 60"}) {
    const TestRun run = run_test("flow: [{Failing: {}, on_error: skip" + more + "}, {Speaker: {word: a}}]",
                                 registry_with_failing(times(1)));
    ASSERT_EQ(run.words.size(), 3U);
    EXPECT_THAT(run.words[0], Each(HasSubstr("half")));
    EXPECT_THAT(run.words[1], Each("a"));
    EXPECT_THAT(run.warnings,
                ElementsAre("Failing failed at frame 11: the lamp is out; the scene goes on without it"));
    EXPECT_EQ(run.result.statistics.at("Failing").failures, 1);
    EXPECT_EQ(run.result.statistics.at("Failing").scenes, 3);
  }
}

TEST(Policy, SkipsTheScene) {
  const TestRun run =
      run_test("flow: [{Failing: {}, on_error: skip_scene}]", registry_with_failing(times(1)));
  EXPECT_EQ(run.words.size(), 2U);
  EXPECT_EQ(run.result.frames, 2U);
  EXPECT_EQ(run.result.left_out, 1U);
  EXPECT_THAT(run.warnings, ElementsAre(HasSubstr("the scene is left out")));
}

TEST(Policy, TriesAgain) {
  const TestRun run = run_test("flow: [{Failing: {}, retry: 2}]", registry_with_failing(times(2)));
  EXPECT_THAT(run.words, Each(Each("half")));  // once, not three times
  EXPECT_EQ(run.result.statistics.at("Failing").retries, 2);
  EXPECT_EQ(run.result.statistics.at("Failing").failures, 0);
  EXPECT_THAT(refusal_of("flow: [{Failing: {}, retry: 2}]", registry_with_failing(times(3))),
              HasSubstr("the lamp is out"));
}

TEST(Policy, ExceptionsOfOthersAreErrorsInOneLine) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Foreign", "", {}, {}},
               [](cas::Cas&, Context&) { throw std::runtime_error("one\ntwo"); });
  add_scripted(registry, {"Odd", "", {}, {}}, [](cas::Cas&, Context&) { throw 5; });
  EXPECT_EQ(refusal_of("flow: [Foreign]", registry), "Foreign failed at frame 10: one two");
  EXPECT_EQ(refusal_of("flow: [Odd]", registry), "Odd failed at frame 10: an unknown exception");
}

TEST(Policy, ANumberThatIsNoneIsAFailure) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"NotANumber", "", {"Cluster"}, {"GeometryAnnotation"}},
               [](cas::Cas& cas, Context&) {
                 const auto geometry = types::GeometryAnnotation::create(cas);
                 geometry.height.set(std::numeric_limits<double>::quiet_NaN());
                 types::SceneCas(cas).clusters()[0].annotations.push_back(geometry);
               });
  add_scripted(registry, {"NotAVector", "", {"Cluster"}, {"PclFeatureAnnotation"}},
               [](cas::Cas& cas, Context&) {
                 const auto feature = types::PclFeatureAnnotation::create(cas);
                 feature.feature.set({1.F, std::numeric_limits<float>::infinity()});
                 types::SceneCas(cas).clusters()[0].annotations.push_back(feature);
               });
  EXPECT_EQ(refusal_of("flow: [NotANumber]", registry),
            "NotANumber failed at frame 10: GeometryAnnotation.height is not a finite number");
  EXPECT_THAT(refusal_of("flow: [NotAVector]", registry), HasSubstr("PclFeatureAnnotation.feature"));
  const TestRun run = run_test("flow: [{NotANumber: {}, on_error: skip}, Speaker]", registry);
  EXPECT_THAT(run.words, Each(Each("?")));
}

TEST(Policy, WhatHangsIsLeftBehind) {
  AnnotatorRegistry registry = test_registry();
  const auto released = std::make_shared<std::atomic<bool>>(false);
  const auto hanging = std::make_shared<std::atomic<int>>(0);
  add_scripted(registry, {"Hanging", "", {"Cluster"}, {"TextAnnotation"}},
               [released, hanging](cas::Cas& cas, Context&) {
                 if (frame_of(cas) == 11) {
                   ++*hanging;
                   while (!*released) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                   --*hanging;
                 }
                 for (const types::Cluster& cluster : types::SceneCas(cas).clusters())
                   Scripted::say(cluster, "late");
               });
  const TestRun run =
      run_test("flow: [{Hanging: {}, on_error: skip, timeout_s: 0.2}, {Speaker: {word: a}}]", registry);
  ASSERT_EQ(run.words.size(), 3U);
  EXPECT_THAT(run.words[0], Each("late a"));
  EXPECT_THAT(run.words[1], Each("a"));
  EXPECT_THAT(run.words[2], Each("late a"));
  EXPECT_THAT(run.warnings, ElementsAre(HasSubstr("it took longer than 0.2 s")));
  EXPECT_EQ(run.result.statistics.at("Hanging").timeouts, 1);
  EXPECT_EQ(*hanging, 1);  // It hangs still, with everything that it may touch.
  *released = true;
  while (*hanging > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(Policy, AnnotatorsWithALimitDoNotHoldWhatIsToBeClosed) {
  Resources resources;
  resources.put(std::make_shared<int>(1));
  resources.put_for_run(std::make_shared<double>(2.0));
  EXPECT_NE(resources.find<double>(), nullptr);
  EXPECT_NE(resources.lasting().find<int>(), nullptr);
  EXPECT_EQ(resources.lasting().find<double>(), nullptr);
}

TEST(Policy, CountsWhatAnnotatorsSay) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Reader", "", {"Cluster"}, {"TextAnnotation"}}, [](cas::Cas& cas, Context&) {
    const auto text = types::TextAnnotation::create(cas);
    text.confidence.set(0.5);
    types::SceneCas(cas).clusters()[0].annotations.push_back(text);
  });
  const AnnotatorStatistics statistics = run_test("flow: [Reader]", registry).result.statistics.at("Reader");
  EXPECT_EQ(statistics.scenes, 3);
  EXPECT_EQ(statistics.clusters, 12);
  EXPECT_DOUBLE_EQ(statistics.answer_rate("TextAnnotation", 1), 0.25);
  EXPECT_DOUBLE_EQ(statistics.confidence("TextAnnotation", 1), 0.5);
  EXPECT_DOUBLE_EQ(statistics.confidence("ColorAnnotation", 0.7), 0.7);
}

TEST(Statistics, AreKeptOverRuns) {
  const auto path = std::filesystem::path(testing::TempDir()) / "kept.statistics.json";
  std::filesystem::remove(path);
  EXPECT_TRUE(read_statistics(path).empty());
  AnnotatorStatistics run;
  run.scenes = 2;
  run.clusters = 4;
  run.seconds = 0.5;
  run.products["TextAnnotation"] = {3, 2, 1.5};
  add_to_statistics(path, {{"Reader", run}});
  add_to_statistics(path, {{"Reader", run}, {"Other", run}});
  const StatisticsTable table = read_statistics(path);
  ASSERT_THAT(table, SizeIs(2));
  EXPECT_EQ(table.at("Reader").scenes, 4);
  EXPECT_DOUBLE_EQ(table.at("Reader").seconds_per_scene(), 0.25);
  EXPECT_EQ(table.at("Reader").products.at("TextAnnotation").made, 6);
  EXPECT_THAT(
      statistics_text(table.at("Other")),
      HasSubstr("2 scenes, 250.0 ms each; 3 TextAnnotation (75 % of 4 clusters), mean confidence 0.75"));
}

}  // namespace
}  // namespace loci::perception
