#include "apps/evaluate/changes/comparison.h"

#include <gtest/gtest.h>

namespace loci::apps::changes {
namespace {

/// Cup and bowl stand on a table; in frame 1 the cup is 40 cm farther, in frame 2 the bowl is away.
struct Table : testing::Test {
  Table() {
    add(0, {"cup", "bowl"});
    add(1, {"cup", "bowl"});
    add(2, {"cup"});
    truth.transitions = {{0, 0, "cup", "added"},      {0, 0, "bowl", "added"},    {0, 1, "cup", "moved"},
                         {0, 1, "bowl", "unchanged"}, {1, 2, "cup", "unchanged"}, {1, 2, "bowl", "removed"}};
  }

  Vector3d where(int64_t frame, const std::string& true_object) const {
    return true_object == "bowl" ? Vector3d(1, 1, 0.8) : Vector3d(frame == 0 ? 0.0 : 0.4, 0, 0.8);
  }

  /// Observation 10 is the cup in frame 1, 11 the bowl, and so on.
  void add(int64_t frame, const std::vector<std::string>& true_objects) {
    moments[frame].camera = memory::SceneCamera{640, 480, 500, 500, 320, 240, {}, {}};
    moments[frame].map_from_camera.translation() = Vector3d(0.5, 0.5, -1.5);
    for (const std::string& true_object : true_objects) {
      const bool bowl = true_object == "bowl";
      truth.visible[frame].push_back(
          {true_object, where(frame, true_object), Vector3d(0.1, 0.1, 0.1), std::nullopt});
      truth.handled[frame][true_object] = true_object == "cup" && frame > 0 ? 1 : 0;
      Sight sight{10 * frame + (bowl ? 1 : 0), where(frame, true_object), std::nullopt, {}};
      sight.evidence.box = {sight.position, Vector3d(0.1, 0.1, 0.1)};
      sight.evidence.descriptors = {
          {"mean_color", bowl ? std::vector<float>{0, 0, 1} : std::vector<float>{1, 0, 0}}};
      moments[frame].sights.push_back(sight);
    }
  }

  Truth truth;
  Moments moments;
};

TEST_F(Table, AStoryThatIsTrueIsRightThroughout) {
  const Story story{{0, {{{0, 1}, {1, 2}}, {{1, {"appeared"}}, {2, {"appeared"}}}}},
                    {1, {{{10, 1}, {11, 2}}, {{1, {"moved"}}}}},
                    {2, {{{20, 1}}, {{2, {"gone"}}}}}};
  const Comparison comparison = compare("true", truth, moments, story);
  EXPECT_EQ(comparison.right(), 6U);
  EXPECT_EQ(comparison.certain(), 6U);
  EXPECT_DOUBLE_EQ(comparison.identity_f1(), 1);
  EXPECT_EQ(comparison.switches, 0U);
  EXPECT_EQ(comparison.false_gone, 0U);
}

TEST_F(Table, LostIdentityCostsItsSightingsAndFalseDisappearancesAreCounted) {
  // The cup that was moved is taken for a new one, and so is the bowl that stood still.
  const Story story{
      {0, {{{0, 1}, {1, 2}}, {{1, {"appeared"}}, {2, {"appeared"}}}}},
      {1, {{{10, 3}, {11, 4}}, {{1, {"gone"}}, {2, {"gone"}}, {3, {"appeared"}}, {4, {"appeared"}}}}},
      {2, {{{20, 3}}, {{4, {"gone"}}}}}};
  const Comparison comparison = compare("lost", truth, moments, story);
  EXPECT_EQ(comparison.count("moved", "identity lost"), 1U);
  EXPECT_EQ(comparison.count("unchanged", "identity lost"), 1U);
  EXPECT_EQ(comparison.switches, 2U);
  EXPECT_EQ(comparison.false_gone, 1U);  // the bowl's; the cup is indeed not where it was
  // Cup: two of three sightings as one object; bowl: one of two.
  EXPECT_DOUBLE_EQ(comparison.identity_f1(), 2.0 * 3 / 10);
}

TEST_F(Table, NearestKnowsNoMovesBeyondItsReachAndGreedyGoesByLooks) {
  const Comparison nearest = compare("nearest", truth, moments, nearest_story(moments));
  EXPECT_EQ(nearest.count("moved", "identity lost"), 1U);
  const Comparison greedy = compare("greedy", truth, moments, greedy_story(moments));
  EXPECT_EQ(greedy.right(), 6U);
}

}  // namespace
}  // namespace loci::apps::changes
