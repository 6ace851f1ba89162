#include "memory/belief/belief.h"

#include <gmock/gmock.h>

#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory::belief {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const std::vector<float> kRed = {0.8F, 0.2F, 0.2F}, kBlue = {0.2F, 0.2F, 0.8F}, kWhite = {0.9F, 0.9F, 0.9F};
Vector3d at(double x, double y) {
  return SyntheticKitchen::on_table(x, y);
}

class Belief : public ::testing::Test {
 protected:
  BeliefUpdate observe(double seconds, std::optional<double> to_next = {}) {
    return advance(state, kitchen.scene(seconds, to_next));
  }
  /// A video of `frames` frames at 30 Hz from `seconds` on; all events.
  std::vector<std::string> observe_video(double seconds, int frames) {
    std::vector<std::string> all;
    for (int i = 0; i < frames; ++i)
      for (const std::string& text : events(observe(seconds + i / 30.0, 1 / 30.0))) all.push_back(text);
    return all;
  }

  SyntheticKitchen kitchen;
  BeliefState state;
};

TEST_F(Belief, SnapshotIsBelievedAtOnce) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue}};
  EXPECT_THAT(events(observe(0)), ElementsAre("appeared 1", "appeared 2"));
  EXPECT_THAT(events(observe(60)), IsEmpty());
}

TEST_F(Belief, MovedObjectKeepsItsIdentity) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue}};
  observe(0);
  kitchen.object("mug").centre = at(-0.3, 0.1);
  const BeliefUpdate update = observe(600);
  EXPECT_THAT(events(update), ElementsAre("moved 1"));
  EXPECT_NEAR(update.events[0].from->centre.x(), 0, 1e-6);
  EXPECT_NEAR(update.events[0].to->centre.x(), -0.3, 1e-6);
}

TEST_F(Belief, SmallShiftIsAMoveForACameraThatStandsStill) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  kitchen.object("mug").centre = at(0.03, 0);
  EXPECT_THAT(events(observe(60)), ElementsAre("moved 1"));
  kitchen.object("mug").centre = at(0.033, 0);
  EXPECT_THAT(events(observe(120)), IsEmpty()) << "three millimetres are noise";
}

TEST_F(Belief, SmallShiftIsAMoveThoughTheCameraLookedElsewhereASecondBefore) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  const Isometry3d there = kitchen.map_from_camera;
  kitchen.map_from_camera = SyntheticKitchen::look_from({0, -1, 1.4}, {9, -1, 0.72});
  observe(3599, 1);
  kitchen.map_from_camera = there;
  kitchen.object("mug").centre = at(0.03, 0);
  EXPECT_THAT(events(observe(3600)), ElementsAre("moved 1"));
}

TEST_F(Belief, ShiftWithinThePoseErrorIsNoMoveForACameraThatMoved) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  kitchen.object("mug").centre = at(0.03, 0);
  kitchen.map_from_camera = SyntheticKitchen::look_from({0.6, -0.8, 1.4}, {0, 0, 0.72});
  EXPECT_THAT(events(observe(60)), IsEmpty());
}

TEST_F(Belief, AThinBoxThatStandsNearerThanBelievedIsNotHiddenByItself) {
  const auto stands_at = [](double y) { return SyntheticKitchen::on_table(0, y, 0.4); };
  kitchen.objects = {{"tray", stands_at(0), {0.4, 0.02, 0.4}, kRed}};
  kitchen.map_from_camera = SyntheticKitchen::look_from({-0.4, -0.9, 0.9}, {0, 0, 0.9});
  observe(0);
  kitchen.object("tray").centre = stands_at(-0.06);
  kitchen.map_from_camera = SyntheticKitchen::look_from({0.4, -0.9, 0.9}, {0, 0, 0.9});
  EXPECT_THAT(events(observe(60)), IsEmpty());
}

TEST_F(Belief, ExtentsOfAPartialViewSpeakAgainstThePairInAVideoOnly) {
  const auto size_evidence_after = [&](double seconds) {
    state = {};
    kitchen.objects = {{"box", at(0, 0), {0.3, 0.2, 0.1}, kRed}};
    observe(0, seconds);
    Scene scene = kitchen.scene(seconds);
    scene.observations[0].partial = true;
    scene.observations[0].descriptors[1].values = {0.05F, 0.05F, 0.05F};
    return advance(state, scene).evidence.log_size(0, 0);
  };
  EXPECT_GT(size_evidence_after(60), -1.5);
  EXPECT_LT(size_evidence_after(0.2), -3);
}

