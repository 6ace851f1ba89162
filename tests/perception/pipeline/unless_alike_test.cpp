#include <gmock/gmock.h>

#include "tests/perception/pipeline/test_annotators.h"

namespace loci::perception {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// What a cluster looks like in a frame.
struct Look {
  int64_t hash = 0xF0F0;
  float lightness = 50;
  double x = 0;
  int width = 40;
};

/// A registry with Looker, which gives the first cluster of frames 10, 11, 12 these looks (the others get
/// none), and Counter, which counts what it is asked about, and says "heard N" and where in the image.
class UnlessAlike : public testing::Test {
 protected:
  UnlessAlike() {
    add_scripted(registry, {"Looker", "", {"Cluster"}, {"StandaloneImageROI", "StandaloneImageROI.phash"}},
                 [this](cas::Cas& cas, Context&) { look(cas); });
    add_scripted(registry, {"Counter", "", {"Cluster"}, {"TextAnnotation"}},
                 [this](cas::Cas& cas, Context&) { count(cas); });
  }

  void look(cas::Cas& cas) const {
    const types::SceneCas scene(cas);
    const Look& now = looks.at(static_cast<size_t>(scene.scene().frame_index.get() - 10));
    const types::Cluster cluster = scene.clusters().front();
    cluster.centroid.set(types::to(cas, Vector3d(now.x, 0, 0)));
    const auto roi = types::StandaloneImageROI::create(cas);
    roi.phash.set(now.hash);
    roi.cell_colors.set(std::vector<float>(48, now.lightness));
    const types::Rect rect = roi.roi.get_or_create();
    rect.x.set(100);
    rect.y.set(100);
    rect.width.set(now.width);
    rect.height.set(now.width);
    cluster.hypotheses.push_back(roi);
  }

  void count(cas::Cas& cas) {
    const types::SceneCas scene(cas);
    for (const types::Cluster& cluster : scene.clusters()) {
      ++asked;
      const auto text = types::TextAnnotation::create(cas);
      text.text.set("heard " + std::to_string(scene.scene().frame_index.get()));
      const types::Rect rect = text.roi.get_or_create();
      rect.x.set(110);
      rect.width.set(10);
      cluster.annotations.push_back(text);
    }
  }

  /// What was said about the first cluster, by frame.
  std::vector<std::string> first(const std::string& options = "{}") {
    asked = 0;
    run = run_test("flow: [Looker, {unless_alike: " + options + ", do: [Counter]}]", registry);
    std::vector<std::string> said;
    for (const auto& scene : run.words) said.push_back(scene[0]);
    return said;
  }

  std::vector<Look> looks{3};
  int asked = 0;
  TestRun run;
  AnnotatorRegistry registry = test_registry();
};

TEST_F(UnlessAlike, WhatLooksAsBeforeIsNotAskedAgain) {
  looks[1].hash ^= 0b11;
  EXPECT_THAT(first(), ElementsAre("heard 10", "heard 10", "heard 10"));
  EXPECT_EQ(asked, 3 * 3 + 1) << "clusters without a look are asked each time";
  EXPECT_EQ(run.result.statistics.at("Counter").reused, 2);
  EXPECT_THAT(run.json[0], ::testing::Not(HasSubstr("taken_from")));
  EXPECT_THAT(run.json[1], HasSubstr(R"("taken_from":10)"));
}

TEST_F(UnlessAlike, AnotherHashColourPlaceOrSizeIsAnotherLook) {
  const std::vector<std::string> changed = {"heard 10", "heard 11", "heard 10"};
  looks[1].hash = ~looks[1].hash;
  EXPECT_EQ(first(), changed);
  looks[1] = {};
  looks[1].lightness = 70;
  EXPECT_EQ(first(), changed);
  looks[1] = {};
  looks[1].x = 0.1;
  EXPECT_EQ(first(), changed);
  EXPECT_THAT(first("{place_m: 0.2}"), Each("heard 10"));
  looks[1] = {};
  looks[1].width = 60;
  EXPECT_EQ(first(), changed);
}

TEST_F(UnlessAlike, SmallStepsDoNotCreepIn) {
  for (int i = 0; i < 3; ++i) looks[static_cast<size_t>(i)].x = 0.04 * i;
  EXPECT_THAT(first(), ElementsAre("heard 10", "heard 10", "heard 12"));
}

TEST_F(UnlessAlike, RegionsMoveWithTheImage) {
  looks[1].width = 44;
  first();
  EXPECT_THAT(run.json[1], HasSubstr(R"("x":111,"y":-10,"width":11)"));
}

TEST_F(UnlessAlike, ForgetsTheOldest) {
  looks[1].hash = ~looks[1].hash;
  EXPECT_THAT(first("{remembered: 1}"), ElementsAre("heard 10", "heard 11", "heard 12"));
}

TEST_F(UnlessAlike, WhoFailedIsAskedAgain) {
  int calls = 0;
  add_scripted(registry, {"Counter", "", {"Cluster"}, {"TextAnnotation"}}, [&](cas::Cas& cas, Context&) {
    if (++calls == 1) throw Error("not yet");
    count(cas);
  });
  run = run_test("flow: [Looker, {unless_alike: {}, do: [{Counter: {}, on_error: skip}]}]", registry);
  EXPECT_THAT(run.words[0], Each(""));
  EXPECT_EQ(run.words[1][0], "heard 11");
  EXPECT_EQ(run.words[2][0], "heard 11");
}

TEST_F(UnlessAlike, RefusesWhatCannotBeTakenOver) {
  add_scripted(registry, {"Placer", "", {"Cluster"}, {}, {}, {"Cluster.place"}});
  add_scripted(registry, {"Finder", "", {"Cluster"}, {"Cluster"}});
  EXPECT_THAT(refusal_of("flow: [Looker, {unless_alike: {}, do: [Placer]}]", registry),
              HasSubstr("modify Cluster.place, but only annotations are copied back"));
  EXPECT_THAT(refusal_of("flow: [Looker, {unless_alike: {}, do: [Finder]}]", registry),
              HasSubstr("output Cluster, but only annotations are copied back"));
  EXPECT_THAT(refusal_of("flow: [{unless_alike: {}, do: [Counter]}]", registry),
              HasSubstr("'unless_alike' needs StandaloneImageROI.phash, which no earlier step outputs; "
                        "put Looker before it"));
  EXPECT_THAT(refusal_of("flow: [Looker, {unless_alike: {bit: 3}, do: [Counter]}]", registry),
              HasSubstr("bits"));
  EXPECT_THAT(refusal_of("flow: [Looker, {unless_alike: {}}]", registry), HasSubstr("without 'do'"));
}

TEST_F(UnlessAlike, ItsConfigurationIsAPipelineAgain) {
  const Json json =
      Pipeline::parse("flow: [Looker, {unless_alike: {bits: 3}, do: [Counter]}]", "p.yaml", registry)
          .to_json();
  EXPECT_EQ(json["flow"][1]["unless_alike"]["bits"], 3);
  EXPECT_EQ(Pipeline::parse(json.dump(), "again", registry).to_json(), json);
}

}  // namespace
}  // namespace loci::perception
