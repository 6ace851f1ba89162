#include <gtest/gtest.h>

#include <algorithm>

#include "apps/evaluate/mapping/mapper.h"
#include "mapping/base/math/math.h"

namespace loci::apps::mapping_claim {
namespace {

/// A kitchen with askew furniture on which nothing was tuned, scanned from eight places.
TEST(MappingFigures, AimsAreMetInAKitchenWithAskewFurniture) {
  mapping_claim::Run run;
  run.world = std::filesystem::path(LOCI_SOURCE_DIR) / "tests/data/kitchens/askew.urdf";
  run.truth = run.world;
  run.folder = std::filesystem::path(testing::TempDir()) / "loci_askew_kitchen";
  const auto pose = [&](double x, double y, double yaw_deg) {
    run.poses.push_back({x, y, yaw_deg * kPi / 180});
  };
  pose(1.0, 2.6, 90);
  pose(2.0, 2.65, 90);
  pose(3.2, 2.6, 90);
  pose(1.7, 0.45, 80);
  pose(2.7, 0.45, 100);
  pose(3.0, 1.7, 0);
  pose(3.2, 2.6, -50);
  pose(0.7, 1.3, 20);
  NoProgress progress;
  Warnings warnings;
  const MappedWorld map = map_world(run, progress, warnings);
  const std::vector<Figure> figures = figures_of({&map});
  const auto value = [&](const std::string& name) {
    const auto found = std::ranges::find(figures, name, &Figure::name);
    EXPECT_TRUE(found != figures.end() && found->known) << name;
    return found == figures.end() ? 0 : found->value;
  };
  EXPECT_GE(value("handles found"), 95);
  EXPECT_GE(value("handles not invented"), 95);
  EXPECT_GE(value("handle centres within 1.5 cm"), 95);
  EXPECT_GE(value("fronts found"), 95);
  EXPECT_GE(value("front IoU before pulling, mean"), 0.9);
  EXPECT_GE(value("joint type before pulling"), 85);
  EXPECT_GE(value("support IoU, mean"), 0.9);
  EXPECT_LE(value("support height, worst"), 1);
  EXPECT_LE(value("wall offset, worst"), 1);
  EXPECT_EQ(value("contacts in the closed state"), 0);
  EXPECT_EQ(value("joints that jam"), 0);
}

}  // namespace
}  // namespace loci::apps::mapping_claim
