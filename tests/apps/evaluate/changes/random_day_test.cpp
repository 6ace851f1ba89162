#include "apps/evaluate/changes/random_day.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "mapping/simulation/scenario.h"

namespace loci::apps::changes {
namespace {

class RandomDay : public ::testing::TestWithParam<const char*> {
 protected:
  std::string day(uint64_t seed) const {
    return random_day(
        day_world(GetParam()),
        std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples" / (std::string(GetParam()) + ".urdf"), seed);
  }
};

TEST_P(RandomDay, IsAScenarioInWhichTheMiddleCupGoesAwayAndComesBack) {
  for (const uint64_t seed : {1U, 2U, 3U}) {
    const auto file =
        std::filesystem::temp_directory_path() / (std::string("loci_day_") + GetParam() + ".yaml");
    write_file_atomically(file, day(seed));
    const mapping::Scenario scenario = mapping::read_scenario(file);
    std::filesystem::remove(file);
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

INSTANTIATE_TEST_SUITE_P(Kitchens, RandomDay, ::testing::Values("kitchen", "kitchen_l"));

}  // namespace
}  // namespace loci::apps::changes
