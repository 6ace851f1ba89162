#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/perception/pipeline/test_annotators.h"

namespace loci::perception {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Flow, SendsClustersThroughTheBranchOfACondition) {
  const TestRun run = run_test(R"(flow:
  - if: "GeometryAnnotation.height > 0.02"
    then: [{Speaker: {word: solid}}]
    else: [{Speaker: {word: flat}}]
)",
                               test_registry());
  ASSERT_EQ(run.words.size(), 3U);
  EXPECT_THAT(run.words, Each(ElementsAre("flat", "solid", "solid", "solid")));
}

TEST(Flow, DoesNotRunABranchThatNoClusterGoesThrough) {
  AnnotatorRegistry registry = test_registry();
  int runs = 0;
  add_scripted(registry, {"Counter", "Counts.", {"Cluster"}, {}}, [&](cas::Cas&, Context&) { ++runs; });
  run_test("flow: [{if: 'Geometry.height > 1', then: [Counter]}]", registry);
  EXPECT_EQ(runs, 0);
  run_test("flow: [{if: 'Geometry.height > 0.1', then: [Counter]}]", registry);
  EXPECT_EQ(runs, 3);
}

TEST(Flow, ConditionsAboutTheSceneDecideForAll) {
  const TestRun run = run_test(R"(flow:
  - if: "Scene.frame_index == 11"
    then: [{Speaker: {word: second}}]
)",
                               test_registry());
  EXPECT_THAT(run.words, ElementsAre(Each(""), Each("second"), Each("")));
}

TEST(Flow, SendsPlacesThroughTheBranchOfTheFirstPatternThatMatches) {
  const TestRun run = run_test(R"(flow:
  - regions:
      counter_1: [{Speaker: {word: left}}]
      "counter*": [{Speaker: {word: counter}}]
      "table*": [{Speaker: {word: table}}]
)",
                               test_registry());
  EXPECT_THAT(run.words, Each(ElementsAre("left", "counter", "table", "")));
}

TEST(Flow, BranchesNest) {
  const TestRun run = run_test(R"(engines:
  speak: [{Speaker: {word: a}}, {Speaker: {word: b}}]
flow:
  - regions:
      "counter*":
        - if: "Geometry.height < 0.02"
          then: [speak]
      "*": [{Speaker: {word: c}}]
)",
                               test_registry());
  EXPECT_THAT(run.words, Each(ElementsAre("a b", "", "c", "c")));
}

TEST(Flow, NewClustersOfABranchBelongToTheScene) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Finder", "Finds.", {"Cluster"}, {"Cluster"}}, [](cas::Cas& cas, Context&) {
    types::SceneCas(cas).add_cluster(types::Cluster::create(cas));
  });
  const TestRun run = run_test(R"(flow:
  - regions: {"table*": [Finder, {Speaker: {word: here}}]}
  - Speaker: {word: all}
)",
                               registry);
  EXPECT_THAT(run.words, Each(ElementsAre("all", "all", "here all", "all", "here all")));
}

