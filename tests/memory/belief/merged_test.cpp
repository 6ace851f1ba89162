#include <gmock/gmock.h>

#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory::belief {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// A cup and a jar that touch each other, which one view takes for one cluster.
class Merged : public ::testing::Test {
 protected:
  Merged() {
    kitchen.objects = {
        {"cup", SyntheticKitchen::on_table(0, 0, 0.1), {0.08, 0.08, 0.1}, {0.8F, 0.2F, 0.2F}},
        {"jar", SyntheticKitchen::on_table(0.075, 0, 0.1), {0.07, 0.07, 0.1}, {0.2F, 0.2F, 0.8F}}};
  }

  /// One observation of both, of their mean colour.
  Scene merged(double seconds) const {
    Scene scene = kitchen.scene(seconds);
    Observation& both = scene.observations.front();
    both.box = join(both.box, scene.observations.back().box);
    both.points += scene.observations.back().points;
    for (size_t i = 0; i < 3; ++i) {
      float& color = both.descriptors.front().values[i];
      color = (color + scene.observations.back().descriptors.front().values[i]) / 2;
    }
    both.descriptors.back().values = {float(both.box.size.x()), float(both.box.size.y()),
                                      float(both.box.size.z())};
    scene.view.labels.setTo(0, scene.view.labels == 1);
    scene.observations.pop_back();
    return scene;
  }

  SyntheticKitchen kitchen;
  BeliefState state;
};

TEST_F(Merged, NoneOfThemIsGone) {
  advance(state, kitchen.scene(0));
  const BeliefUpdate update = advance(state, merged(3600));
  EXPECT_THAT(events(update), IsEmpty());
  EXPECT_EQ(update.observations[0].object, 1) << "the larger one";
  EXPECT_EQ(update.objects[1].explanation, Explanation::missed);
  for (const ObjectOutcome& object : update.objects) EXPECT_GT(object.probability_here, 0.95);
}

TEST_F(Merged, TheyAreFoundAsTheyWere) {
  advance(state, kitchen.scene(0));
  advance(state, merged(3600));
  EXPECT_NEAR(state.objects[0].box.size.x(), 0.08, 1e-6) << "the cluster is larger than the cup";
  const BeliefUpdate update = advance(state, kitchen.scene(7200));
  EXPECT_THAT(events(update), IsEmpty());
  EXPECT_EQ(update.observations[0].object, 1);
  EXPECT_EQ(update.observations[1].object, 2);
}

TEST_F(Merged, EqualOnesAreTwo) {
  kitchen.object("jar").color = kitchen.object("cup").color;
  advance(state, kitchen.scene(0));
  EXPECT_THAT(events(advance(state, merged(3600))), IsEmpty());
  EXPECT_THAT(events(advance(state, kitchen.scene(7200))), IsEmpty());
}

TEST_F(Merged, WhatFillsTheSpaceBetweenIsNew) {
  kitchen.object("jar").centre.x() = 0.2;
  advance(state, kitchen.scene(0));
  kitchen.objects = {
      {"tray", SyntheticKitchen::on_table(0.0975, 0, 0.1), {0.275, 0.08, 0.1}, {0.2F, 0.8F, 0.2F}}};
  EXPECT_THAT(events(advance(state, kitchen.scene(3600))),
              UnorderedElementsAre("gone 1", "gone 2", "appeared 3"));
}

TEST_F(Merged, ThatOneIsLeftIsNoCluster) {
  advance(state, kitchen.scene(0));
  kitchen.objects.pop_back();
  EXPECT_THAT(events(advance(state, kitchen.scene(3600))), ElementsAre("gone 2"));
}

}  // namespace
}  // namespace loci::memory::belief
