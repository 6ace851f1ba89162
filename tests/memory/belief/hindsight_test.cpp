#include "memory/belief/hindsight.h"

#include <gmock/gmock.h>

#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory::belief {
namespace {

using ::testing::AllOf;
using ::testing::Field;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Lt;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

/// Three equal cups on one table; from the second scene on one of them stands on another, out of view of the
/// first.
class Hindsight : public ::testing::Test {
 protected:
  Hindsight() {
    for (int i = 0; i < 3; ++i)
      kitchen.objects.push_back({std::to_string(i), SyntheticKitchen::on_table(0.25 * i - 0.25, 0)});
  }

  void observe(double minutes, const Isometry3d& from) {
    kitchen.map_from_camera = from;
    scenes.push_back(kitchen.scene(60 * minutes));
  }

  std::map<int64_t, Supposition> look_back() const {
    NoProgress quiet;
    return hindsight({}, scenes, {}, quiet);
  }

  /// What each observation is taken for with what is known.
  std::vector<std::vector<int64_t>> decided(const std::map<int64_t, Supposition>& known) const {
    BeliefState state;
    std::vector<std::vector<int64_t>> objects;
    for (Scene scene : scenes) {
      for (Observation& observation : scene.observations)
        if (const auto one = known.find(observation.id); one != known.end())
          observation.known_object = one->second.object;
      objects.emplace_back();
      for (const ObservationOutcome& outcome : advance(state, scene).observations)
        objects.back().push_back(outcome.object);
    }
    return objects;
  }

  const Isometry3d here = SyntheticKitchen::look_from({0, -1.0, 1.4}, {0, 0, 0.72}),
                   there = SyntheticKitchen::look_from({4, -1.0, 1.4}, {4, 0, 0.72});
  SyntheticKitchen kitchen;
  std::vector<Scene> scenes;
};

TEST_F(Hindsight, TellsWhichOfEqualCupsWasMoved) {
  for (const int moved : {0, 1, 2}) {
    SCOPED_TRACE(moved);
    for (int i = 0; i < 3; ++i)
      kitchen.objects[static_cast<size_t>(i)].centre = SyntheticKitchen::on_table(0.25 * i - 0.25, 0);
    scenes.clear();
    observe(0, here);
    kitchen.objects[static_cast<size_t>(moved)].centre = SyntheticKitchen::on_table(4, 0);
    observe(20, there);
    observe(21, here);
    observe(22, there);
    const std::map<int64_t, Supposition> known = look_back();
    const auto objects = decided(known);
    EXPECT_EQ(objects[1], std::vector<int64_t>{objects[0][static_cast<size_t>(moved)]});
    EXPECT_EQ(objects[3], objects[1]);
    if (decided({})[1] == objects[1])
      EXPECT_THAT(known, IsEmpty()) << "it was guessed right";
    else
      EXPECT_THAT(known,
                  UnorderedElementsAre(Pair(scenes[1].observations[0].id,
                                            AllOf(Field(&Supposition::object, objects[1][0]),
                                                  Field(&Supposition::probability, AllOf(Gt(0.5), Lt(1)))))));
  }
}

TEST_F(Hindsight, LeavesThemWhereTheyStandWhenNoneWasMoved) {
  observe(0, here);
  kitchen.objects.push_back({"twin", SyntheticKitchen::on_table(4, 0)});
  observe(20, there);
  observe(21, here);
  observe(22, there);
  const auto objects = decided(look_back());
  EXPECT_EQ(objects[2], objects[0]);
  EXPECT_EQ(objects[3], std::vector<int64_t>{4}) << "the twin";
}

TEST_F(Hindsight, ChangesNothingWithoutAContradiction) {
  observe(0, here);
  kitchen.objects[1].centre = SyntheticKitchen::on_table(0, 0.2);
  observe(20, here);
  observe(21, here);
  EXPECT_THAT(look_back(), IsEmpty());
}

}  // namespace
}  // namespace loci::memory::belief