/// Annotators that wait for each other: they are only through when they run at the same time.
class Meeting {
 public:
  explicit Meeting(int expected) : expected_(expected) {}
  bool meet() {
    ++here_;
    for (int i = 0; i < 2000 && here_ < expected_; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return here_ >= expected_;
  }

 private:
  int expected_;
  std::atomic<int> here_ = 0;
};

TEST(Flow, WhatDoesNotDependOnEachOtherRunsAtTheSameTime) {
  AnnotatorRegistry registry = test_registry();
  Meeting meeting(2);
  std::atomic<int> met = 0;
  const auto work = [&](cas::Cas&, Context&) { met += meeting.meet() ? 1 : 0; };
  add_scripted(registry, {"One", "", {"Cluster"}, {"ColorAnnotation"}}, work);
  add_scripted(registry, {"Two", "", {"Cluster"}, {"SizeAnnotation"}}, work);
  run_test("flow: [One, Two]", registry, 8);
  EXPECT_EQ(met, 6);
}

TEST(Flow, ScenesAreWorkedOnSideBySideAndEachAnnotatorSeesThemInOrder) {
  AnnotatorRegistry registry = test_registry();
  Meeting meeting(2);
  std::vector<int64_t> first, second;
  const auto frame_of = [](cas::Cas& cas) { return types::SceneCas(cas).scene().frame_index.get(); };
  add_scripted(registry, {"First", "", {"Cluster"}, {"ColorAnnotation"}}, [&](cas::Cas& cas, Context&) {
    first.push_back(frame_of(cas));
    if (first.size() == 2) meeting.meet();  // while the scene before is with Second
  });
  add_scripted(registry, {"Second", "", {"ColorAnnotation"}, {}}, [&](cas::Cas& cas, Context&) {
    if (second.empty()) {
      EXPECT_TRUE(meeting.meet());
    }
    second.push_back(frame_of(cas));
  });
  EXPECT_EQ(run_test("flow: [First, Second]", registry, 2).result.frames, 3U);
  EXPECT_EQ(first, second);
  EXPECT_TRUE(std::ranges::is_sorted(first));
}

TEST(Flow, WhatSharesAResourceIsDoneWithASceneBeforeTheNext) {
  for (const int threads : {1, 2, 4}) {
    AnnotatorRegistry registry = test_registry();
    std::string order;
    const auto note = [&order](char name) { return [&order, name](cas::Cas&, Context&) { order += name; }; };
    AnnotatorDescriptor writes{"Writes", "", {"Cluster"}, {}}, reads{"Reads", "", {"TextAnnotation"}, {}};
    writes.shares = reads.shares = {"notebook"};
    add_scripted(registry, writes, note('w'));
    add_scripted(registry, reads, note('r'));
    run_test("flow: [Writes, Speaker]\nwriters: [Reads]", registry, threads);
    EXPECT_EQ(order, "wrwrwr") << threads;
  }
}

TEST(Flow, ScenesBeforeOneThatFailsComeThrough) {
  for (const int threads : {1, 2, 4}) {
    AnnotatorRegistry registry = test_registry();
    std::vector<int64_t> seen;
    add_scripted(registry, {"Fails", "", {"Cluster"}, {"ColorAnnotation"}}, [](cas::Cas& cas, Context&) {
      if (types::SceneCas(cas).scene().frame_index.get() == 11) throw Error("no");
    });
    add_scripted(registry, {"Keeps", "", {"Cluster", "ColorAnnotation"}, {}}, [&](cas::Cas& cas, Context&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      seen.push_back(types::SceneCas(cas).scene().frame_index.get());
    });
    EXPECT_THROW(run_test("flow: [Fails, Keeps]", registry, threads), Error);
    EXPECT_EQ(seen, std::vector<int64_t>{10}) << threads;
  }
}

TEST(Flow, AnAnnotatorKnowsWhichFrameComesNext) {
  for (const int threads : {1, 2}) {
    AnnotatorRegistry registry = test_registry();
    std::vector<int64_t> next;
    add_scripted(registry, {"Asks", "", {"Cluster"}, {}}, [&](cas::Cas&, Context& context) {
      next.push_back(context.next ? context.next->index : -1);
    });
    run_test("flow: [Asks]", registry, threads);
    EXPECT_EQ(next, (std::vector<int64_t>{11, 12, -1}));
  }
}

TEST(Flow, WhatDependsOnAnotherWaitsForIt) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Listener", "", {"TextAnnotation"}, {"ColorAnnotation"}},
               [](cas::Cas& cas, Context&) {
                 for (const types::Cluster& cluster : types::SceneCas(cas).clusters())
                   if (words(cluster) != "a") throw Error("heard something else");
               });
  EXPECT_EQ(refusal_of("flow: [{Speaker: {word: a}}, Listener]", registry), "accepted");
  EXPECT_EQ(refusal_of("flow: [{Speaker: {word: a}, asynchronous: true}, Listener]", registry), "accepted");
  EXPECT_THAT(refusal_of("flow: [{parallel: [Speaker, Listener]}]", registry),
              HasSubstr("branch 2 of 'parallel' reads what branch 1 outputs"));
}

