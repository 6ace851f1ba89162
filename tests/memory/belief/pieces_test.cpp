#include <gmock/gmock.h>

#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory::belief {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A box whose middle a bottle hides, so that segmentation finds its ends.
class Pieces : public ::testing::Test {
 protected:
  Pieces() {
    kitchen.objects = {
        {"box", SyntheticKitchen::on_table(0, 0), {0.24, 0.08, 0.1}, {0.8F, 0.2F, 0.2F}},
        {"bottle", SyntheticKitchen::on_table(0, -0.2, 0.25), {0.08, 0.08, 0.25}, {0.2F, 0.2F, 0.8F}}};
  }

  /// The ends of the box, the larger one first, before the bottle.
  Scene in_pieces(double seconds) const {
    Scene scene = kitchen.scene(seconds);
    Observation large = scene.observations.front();
    large.partial = true;
    Observation small = large;
    large.box = {SyntheticKitchen::on_table(-0.04, 0), {0.16, 0.08, 0.1}};
    small.box = {SyntheticKitchen::on_table(0.1, 0), {0.04, 0.08, 0.1}};
    small.points = large.points / 4;
    small.id += 1000;
    scene.observations.front() = large;
    scene.observations.insert(scene.observations.begin() + 1, small);
    scene.view.labels.setTo(2, scene.view.labels == 1);
    return scene;
  }
  Scene whole(double seconds) {
    kitchen.object("bottle").centre.x() = 0.4;
    return kitchen.scene(seconds);
  }

  SyntheticKitchen kitchen;
  BeliefState state;
};

TEST_F(Pieces, TheOtherEndIsNoNewObject) {
  advance(state, whole(0));
  kitchen.object("bottle").centre.x() = 0;
  const BeliefUpdate update = advance(state, in_pieces(3600));
  EXPECT_THAT(events(update), ElementsAre("moved 2"));
  EXPECT_EQ(update.observations[0].object, 1);
  EXPECT_EQ(update.observations[1].explanation, Explanation::clutter);
  EXPECT_GT(update.observations[1].clutter, 10 * update.observations[1].appear);
  EXPECT_EQ(state.objects.size(), 2U);
}

TEST_F(Pieces, TheLargerOneIsTheObjectWhateverTheirOrder) {
  advance(state, whole(0));
  kitchen.object("bottle").centre.x() = 0;
  Scene scene = in_pieces(3600);
  std::swap(scene.observations[0], scene.observations[1]);
  const BeliefUpdate update = advance(state, scene);
  EXPECT_EQ(update.observations[1].object, 1);
  EXPECT_EQ(update.observations[0].explanation, Explanation::clutter);
}

TEST_F(Pieces, WhatHasAnotherColorIsNew) {
  advance(state, whole(0));
  kitchen.object("bottle").centre.x() = 0;
  Scene scene = in_pieces(3600);
  scene.observations[1].descriptors.front().values = {0.2F, 0.7F, 0.2F};
  EXPECT_THAT(events(advance(state, scene)), ElementsAre("moved 2", "appeared 3"));
}

TEST_F(Pieces, AWholeViewShowsThatTheyAreOneObject) {
  EXPECT_THAT(events(advance(state, in_pieces(0))), ElementsAre("appeared 1", "appeared 2", "appeared 3"));
  const BeliefUpdate update = advance(state, whole(3600));
  EXPECT_THAT(events(update), ElementsAre("gone 2", "moved 3"));
  EXPECT_EQ(update.observations[0].object, 1);
  EXPECT_THAT(events(advance(state, whole(7200))), IsEmpty());
  EXPECT_EQ(state.objects.size(), 2U) << "the double does not come back";
}

TEST_F(Pieces, TheObjectThatWasSeenMoreOftenIsKept) {
  Scene first = in_pieces(0);
  first.observations.erase(first.observations.begin());  // only the smaller end is found
  advance(state, first);
  advance(state, in_pieces(3600));
  ASSERT_EQ(state.objects.size(), 3U);
  const BeliefUpdate update = advance(state, whole(7200));
  EXPECT_EQ(update.observations[0].object, 1);
}

}  // namespace
}  // namespace loci::memory::belief
