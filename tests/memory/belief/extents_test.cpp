#include "memory/belief/extents.h"

#include <gtest/gtest.h>

namespace loci::memory::belief {
namespace {

StoredView view(const std::vector<float>& extents, bool partial = false, double weight = 1) {
  return {{{"extents", extents}}, weight, 0, partial};
}

ProtoObject cereal(std::vector<StoredView> views) {
  ProtoObject object;
  object.views = std::move(views);
  return object;
}

TEST(Extents, AreThoseOfWholeViews) {
  const std::vector<float> whole = {0.19F, 0.07F, 0.28F}, part = {0.06F, 0.06F, 0.1F};
  EXPECT_TRUE(
      extents_of(cereal({view(whole), view(part, true)}))->isApprox(Vector3d(0.19, 0.07, 0.28), 1e-6));
  EXPECT_TRUE(extents_of(cereal({view(part, true)}))->isApprox(Vector3d(0.06, 0.06, 0.1), 1e-6))
      << "at least";
  EXPECT_FALSE(extents_of(cereal({}))) << "nothing was measured";
}

TEST(Extents, OfASideThatAViewDoesNotShowAreThoseOfOtherViews) {
  const StoredView front = view({0.19F, 0.01F, 0.28F, 1, 0, 1}, false, 5),
                   oblique = view({0.07F, 0.19F, 0.28F, 1, 1, 1});
  EXPECT_TRUE(extents_of(cereal({front, oblique}))->isApprox(Vector3d(0.19, 0.07, 0.28), 1e-6));
}

TEST(Extents, AreOfThePresentPose) {
  StoredView lying = view({0.25F, 0.06F, 0.06F}), standing = view({0.06F, 0.06F, 0.25F});
  lying.time = 1;
  EXPECT_TRUE(extents_of(cereal({standing, lying}))->isApprox(Vector3d(0.25, 0.06, 0.06), 1e-6));
}

TEST(Extents, ShrinkSlowly) {
  const ProtoObject front = cereal({view({0.19F, 0.01F, 0.28F})});
  EXPECT_GT(extents_of(front, Vector3d(0.19, 0.07, 0.28))->y(), 0.05) << "seen deeper before";
  EXPECT_NEAR(extents_of(front, Vector3d(0.28, 0.19, 0.07))->y(), 0.01, 1e-6) << "it lay then";
}

TEST(Extents, AreNotThoseOfAViewThatTookANeighbourIn) {
  EXPECT_NEAR(extents_of(cereal({view({0.1F, 0.1F, 0.1F}, false, 4), view({0.3F, 0.1F, 0.1F})}))->x(), 0.1,
              1e-6);
}

}  // namespace
}  // namespace loci::memory::belief