TEST(Flow, MakesTheSameBytesOnAnyNumberOfThreads) {
  const std::string yaml = R"(flow:
  - Speaker: {word: a}
    asynchronous: true
  - Speaker: {word: b}
  - Speaker: {word: c}
  - parallel: [{Speaker: {word: d}}, [{Speaker: {word: e}}, {Speaker: {word: f}}]]
  - if: "Geometry.height > 0.02"
    then: [{Speaker: {word: g}}]
    else: [{Speaker: {word: h}}]
  - Speaker: {word: i}
    timeout_s: 60
)";
  const TestRun one = run_test(yaml, test_registry(), 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(run_test(yaml, test_registry(), threads).json, one.json);
  for (const std::string& said : one.words[0])
    for (const char* word : {"a", "b", "c", "d", "e", "f", "i"}) EXPECT_THAT(said, HasSubstr(word));
}

TEST(Flow, AsynchronousAnnotatorsRunBesideOthersAndAreJoinedAtTheEnd) {
  AnnotatorRegistry registry = test_registry();
  Meeting meeting(2);
  std::atomic<int> met = 0;
  add_scripted(registry, {"Slow", "", {"Cluster"}, {"TextAnnotation"}}, [&](cas::Cas& cas, Context&) {
    met += meeting.meet() ? 1 : 0;
    for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) Scripted::say(cluster, "slow");
  });
  // It changes what the other one makes, so that the two would not run at the same time by themselves.
  add_scripted(registry, {"Other", "", {"Cluster"}, {"ColorAnnotation"}},
               [&](cas::Cas&, Context&) { met += meeting.meet() ? 1 : 0; });
  const TestRun run = run_test("flow: [{Slow: {}, asynchronous: true}, Other]", registry, 1);
  EXPECT_EQ(met, 6);
  EXPECT_THAT(run.words, Each(Each("slow")));
}

TEST(Flow, RefusesWhatCannotBeMetInsideOfBranches) {
  const AnnotatorRegistry registry = test_registry();
  EXPECT_THAT(refusal_of("flow: [{if: 'TextAnnotation', then: [Speaker]}]", registry),
              HasSubstr("the condition 'TextAnnotation' needs TextAnnotation, which no earlier step outputs; "
                        "put Speaker before it"));
  EXPECT_THAT(refusal_of("flow:\n  - if: 'Geometry.hight > 1'\n    then: [Speaker]", registry),
              HasSubstr("height"));
  EXPECT_THAT(refusal_of("flow: [{if: 'Geometry.height > 1'}]", registry), HasSubstr("'then'"));
  EXPECT_THAT(refusal_of("flow: [{if: 'Geometry.height > 1', thn: [Speaker]}]", registry),
              HasSubstr("'then'"));
  EXPECT_THAT(refusal_of("engines: {x: [y], y: [x]}\nflow: [x]", registry), HasSubstr("contains itself"));
  EXPECT_THAT(refusal_of("engines: {speaking: [Speaker]}\nflow: [speakin]", registry),
              HasSubstr("did you mean 'speaking'?"));
  EXPECT_THAT(refusal_of("flow: [{Speaker: {}, on_eror: skip}]", registry), HasSubstr("'on_error'"));
}

TEST(Flow, RefusesAnEngineWithTheNameOfAnAnnotator) {
  EXPECT_THAT(refusal_of("engines: {Speaker: [Speaker]}\nflow: [Speaker]", test_registry()),
              HasSubstr("the engine 'Speaker' has the name of an annotator"));
}