TEST_F(Belief, ShiftOfABoxThatIsHalfHiddenIsAMove) {
  kitchen.objects = {{"box", at(0, 0), {0.3, 0.2, 0.1}, kRed},
                     {"before", SyntheticKitchen::on_table(0, -0.2, 0.15), {0.12, 0.05, 0.15}, kBlue}};
  observe(0);
  observe(60);
  ASSERT_TRUE(state.find(1)->partial);
  kitchen.object("box").centre = at(0.05, 0);
  EXPECT_THAT(events(observe(120)), ElementsAre("moved 1"));
}

TEST_F(Belief, SurfacesTellAShiftWhateverTheCameraLookedAtASecondBefore) {
  const auto evidence_after = [&](double shift) {
    state = {};
    kitchen.objects = {{"box", at(0, 0), {0.3, 0.2, 0.1}, kRed},
                       {"before", SyntheticKitchen::on_table(0, -0.2, 0.15), {0.12, 0.05, 0.15}, kBlue}};
    const Isometry3d there = kitchen.map_from_camera;
    observe(0);
    kitchen.map_from_camera = SyntheticKitchen::look_from({0, -1, 1.4}, {9, -1, 0.72});
    observe(119, 1);
    kitchen.map_from_camera = there;
    kitchen.object("box").centre = at(shift, 0);
    return observe(120).evidence.log_proximity(0, 0);
  };
  EXPECT_LT(evidence_after(0.05), evidence_after(0) - 6);
}

TEST_F(Belief, MoreThatHidesABoxIsNoMove) {
  kitchen.objects = {{"box", at(0, 0), {0.3, 0.2, 0.1}, kRed}};
  observe(0);
  kitchen.objects.push_back({"before", SyntheticKitchen::on_table(0, -0.2, 0.15), {0.12, 0.05, 0.15}, kBlue});
  EXPECT_THAT(events(observe(60)), ElementsAre("appeared 2"));
  kitchen.object("before").centre.x() = 0.1;
  EXPECT_THAT(events(observe(120)), ElementsAre("moved 2"));
}

TEST_F(Belief, SwappedBoxesOfOneShapeAreToldByTheirPrints) {
  kitchen.objects = {{"tea", at(-0.2, 0), {0.1, 0.08, 0.1}, kWhite},
                     {"rice", at(0.2, 0), {0.1, 0.08, 0.1}, kWhite}};
  const auto observe_prints = [&](double seconds) {
    Scene scene = kitchen.scene(seconds);
    for (size_t i = 0; i < scene.observations.size(); ++i)
      scene.observations[i].texture = print_on(scene.observations[i].box, i);
    return advance(state, scene);
  };
  observe_prints(0);
  std::swap(kitchen.object("tea").centre, kitchen.object("rice").centre);
  const BeliefUpdate update = observe_prints(600);
  EXPECT_THAT(events(update), UnorderedElementsAre("moved 1", "moved 2"));
  for (const ObservationOutcome& outcome : update.observations) EXPECT_GT(outcome.probability, 0.5);
}

TEST_F(Belief, SwappedEqualCupsAreTakenForCupsThatStayed) {
  kitchen.objects = {{"cup_1", at(-0.2, 0), {0.08, 0.08, 0.1}, kWhite},
                     {"cup_2", at(0.2, 0), {0.08, 0.08, 0.1}, kWhite}};
  observe(0);
  std::swap(kitchen.object("cup_1").centre, kitchen.object("cup_2").centre);
  EXPECT_THAT(events(observe(60)), IsEmpty());
}

TEST_F(Belief, TwoEqualCupsThatBothMovedAreAmbiguous) {
  kitchen.objects = {{"cup_1", at(-0.2, 0.1), {0.08, 0.08, 0.1}, kWhite},
                     {"cup_2", at(0.2, 0.1), {0.08, 0.08, 0.1}, kWhite}};
  observe(0);
  kitchen.object("cup_1").centre = at(0, -0.1);
  kitchen.object("cup_2").centre = at(0, 0.25);
  const BeliefUpdate update = observe(600);
  EXPECT_THAT(events(update), UnorderedElementsAre("moved 1", "moved 2"));
  for (const ObservationOutcome& outcome : update.observations) {
    ASSERT_GE(outcome.partners.size(), 2U);
    EXPECT_NEAR(outcome.partners[0].probability(), outcome.partners[1].probability(), 0.1);
    EXPECT_GT(outcome.partners[0].probability(), 0.3);
  }
}

