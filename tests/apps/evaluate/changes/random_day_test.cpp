#include "apps/evaluate/changes/random_day.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/simulation/scenario.h"

namespace loci::apps::changes {
namespace {

class RandomDay : public ::testing::TestWithParam<const char*> {
 protected:
  std::string day(uint64_t seed) const {
    return random_day(
        sample_day_world(GetParam()),
        std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples" / (std::string(GetParam()) + ".urdf"), seed);
  }
};

TEST_P(RandomDay, IsAScenarioInWhichTheMiddleCupGoesAwayAndComesBack) {
  for (const uint64_t seed : {1U, 2U, 3U}) {
    const TemporaryFolder folder("loci_test");
    const auto file = folder.path() / "day.yaml";
    write_file_atomically(file, day(seed));
    const mapping::Scenario scenario = mapping::read_scenario(file);
    EXPECT_EQ(scenario.scenes.size(), 18U);
    EXPECT_EQ(scenario.objects.size(), 16U);
    size_t moves = 0, actions = 0;
    for (const mapping::SceneSpec& scene : scenario.scenes) {
      actions += scene.actions.size();
      moves += static_cast<size_t>(std::ranges::count_if(
          scene.actions, [](const mapping::Action& action) { return action.subject == "cup_1"; }));
    }
    EXPECT_GE(moves, 2U);
    EXPECT_GT(actions, 20U) << "objects are put there, and objects happen";
  }
}

TEST_P(RandomDay, IsTheSameForTheSameSeed) {
  EXPECT_EQ(day(7), day(7));
  EXPECT_NE(day(7), day(8));
}

/// A room with a counter against a wall, a box that belongs to the room on it, and a board over the floor.
std::filesystem::path small_room(const TemporaryFolder& folder) {
  const auto box = [](const std::string& name, const char* at, const char* size) {
    return "<link name='" + name + "'><visual><origin xyz='" + at + "'/><geometry><box size='" + size +
           "'/></geometry></visual></link><joint name='" + name +
           "_joint' type='fixed'><parent link='map'/><child link='" + name + "'/></joint>";
  };
  const auto file = folder.path() / "small_room.urdf";
  write_file_atomically(
      file, "<robot name='room'><link name='map'/>" + box("floor", "2 2 -0.05", "4 4 0.1") +
                box("wall_1", "2 4.05 1.25", "4 0.1 2.5") + box("wall_2", "2 -0.05 1.25", "4 0.1 2.5") +
                box("wall_3", "-0.05 2 1.25", "0.1 4 2.5") + box("wall_4", "4.05 2 1.25", "0.1 4 2.5") +
                box("counter_1", "2 3.7 0.45", "2 0.6 0.9") + box("kettle_1", "1.5 3.7 1", "0.2 0.2 0.2") +
                box("table_low", "2 1 0.1", "1 1 0.2") + "</robot>");
  return file;
}

TEST(FoundDayWorld, HasFreeStretchesOfTopsAndPlacesThatSeeThem) {
  const TemporaryFolder folder("loci_test");
  const std::filesystem::path room = small_room(folder);
  Warnings warnings;
  const DayWorld world = find_day_world(room, {}, 1, warnings);
  ASSERT_EQ(world.supports.size(), 2U) << "the counter in two parts; nothing is put on what is so low";
  for (const Support& support : world.supports) {
    EXPECT_EQ(support.link, "counter_1");
    EXPECT_LE(support.x, 0.5);
    ASSERT_FALSE(support.views.empty());
    for (const View& view : support.views) {
      EXPECT_TRUE(view.from.y() < 3.4 || std::abs(view.from.x() - 2) > 1) << "nobody stands on the counter";
      EXPECT_NEAR(view.at.z(), 0.9, 1e-6);
    }
  }
  const auto is_blocked = [](const Support& support, const Vector2d& at) {
    return std::ranges::any_of(support.blocked,
                               [&](const Vector2d& one) { return (one - at).norm() < 0.03; });
  };
  const auto& left = world.supports[world.supports[0].middle.x() < 0 ? 0 : 1];
  EXPECT_TRUE(is_blocked(left, {-0.5, 0})) << "the kettle stands there";
  EXPECT_FALSE(is_blocked(left, {-0.2, 0}));
  EXPECT_EQ(random_day(world, room, 3), random_day(world, room, 3));
}

TEST(FoundDayWorld, NeedsRoomForObjects) {
  const TemporaryFolder folder("loci_test");
  const auto file = folder.path() / "bare_room.urdf";
  write_file_atomically(file, "<robot name='room'><link name='map'/></robot>");
  Warnings warnings;
  EXPECT_THROW(find_day_world(file, {}, 1, warnings), Error);
}

INSTANTIATE_TEST_SUITE_P(Kitchens, RandomDay, ::testing::Values("kitchen", "kitchen_l"));

}  // namespace
}  // namespace loci::apps::changes