TEST(Flow, RefusesAnExtractorThatStandsTwice) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Finder", "", {"Scene"}, {"Cluster"}}, [](cas::Cas&, Context&) {});
  add_scripted(registry, {"Adder", "", {"Scene"}, {"Cluster"}, {"Cluster"}}, [](cas::Cas&, Context&) {});
  EXPECT_THAT(refusal_of("flow: [Finder, Speaker, Finder]", registry), HasSubstr("Finder stands twice"));
  EXPECT_EQ(refusal_of("flow: [Finder, Adder, Adder]", registry), "accepted");
}

TEST(Flow, EveryAnnotatorMayWriteTheLog) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Talker", "", {"Scene"}, {}},
               [](cas::Cas& cas, Context&) { types::SceneCas(cas).log("Talker", "info", "here"); });
  EXPECT_EQ(refusal_of("flow: [Talker]", registry), "accepted");
}

/// What a run fails with whose annotator `Culprit`, which declares TextAnnotation, does this.
std::string broken_contract(const std::string& flow, const Scripted::Work& work) {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Culprit", "", {"Scene", "Cluster"}, {"TextAnnotation", "view:mine"}}, work);
  return refusal_of(flow, registry);
}

TEST(Flow, WhatAnAnnotatorDoesNotDeclareItMustNotDo) {
  const auto classify = [](cas::Cas& cas, Context&) {
    types::SceneCas(cas).clusters()[0].annotations.push_back(types::ClassificationAnnotation::create(cas));
  };
  for (const char* flow :
       {"flow: [Culprit]", "flow: [{parallel: [Speaker, Culprit]}]", "flow: [{Culprit: {}, timeout_s: 60}]"})
    EXPECT_THAT(
        broken_contract(flow, classify),
        HasSubstr("Culprit failed at frame 10: it makes ClassificationAnnotation, which is not among its "
                  "outputs"))
        << flow;
  EXPECT_THAT(broken_contract("flow: [Culprit]",
                              [](cas::Cas& cas, Context&) {
                                const types::Scene scene = types::SceneCas(cas).scene();
                                scene.clusters.erase(types::SceneCas(cas).clusters()[0]);
                              }),
              HasSubstr("it removes a cluster"));
}

TEST(Flow, StandardViewsKeepTheSizeOfTheirCamera) {
  const auto set_view = [](const char* view, int columns) {
    return [=](cas::Cas& cas, Context&) {
      const auto camera = types::CameraInfo::create(cas);
      camera.name.set("color");
      camera.width.set(9);
      camera.height.set(7);
      const auto image = types::Mat::create(cas);
      image.rows.set(7);
      image.cols.set(columns);
      types::SceneCas(cas).set_camera(camera);
      types::SceneCas(cas).set_image(view, image);
    };
  };
  EXPECT_THAT(broken_contract("flow: [Culprit]", set_view("color", 9)),
              HasSubstr("it sets view:color, which"));
  EXPECT_EQ(broken_contract("flow: [Culprit]", set_view("mine", 3)), "accepted");
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Painter", "", {"Scene"}, {"view:color"}}, set_view("color", 8));
  EXPECT_THAT(refusal_of("flow: [Painter]", registry),
              HasSubstr("it sets view:color to 8 x 7 pixels, the camera has 9 x 7"));
}

TEST(Flow, ItsConfigurationIsAPipelineAgain) {
  const std::string yaml = R"(engines: {speak: [Speaker]}
flow:
  - speak
  - Speaker: {word: x}
    on_error: skip
    retry: 2
  - regions: {"counter*": [Speaker]}
  - parallel: [Speaker, [Speaker, Speaker]]
  - if: "Geometry.height > 0.02"
    then: [Speaker]
)";
  const AnnotatorRegistry registry = test_registry();
  const Json json = Pipeline::parse(yaml, "p.yaml", registry).to_json();
  EXPECT_EQ(Pipeline::parse(json.dump(), "again", registry).to_json(), json);
}

}  // namespace
}  // namespace loci::perception