TEST_F(Belief, TwoEqualCupsDoNotBecomeOneThatGoesToAndFro) {
  const Isometry3d here = kitchen.map_from_camera;
  const Isometry3d there = SyntheticKitchen::look_from({4, -1.0, 1.4}, {4, 0, 0.72});
  kitchen.objects = {{"cup", at(0, 0)}};
  observe(0);
  kitchen.objects.push_back({"its twin", at(4, 0)});
  kitchen.map_from_camera = there;
  EXPECT_THAT(events(observe(1200)), ElementsAre("moved 1"))
      << "the more probable hypothesis until the first spot is observed again";
  kitchen.map_from_camera = here;
  EXPECT_THAT(events(observe(1260)), ElementsAre("moved 1")) << "it stands where it stood";
  kitchen.map_from_camera = there;
  EXPECT_THAT(events(observe(1320)), ElementsAre("appeared 2"));
  for (int i = 0; i < 4; ++i) {
    kitchen.map_from_camera = i % 2 == 0 ? here : there;
    EXPECT_THAT(events(observe(1500 + 60 * i)), IsEmpty());
  }
}

TEST_F(Belief, MoveFromAnObservedSpotLeavesNoAlternative) {
  kitchen.objects = {{"cup", at(0, 0)}};
  observe(0);
  kitchen.object("cup").centre = at(0.3, 0);
  observe(600);
  EXPECT_EQ(state.objects.size(), 1U) << "the place was seen empty";
}

TEST_F(Belief, NewObjectsWaitForAnotherViewWhereMostAreClutter) {
  kitchen.objects = {{"cup", at(0, 0)}};
  observe(0);
  for (int i = 0; i < 200; ++i) state.interaction.learn_clutter(i % 2, {});
  kitchen.objects.push_back({"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue});
  EXPECT_THAT(events(observe(60)), IsEmpty());
  const BeliefUpdate second = observe(120);
  EXPECT_THAT(events(second), ElementsAre("appeared 2"));
  ASSERT_EQ(second.confirmed.size(), 1U);
  EXPECT_EQ(second.confirmed[0].earlier.size(), 1U) << "with its first sighting";
}

TEST_F(Belief, ObjectThatIsNotAtItsObservedSpotIsGone) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue}};
  observe(0);
  kitchen.objects.erase(kitchen.objects.begin());
  EXPECT_THAT(events(observe(300)), ElementsAre("gone 1"));
  EXPECT_EQ(state.find(1)->status, Status::gone);
  EXPECT_THAT(events(observe(600)), IsEmpty()) << "said once";
}

TEST_F(Belief, HiddenObjectStaysAndIsTheSameWhenObservedAgain) {
  kitchen.objects = {{"mug", at(0, 0.1)}};
  observe(0);
  kitchen.objects.push_back({"carton", SyntheticKitchen::on_table(0, -0.1, 0.3), {0.3, 0.1, 0.3}, kBlue});
  EXPECT_THAT(events(observe(300)), ElementsAre("hidden 1", "appeared 2"));
  EXPECT_GT(state.find(1)->probability_here, 0.8);
  EXPECT_THAT(events(observe(600)), IsEmpty());
  kitchen.objects.pop_back();
  EXPECT_THAT(events(observe(900)), ElementsAre("reappeared 1", "gone 2"));
}

TEST_F(Belief, ObjectOfWhichLittleWouldBeInViewIsGoneWhereThatIsSeenThrough) {
  kitchen.objects = {{"banana", SyntheticKitchen::on_table(0, 0, 0.05), {0.18, 0.1, 0.05}}};
  observe(0);
  kitchen.objects.push_back(
      {"bottle", SyntheticKitchen::on_table(-0.02, -0.1, 0.24), {0.12, 0.06, 0.24}, kBlue});
  kitchen.objects[0].detected = false;
  const BeliefState before = state;
  EXPECT_THAT(events(observe(600)), ::testing::Not(::testing::Contains("gone 1"))) << "its ends are in view";
  state = before;
  kitchen.objects.erase(kitchen.objects.begin());
  EXPECT_THAT(events(observe(600)), ::testing::Contains("gone 1"));
}

TEST_F(Belief, OutOfViewIsNotGone) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  const Isometry3d before = kitchen.map_from_camera;
  kitchen.map_from_camera = SyntheticKitchen::look_from({3, -1, 1.4}, {3, 0, 0.72});
  EXPECT_THAT(events(observe(300)), IsEmpty());
  EXPECT_THAT(events(observe(7 * 86400)), IsEmpty()) << "time alone makes nothing go";
  EXPECT_EQ(state.find(1)->status, Status::present);
  kitchen.map_from_camera = before;
  EXPECT_THAT(events(observe(7 * 86400 + 300)), IsEmpty());
  EXPECT_EQ(state.find(1)->last_seen, (7 * 86400 + 300) * kSecond);
}

TEST_F(Belief, GoneObjectThatReturnsIsRecognised) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  const SyntheticObject mug = kitchen.objects[0];
  kitchen.objects.clear();
  EXPECT_THAT(events(observe(300)), ElementsAre("gone 1"));
  kitchen.objects = {mug};
  kitchen.objects[0].centre = at(0.3, 0.1);
  EXPECT_THAT(events(observe(600)), ElementsAre("reappeared 1"));
}

/// A detector without depth looks at one table; `colors`: of what it finds there.
Scene look_at(const std::string& table, double seconds, const std::vector<std::vector<float>>& colors) {
  Scene scene;
  scene.time = static_cast<TimeNs>(seconds * 1e9);
  scene.view.has_camera = false;
  scene.view.observed = {{table, 1}};
  for (size_t i = 0; i < colors.size(); ++i) {
    Observation& observation = scene.observations.emplace_back();
    observation.box = {at(0.3 * double(i), 0), Vector3d(0.1, 0.1, 0.1)};
    observation.place = table;
    observation.descriptors = {{"mean_color", colors[i]}};
  }
  return scene;
}

TEST(BeliefOfDetections, GoneObjectIsNotExpectedOnAPlaceThatWasLookedAtSinceItWent) {
  BeliefOptions options;
  options.reappear = 0;
  const auto move_prior = [&](bool looked) {
    BeliefState state;
    advance(state, look_at("table_1", 0, {kRed}), options);
    advance(state, look_at("table_2", 30, {kBlue}), options);
    for (int i = 1; i <= 5; ++i) {
      advance(state, look_at("table_1", 600 * i, {}), options);
      if (looked) advance(state, look_at("table_2", 600 * i + 300, {kBlue}), options);
    }
    EXPECT_EQ(state.find(1)->status, Status::gone);
    return advance(state, look_at("table_2", 4000, {kBlue, kRed}), options).problem.move_prior(0, 1);
  };
  EXPECT_LT(move_prior(true), move_prior(false) - 1);
}

TEST(BeliefOfDetections, WhatIsFoundElsewhereBeforeItsSpotIsSeenWasHandled) {
  BeliefOptions options;
  options.appear = 0.001;
  BeliefState state;
  for (int i = 0; i < 10; ++i)
    advance(state, look_at("table_" + std::to_string(i), 600 * i, {kRed}), options);
  double handled = 0;
  for (const RateFactor& age : state.interaction.statistics().by_age) handled += age.found;
  EXPECT_GT(handled, 5) << "of nine moves";
}

TEST(BeliefOfDetections, ViewAfterViewShowsThatANewObjectWasClutter) {
  const auto clutter = [](int views) {
    BeliefState state;
    advance(state, look_at("table_1", 0, {kRed}));
    advance(state, look_at("table_1", 10, {kRed, kBlue}));
    for (int i = 1; i <= views; ++i) advance(state, look_at("table_1", 10 + 10 * i, {kRed}));
    return state.interaction.statistics().clutter.found;
  };
  EXPECT_EQ(clutter(1), 0) << "it may be missed once";
  EXPECT_GT(clutter(4), 0.5);
}

TEST_F(Belief, AnotherAppearanceAtTheSameSpotIsReported) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  kitchen.objects[0].color = kBlue;
  EXPECT_THAT(events(observe(300)), ElementsAre("looks_different 1"));
}

TEST_F(Belief, MissedDetectionChangesNothing) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  kitchen.objects[0].detected = false;
  EXPECT_THAT(events(observe(60)), IsEmpty());
  EXPECT_EQ(state.find(1)->status, Status::present);
  EXPECT_GT(state.find(1)->probability_here, 0.5);
  kitchen.objects[0].detected = true;
  EXPECT_THAT(events(observe(120)), IsEmpty());
}

TEST_F(Belief, ClutterInOneFrameOfAVideoIsNeverReported) {
  kitchen.objects = {{"mug", at(0, 0)}};
  EXPECT_THAT(observe_video(0, 10), ElementsAre("appeared 1"));
  kitchen.objects.push_back({"clutter", at(0.3, 0.1), {0.03, 0.03, 0.03}, kBlue});
  EXPECT_THAT(observe_video(0.34, 1), IsEmpty());
  kitchen.objects.pop_back();
  EXPECT_THAT(observe_video(0.38, 20), IsEmpty());
  EXPECT_EQ(state.objects.size(), 1U) << "forgotten";
}

TEST_F(Belief, ClutterInHalfOfTheFramesOfAVideoIsNeverReported) {
  const std::vector<SyntheticObject> always{{"mug", at(0, 0)}};
  std::vector<SyntheticObject> sometimes = always;
  sometimes.push_back({"clutter", at(0.3, 0.1), {0.06, 0.06, 0.06}, kBlue});
  std::vector<std::string> all;
  for (int i = 0; i < 120; ++i) {
    kitchen.objects = i / 3 % 2 == 0 ? sometimes : always;
    for (const std::string& text : observe_video(0.2 * i, 1)) all.push_back(text);
  }
  EXPECT_THAT(all, ElementsAre("appeared 1"));
}

TEST_F(Belief, ObjectThatLeavesTheViewOfAVideoEarlyIsReportedWhenItIsBack) {
  kitchen.objects = {{"mug", at(0, 0)}};
  const Isometry3d here = kitchen.map_from_camera;
  EXPECT_THAT(observe_video(0, 4), IsEmpty());
  kitchen.map_from_camera = SyntheticKitchen::look_from({0, -1, 1.4}, {3, 0, 0.72});
  for (int i = 0; i < 100; ++i) EXPECT_THAT(observe_video(0.2 + 0.2 * i, 1), IsEmpty());
  kitchen.map_from_camera = here;
  EXPECT_THAT(observe_video(21, 4), ElementsAre("appeared 1"));
}

TEST_F(Belief, ConfirmationReportsEarlierObservations) {
  kitchen.objects = {{"mug", at(0, 0)}};
  std::vector<int64_t> earlier;
  for (int i = 0; i < 10; ++i)
    for (const Confirmed& confirmed : observe(i / 30.0, 1 / 30.0).confirmed)
      for (const PendingObservation& observation : confirmed.earlier)
        earlier.push_back(observation.observation);
  EXPECT_THAT(earlier, ElementsAre(1, 2, 3, 4, 5));
}

TEST_F(Belief, ObjectTakenAwayDuringAVideoIsGoneAfterASecondOrTwo) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue}};
  observe_video(0, 30);
  kitchen.objects.erase(kitchen.objects.begin());
  EXPECT_THAT(observe_video(1.0, 3), IsEmpty());
  EXPECT_THAT(observe_video(1.1, 90), ElementsAre("gone 1"));
}

TEST_F(Belief, PartialViewAtTheBorderIsTheSameObject) {
  kitchen.objects = {{"tub", at(0, 0), {0.3, 0.2, 0.1}, kRed}};
  observe_video(0, 10);
  // The camera turns away until only a piece is left in view.
  for (int i = 0; i <= 40; ++i) {
    kitchen.map_from_camera = SyntheticKitchen::look_from({0, -1, 1.4}, {i * 0.02, 0, 0.72});
    Scene scene = kitchen.scene(1 + i / 30.0, 1 / 30.0);
    for (Observation& observation : scene.observations) {
      if (!observation.partial) continue;
      const double left = -0.15 + 0.004 * i;  // the visible piece shrinks
      observation.box.size.x() = 0.15 - left;
      observation.box.centre.x() = (0.15 + left) / 2;
    }
    EXPECT_THAT(events(advance(state, scene)), IsEmpty());
  }
  EXPECT_EQ(state.objects.size(), 1U);
  EXPECT_NEAR(state.find(1)->box.size.x(), 0.3, 0.01) << "pieces do not shrink what was seen whole";
}

TEST_F(Belief, SizeIsThatOfMostViewsWhereNoneShowsTheWholeObject) {
  kitchen.objects = {{"tub", at(0, 0), {0.3, 0.2, 0.1}, kRed}};
  for (int i = 0; i < 120; ++i) {
    kitchen.map_from_camera = SyntheticKitchen::look_from({0.002 * i, -1, 1.4}, {0, 0, 0.72});
    Scene scene = kitchen.scene(0.2 * i, 0.2);
    Observation& tub = scene.observations.front();
    tub.partial = true;
    const bool with_neighbour = i % 20 == 19, left = i % 2 == 0;
    tub.box.size.x() = with_neighbour ? 0.6 : 0.2;
    tub.box.centre.x() = with_neighbour ? 0.15 : left ? -0.05 : 0.05;
    advance(state, scene);
  }
  ASSERT_EQ(state.objects.size(), 1U);
  EXPECT_NEAR(state.find(1)->box.size.x(), 0.3, 0.05);
  EXPECT_NEAR(state.find(1)->box.centre.x(), 0, 0.03);
}

TEST_F(Belief, AnEdgeInViewIsOfTheObjectThoughMostOfItIsNot) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(-0.3, 0.1), {0.1, 0.1, 0.1}, kBlue}};
  const int whole = kitchen.scene(0).observations.at(0).points;
  observe(0);
  // The camera turns away until so little is left in view that nothing would be expected to be detected.
  Scene scene;
  for (double x = 0; x > -1; x -= 0.002) {
    kitchen.map_from_camera = SyntheticKitchen::look_from({0, -1, 1.4}, {x, 0, 0.72});
    scene = kitchen.scene(600);
    if (scene.observations.at(0).points < whole / 7) break;
  }
  ASSERT_EQ(scene.observations.size(), 2U);
  ASSERT_TRUE(scene.observations[0].partial);
  scene.observations[0].box = {at(-0.035, 0), {0.01, 0.08, 0.1}};
  const BeliefUpdate update = advance(state, scene);
  EXPECT_THAT(events(update), IsEmpty());
  EXPECT_EQ(state.find(1)->last_seen, scene.time);
}

TEST_F(Belief, ObjectInADrawerMovesWithIt) {
  const auto drawer = [](double open) {
    PlacePose pose{"drawer_1_bottom", Isometry3d::Identity()};
    pose.map_from_place.translation() = Vector3d(0, -open, 0.7);
    return pose;
  };
  kitchen.objects = {{"spoon", at(0, 0)}};
  Scene open = kitchen.scene(0);
  open.observations[0].place = "drawer_1_bottom";
  open.places = {drawer(0.3)};
  advance(state, open);

  kitchen.objects[0].centre += Vector3d(0, 0.3, 0);
  Scene closed = kitchen.scene(600);
  closed.observations.clear();
  closed.places = {drawer(0)};
  closed.view.map_depth = cv::Mat(closed.view.depth.size(), CV_32F, cv::Scalar(0.6));
  EXPECT_THAT(events(advance(state, closed)), ElementsAre("hidden 1"));

  kitchen.objects[0].centre -= Vector3d(0, 0.1, 0);
  Scene half_open = kitchen.scene(1200);
  half_open.observations[0].place = "drawer_1_bottom";
  half_open.places = {drawer(0.1)};
  EXPECT_THAT(events(advance(state, half_open)), ElementsAre("reappeared 1"));
  EXPECT_NEAR(box_in_map(*state.find(1), half_open.places).centre.y(), 0.2, 0.005);
}

TEST_F(Belief, WhatLiesInADrawerIsHandledWhenTheDrawerIsUsed) {
  const auto probability_after = [&](double then_open, double after_s) {
    BeliefState after;
    kitchen.objects = {{"spoon", at(0, 0)}};
    Scene scene = kitchen.scene(0);
    scene.observations[0].place = "drawer_1_bottom";
    for (const auto& [seconds, open] : {std::pair{0.0, 0.3}, std::pair{after_s, then_open}}) {
      PlacePose pose{"drawer_1_bottom", Isometry3d::Identity()};
      pose.map_from_place.translation() = Vector3d(0, -open, 0.7);
      scene.time = static_cast<TimeNs>(seconds * 1e9);
      scene.places = {pose};
      advance(after, scene);
      scene.observations.clear();
      scene.view.depth.setTo(std::numeric_limits<float>::quiet_NaN());
      scene.view.labels.setTo(-1);
    }
    return probability_here(*after.find(1), after, {});
  };
  const double untouched = probability_after(0.3, 600);
  EXPECT_LT(probability_after(0, 600), untouched - 0.15);
  EXPECT_NEAR(probability_after(0.29, 600), untouched, 1e-9)
      << "the pose of a drawer that stays open is not exact";
  EXPECT_NEAR(probability_after(0, 0.1), probability_after(0.3, 0.1), 1e-9)
      << "a video shows what is taken out";
}

TEST_F(Belief, SettledObservationsAreAssignedAsByTheModel) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue}};
  BeliefOptions model_alone;
  model_alone.settle = false;
  BeliefState other = state;
  const auto both = [&](double seconds) {
    const Scene scene = kitchen.scene(seconds);
    return std::pair(advance(state, scene), advance(other, scene, model_alone));
  };
  both(0);
  const auto [arbiter, model] = both(600);
  EXPECT_THAT(arbiter.evidence.settled, ElementsAre(0U, 1U));
  EXPECT_THAT(model.evidence.settled, ElementsAre(std::nullopt, std::nullopt));
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(arbiter.observations[k].object, model.observations[k].object);
    EXPECT_NEAR(arbiter.observations[k].probability, model.observations[k].probability, 0.01);
  }
  kitchen.object("mug").centre = at(-0.3, 0.1);
  EXPECT_THAT(both(1200).first.evidence.settled, ElementsAre(std::nullopt, 1U))
      << "the model says what moved";
}

TEST_F(Belief, SettledObservationsAreNotComparedWithObjectsOutOfView) {
  kitchen.objects = {{"mug", at(0, 0)}};
  observe(0);
  const Isometry3d here = kitchen.map_from_camera;
  kitchen.map_from_camera = SyntheticKitchen::look_from({9, -1.0, 1.4}, {9, 0, 0.72});
  kitchen.objects.push_back({"box", at(9, 0), {0.2, 0.1, 0.1}, kBlue});
  observe(600);
  kitchen.map_from_camera = here;
  const BeliefUpdate update = observe(1200);
  ASSERT_EQ(update.evidence.settled.size(), 1U);
  EXPECT_EQ(update.evidence.settled[0], 0U);
  EXPECT_FALSE(std::isnan(update.evidence.distances[0].distance(0, 0)));
  EXPECT_TRUE(std::isnan(update.evidence.distances[0].distance(1, 0)));
}

TEST_F(Belief, DistributionsSumToOne) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue}};
  observe(0);
  kitchen.objects[0].centre = at(-0.3, 0.1);
  kitchen.objects[1].color = kRed;
  const BeliefUpdate update = observe(600);
  for (const ObservationOutcome& o : update.observations) {
    double sum = o.appear + o.clutter;
    for (const PartnerProbability& share : o.partners) sum += share.probability();
    EXPECT_NEAR(sum, 1, 0.01);
  }
  for (const ObjectOutcome& o : update.objects)
    EXPECT_NEAR(o.matched + o.disappear + o.missed + o.hidden, 1, 1e-9);
}

TEST_F(Belief, ContinuesFromItsBytesWithTheSameNumbers) {
  kitchen.objects = {{"mug", at(0, 0)}, {"box", at(0.3, 0.1), {0.2, 0.1, 0.1}, kBlue}};
  observe_video(0, 7);
  BeliefState copy = restored(stored(state));
  kitchen.objects[0].centre = at(0.011, 0.003);
  for (int i = 0; i < 5; ++i) {
    const Scene scene = kitchen.scene(10 + i, 1);
    advance(state, scene);
    advance(copy, scene);
  }
  EXPECT_EQ(stored(state), stored(copy));
}

TEST_F(Belief, RefusesToGoBackInTime) {
  observe(10);
  EXPECT_THROW(observe(9), Error);
}

}  // namespace
}  // namespace loci::memory::belief
