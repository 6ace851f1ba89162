#include "mapping/interpretation/fronts/fronts.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include "mapping/base/math/random.h"
#include "mapping/base/progress.h"
#include "mapping/interpretation/fronts/face.h"
#include "mapping/interpretation/fronts/front_layout.h"
#include "mapping/interpretation/fronts/seams.h"
#include "tests/mapping/interpretation/synthetic_furniture.h"

namespace loci::mapping::test {
namespace {

std::vector<Front> fronts_of_furniture(const Furniture& furniture, uint64_t seed, int threads = 0) {
  InterpretationOptions options;
  options.threads = threads;
  NoProgress progress;
  const Surface surface = gather_surface(scan_furniture(furniture, kStandpoints, seed), threads, progress);
  return find_fronts(surface, 0, find_walls(surface, 0, std::nullopt, options), options, progress).fronts;
}

/// Intersection over union of a front with a rectangle given by its borders.
double overlap(const Front& front, const Furniture& furniture, double u0, double u1, double v0, double v1) {
  const Vector3d centre = furniture.map_from_furniture.inverse() * front.centre;
  const double width =
      std::min(u1, -centre.y() + front.width / 2) - std::max(u0, -centre.y() - front.width / 2);
  const double height =
      std::min(v1, centre.z() + front.height / 2) - std::max(v0, centre.z() - front.height / 2);
  if (width <= 0 || height <= 0 || std::abs(centre.x()) > 0.03) return 0;
  const double both = width * height;
  return both / (front.width * front.height + (u1 - u0) * (v1 - v0) - both);
}

const Front* front_at(const std::vector<Front>& fronts, const Furniture& furniture, double u0, double u1,
                      double v0, double v1, double least = 0.85) {
  for (const Front& front : fronts)
    if (overlap(front, furniture, u0, u1, v0, v1) >= least) return &front;
  return nullptr;
}

/// A block of 3 × 3 drawers with gaps of 6 mm and a bar on each.
Furniture drawer_block() {
  Furniture block;
  block.add_body(-0.75, 0.75, 0.1, 0.85);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      const double u = -0.75 + 0.5 * column;
      const double v = 0.1 + 0.25 * row;
      block.add_panel(u + 0.003, u + 0.497, v + 0.003, v + 0.247);
      block.add_level_bar(u + 0.25, v + 0.2, 0.16);
    }
  return block;
}

void expect_block(const Furniture& block, const std::vector<Front>& fronts) {
  EXPECT_EQ(fronts.size(), 9U);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      const double u = -0.75 + 0.5 * column;
      const double v = 0.1 + 0.25 * row;
      const Front* front = front_at(fronts, block, u, u + 0.5, v, v + 0.25);
      ASSERT_NE(front, nullptr) << column << " " << row;
      ASSERT_TRUE(front->fixture.has_value());
      EXPECT_EQ(front->fixture->kind, Fixture::Kind::handle);
      EXPECT_LT((front->fixture->centre - block.at(u + 0.25, v + 0.2, 0.03)).norm(), 0.015);
      EXPECT_NEAR(front->fixture->length, 0.16, 0.02);
      EXPECT_GT(std::abs(front->fixture->axis.dot(front->right())), 0.99);
      EXPECT_GT(front->evidence.at("inliers").get<size_t>(), 100U);
    }
}

TEST(Fronts, BlockOfNineDrawersComesApart) {
  const Furniture block = drawer_block();
  expect_block(block, fronts_of_furniture(block, 1));
}

TEST(Fronts, FurnitureThatStandsAskewIsFoundToo) {
  Furniture block = drawer_block();
  block.map_from_furniture = Eigen::Translation3d(2, 1, 0) * Eigen::AngleAxisd(0.4, Vector3d::UnitZ());
  expect_block(block, fronts_of_furniture(block, 2));
}

TEST(Fronts, SameOnAnyNumberOfThreads) {
  const Furniture block = drawer_block();
  const std::vector<Front> one = fronts_of_furniture(block, 3, 1);
  const std::vector<Front> two = fronts_of_furniture(block, 3, 2);
  ASSERT_EQ(one.size(), two.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].centre, two[i].centre);
    EXPECT_EQ(one[i].fixture->centre, two[i].fixture->centre);
  }
}

TEST(Fronts, TellsAKnobFromAHandle) {
  Furniture furniture;
  furniture.add_body(-0.5, 0.5, 0.1, 0.8);
  furniture.add_panel(-0.497, -0.003, 0.1, 0.8);
  furniture.add_panel(0.003, 0.497, 0.1, 0.8);
  furniture.add_knob(-0.06, 0.6);
  furniture.add_upright_bar(0.06, 0.6, 0.14);
  const std::vector<Front> fronts = fronts_of_furniture(furniture, 4);
  const Front* knob = front_at(fronts, furniture, -0.5, 0, 0.1, 0.8);
  const Front* bar = front_at(fronts, furniture, 0, 0.5, 0.1, 0.8);
  ASSERT_NE(knob, nullptr);
  ASSERT_NE(bar, nullptr);
  ASSERT_TRUE(knob->fixture && bar->fixture);
  EXPECT_EQ(knob->fixture->kind, Fixture::Kind::knob);
  EXPECT_LT((knob->fixture->centre - furniture.at(-0.06, 0.6, 0.03)).norm(), 0.015);
  EXPECT_GT(knob->fixture->axis.dot(knob->normal), 0.99);
  EXPECT_EQ(bar->fixture->kind, Fixture::Kind::handle);
  EXPECT_GT(std::abs(bar->fixture->axis.z()), 0.99);
  EXPECT_LT((bar->fixture->centre - furniture.at(0.06, 0.6, 0.03)).norm(), 0.015);
}

TEST(Fronts, ALargeKnobIsNoShortBar) {
  Furniture furniture;
  furniture.add_body(-0.5, 0.5, 0.1, 0.8);
  furniture.add_panel(-0.497, -0.003, 0.1, 0.8);
  furniture.add_panel(0.003, 0.497, 0.1, 0.8);
  furniture.add_knob(-0.06, 0.6, 0.05);
  furniture.add_knob(0.06, 0.6, 0.05);
  for (uint64_t seed = 31; seed < 35; ++seed) {
    const std::vector<Front> fronts = fronts_of_furniture(furniture, seed);
    EXPECT_EQ(fronts.size(), 2U);
    for (const Front& front : fronts) {
      ASSERT_TRUE(front.fixture) << seed;
      EXPECT_EQ(front.fixture->kind, Fixture::Kind::knob) << seed << ": " << front.fixture->length << " m";
    }
  }
}

TEST(Fronts, FrontWithoutHandleIsReportedWhereASeamPartsItFromAnother) {
  Furniture furniture;
  furniture.add_body(-0.5, 0.5, 0.1, 0.8);
  furniture.add_panel(-0.495, -0.005, 0.1, 0.8);
  furniture.add_panel(0.005, 0.495, 0.1, 0.8);
  furniture.add_upright_bar(-0.06, 0.6, 0.14);
  const std::vector<Front> fronts = fronts_of_furniture(furniture, 5);
  EXPECT_EQ(fronts.size(), 2U);
  const Front* plain = front_at(fronts, furniture, 0, 0.5, 0.1, 0.8);
  ASSERT_NE(plain, nullptr);
  EXPECT_FALSE(plain->fixture.has_value());
}

TEST(Fronts, CarcassBesideThePanelsDoesNotTurnTheirFace) {
  Furniture cupboard;
  cupboard.add_body(-0.4, 0.6, 0.05, 0.85);  // 20 cm of it show to the right, 2 cm behind the panels.
  for (const double v : {0.06, 0.46}) {
    cupboard.add_panel(-0.396, 0.396, v, v + 0.38);
    cupboard.add_level_bar(0, v + 0.3, 0.2);
  }
  const std::vector<Front> fronts = fronts_of_furniture(cupboard, 21);
  ASSERT_EQ(fronts.size(), 2U);
  for (const Front& front : fronts) {
    EXPECT_TRUE(front.fixture.has_value());
    EXPECT_GT(front.normal.dot(cupboard.map_from_furniture.linear() * Vector3d::UnitX()),
              std::cos(0.5 * kPi / 180));
  }
}

TEST(Fronts, EqualHandlesAreNoFaceOfTheirOwn) {
  Furniture drawers;  // Flat bars, all 5 cm before the fronts: together larger than a small drawer.
  drawers.add_body(-0.8, 0.8, 0.1, 0.9);
  for (const double u : {-0.4, 0.4})
    for (const double v : {0.1, 0.37, 0.64}) {
      drawers.add_panel(u - 0.397, u + 0.397, v, v + 0.264);
      drawers.parts.push_back({{0.036, -u - 0.3, v + 0.19}, {0.05, -u + 0.3, v + 0.22}});
    }
  NoProgress progress;
  const Surface surface = gather_surface(scan_furniture(drawers, kStandpoints, 13), 0, progress);
  for (const FurnitureFace& face : find_faces(surface, 0))
    EXPECT_FALSE(face.normal.x() > 0.9 && face.offset > 0.03) << face.offset << ", " << face.area;
}

TEST(Fronts, BoardsOfAnOpenShelfAreNoHandles) {
  Furniture shelf;
  shelf.parts.push_back({{-0.02, -0.4, 0}, {0, 0.4, 1.4}});  // One side of it; boards stand out of that.
  for (const double height : {0.3, 0.7, 1.1})
    shelf.parts.push_back({{0, -0.35, height}, {0.8, -0.05, height + 0.025}});
  for (const Front& front : fronts_of_furniture(shelf, 22)) EXPECT_FALSE(front.fixture.has_value());
}

TEST(Fronts, PlainBoxHasNone) {
  Furniture furniture;
  furniture.add_body(-0.5, 0.5, 0.1, 0.8);
  furniture.add_body(-0.2, 0.2, 0.8, 1.1);
  EXPECT_TRUE(fronts_of_furniture(furniture, 6).empty());
}

TEST(Fronts, DrawersWithoutVisibleSeamAreDividedByTheirHandlesAndSurenessIsLess) {
  Furniture furniture;
  furniture.add_body(-0.3, 0.3, 0.1, 0.82);
  furniture.add_panel(-0.3, 0.3, 0.1, 0.82);
  for (const double v : {0.22, 0.46, 0.7}) furniture.add_level_bar(0, v, 0.16);
  const std::vector<Front> fronts = fronts_of_furniture(furniture, 7);
  ASSERT_EQ(fronts.size(), 3U);
  for (const double v : {0.22, 0.46, 0.7}) {
    const Front* front = front_at(fronts, furniture, -0.3, 0.3, v - 0.12, v + 0.12, 0.8);
    ASSERT_NE(front, nullptr) << v;
    EXPECT_LT(front->confidence, 0.6);
  }
}

/// Rays on a low unit and a tall one beside it, flush and without a gap between them.
FaceRays rays_on_flush_units() {
  FaceRays rays;
  rays.face.u_max = 1.5;
  rays.face.v_min = 0.1;
  rays.face.v_max = 1.6;
  rays.sigma = 0.002;
  rays.scans = 1;
  Random random(1);
  for (double u = -0.1; u < 1.6; u += 0.004)
    for (double v = 0; v < 1.7; v += 0.004) {
      const bool on_face = u > 0 && u < 1.5 && v > 0.1 && v < (u < 0.9 ? 0.8 : 1.6);
      FaceRay ray;
      ray.u = static_cast<float>(u);
      ray.v = static_cast<float>(v);
      ray.depth = on_face ? static_cast<float>(random.normal(rays.sigma)) : -0.5F;
      rays.rays.push_back(ray);
    }
  return rays;
}

TEST(Fronts, ATallUnitBesideALowOneComesApart) {
  const FaceRays rays = rays_on_flush_units();
  std::vector<FaceFixture> fixtures;
  for (const Vector2d& at : {Vector2d(0.45, 0.7), Vector2d(1.2, 0.7)})
    fixtures.push_back({{}, at.x(), at.y(), FaceRect{at.x(), at.x(), at.y(), at.y()}.grown(0.02)});
  const std::vector<PlacedFront> fronts = lay_out_fronts(SeamMap(rays, fixtures), rays.face, fixtures).fronts;
  ASSERT_EQ(fronts.size(), 2U);
  for (const PlacedFront& front : fronts) {
    const bool low = front.fixture == 0;
    EXPECT_NEAR(front.rect.u0, low ? 0 : 0.9, 0.015);
    EXPECT_NEAR(front.rect.u1, low ? 0.9 : 1.5, 0.015);
    EXPECT_NEAR(front.rect.v1, low ? 0.8 : 1.6, 0.015);
  }
}

TEST(Fronts, AFrontWithoutHandleBelowTheEdgeOfACounterIsReported) {
  Furniture furniture;
  furniture.add_body(-0.6, 0.6, 0.1, 0.8);
  furniture.parts.push_back({{-0.5, -0.6, 0.8}, {0.015, 0.6, 0.84}});
  for (const double u : {-0.6, -0.2, 0.2}) furniture.add_panel(u + 0.004, u + 0.396, 0.1, 0.795);
  furniture.add_level_bar(-0.4, 0.7, 0.14);
  furniture.add_level_bar(0.4, 0.7, 0.14);
  const std::vector<Front> fronts = fronts_of_furniture(furniture, 5);
  const Front* plain = front_at(fronts, furniture, -0.2, 0.2, 0.1, 0.8);
  ASSERT_NE(plain, nullptr);
  EXPECT_FALSE(plain->fixture.has_value());
}

TEST(Fronts, ARowWithoutAnyHandleBelowACounterIsReportedWhereAPlinthRecedes) {
  for (const bool plinth : {true, false}) {
    Furniture furniture;
    furniture.add_body(-0.6, 0.6, 0.1, 0.8);
    furniture.parts.push_back({{-0.5, -0.6, 0.8}, {0.015, 0.6, 0.84}});
    furniture.parts.push_back({{-0.5, -0.6, 0}, {plinth ? -0.05 : 0, 0.6, 0.1}});
    for (const double u : {-0.6, -0.2, 0.2}) furniture.add_panel(u + 0.004, u + 0.396, 0.1, 0.795);
    const std::vector<Front> fronts = fronts_of_furniture(furniture, 5);
    EXPECT_EQ(fronts.size(), plinth ? 3U : 0U);
    for (const double u : {-0.6, -0.2, 0.2})
      EXPECT_EQ(front_at(fronts, furniture, u, u + 0.4, 0.1, 0.8) != nullptr, plinth) << u;
  }
}

TEST(Fronts, AFrontWithoutHandleBesideATallUnitIsReported) {
  Furniture furniture;
  furniture.add_body(-0.6, 0.6, 0.1, 0.8);
  furniture.parts.push_back({{-0.5, -0.6, 0.8}, {0.015, 0.6, 0.84}});
  furniture.parts.push_back({{-0.5, -0.9, 0}, {0.02, -0.6, 1.1}});  // A higher unit stands proud beside it.
  for (const double u : {-0.6, -0.2}) {
    furniture.add_panel(u + 0.004, u + 0.396, 0.1, 0.795);
    furniture.add_level_bar(u + 0.2, 0.7, 0.14);
  }
  furniture.add_panel(0.204, 0.598, 0.1, 0.795);
  const std::vector<Front> fronts = fronts_of_furniture(furniture, 5);
  const Front* plain = front_at(fronts, furniture, 0.2, 0.6, 0.1, 0.8);
  ASSERT_NE(plain, nullptr);
  EXPECT_FALSE(plain->fixture.has_value());
}

TEST(Fronts, ALowDrawerWithoutHandleOverThePlinthIsReportedAndACoverOverAFrontIsNot) {
  Furniture oven;
  oven.add_body(-0.3, 0.3, 0, 0.8);
  oven.add_panel(-0.3, 0.3, 0.1, 0.2);
  oven.add_panel(-0.3, 0.3, 0.208, 0.69);
  oven.add_panel(-0.3, 0.3, 0.698, 0.8);
  oven.add_level_bar(0, 0.62, 0.4);
  const std::vector<Front> fronts = fronts_of_furniture(oven, 6);
  EXPECT_EQ(fronts.size(), 2U);
  EXPECT_NE(front_at(fronts, oven, -0.3, 0.3, 0.1, 0.2), nullptr);
}

TEST(Fronts, TheNoiseOfAFaceIsNotThatOfTheWallBehindIt) {
  // Over the lower part, which is face, rays end far behind: a low row beside a tall unit.
  FaceRays rays;
  rays.face.u_max = rays.face.v_max = 1;
  rays.sigma = 0.015;
  Random random(7);
  for (int i = 0; i < 100'000; ++i) {
    FaceRay ray;
    ray.u = static_cast<float>(random.uniform());
    ray.v = static_cast<float>(random.uniform());
    ray.depth = ray.v < 0.3F ? static_cast<float>(random.normal(rays.sigma)) : -0.6F;
    rays.rays.push_back(ray);
  }
  const SeamMap seams(rays, {});
  for (double u = 0.1; u < 0.9; u += 0.004) EXPECT_LT(seams.line(true, u, 0.02, 0.28).z, kLayout.min_z) << u;
}

TEST(Fronts, TwoScansThatLieApartDoNotDoubleAFront) {
  const Furniture block = drawer_block();
  ScanSet scans = scan_furniture(block, kStandpoints, 1);
  for (const size_t moved : {1U, 3U}) scans.scans[moved].map_from_scan.translation().x() += 0.05;
  InterpretationOptions options;
  NoProgress progress;
  const Surface surface = gather_surface(scans, 0, progress);
  const std::vector<Front> fronts =
      find_fronts(surface, 0, find_walls(surface, 0, std::nullopt, options), options, progress).fronts;
  EXPECT_GE(fronts.size(), 6U);
  for (const Front& a : fronts)
    for (const Front& b : fronts) {
      const Vector3d apart = b.centre - a.centre;
      EXPECT_TRUE(&a == &b || std::hypot(apart.y(), apart.z()) > 0.1);
    }
}

TEST(Fronts, TheSideOfACupboardIsNoFrontOfItsOwn) {
  const auto front = [](const Vector3d& centre, const Vector3d& normal, double width, double confidence) {
    Front one;
    one.centre = centre;
    one.normal = normal;
    one.width = width;
    one.height = 0.7;
    one.confidence = confidence;
    return one;
  };
  const Front door = front({0, 0, 0.5}, Vector3d::UnitX(), 0.6, 0.9);
  const Front side = front({-0.3, 0.3, 0.5}, Vector3d::UnitY(), 0.58, 0.5);
  const Front inner = front({0.3, 0.3, 0.5}, -Vector3d::UnitY(), 0.58, 0.5);  // of an L
  const Front above = front({-0.3, 0.3, 1.5}, Vector3d::UnitY(), 0.58, 0.5);
  std::vector<Front> fronts = {side, door, inner, above};
  drop_side_panels(fronts);
  ASSERT_EQ(fronts.size(), 3U);
  EXPECT_EQ(fronts[0].centre, door.centre);
  EXPECT_EQ(fronts[1].centre, inner.centre);
  EXPECT_EQ(fronts[2].centre, above.centre);
}

TEST(Fronts, AStripNarrowerThanAnyPullOutIsNoFront) {
  for (const double width : {0.1, 0.2}) {
    Furniture furniture;
    furniture.add_body(-0.5, 0.5, 0.1, 0.8);
    for (const double u : {-0.5, -0.5 + width}) furniture.add_panel(u + 0.003, u + width - 0.003, 0.1, 0.8);
    furniture.add_upright_bar(-0.5 + width / 2, 0.6, 0.14);
    furniture.add_upright_bar(-0.5 + 1.5 * width, 0.6, 0.14);
    const std::vector<Front> fronts = fronts_of_furniture(furniture, 4);
    const auto narrow =
        std::ranges::count_if(fronts, [&](const Front& one) { return std::abs(one.width - width) < 0.02; });
    EXPECT_EQ(narrow, width < 0.12 ? 0 : 2);
  }
}

TEST(Fronts, ConfidenceFollowsTheEdges) {
  PlacedFront front;
  for (FrontEdge& edge : front.edges) edge = {FrontEdge::Kind::seam, 20, true, 0};
  const double seams = front.edge_confidence();
  for (FrontEdge& edge : front.edges) edge = {};
  const double borders = front.edge_confidence();
  for (FrontEdge& edge : front.edges) edge.kind = FrontEdge::Kind::regular;
  EXPECT_GT(seams, 0.9);
  EXPECT_LT(borders, 0.8);
  EXPECT_LT(front.edge_confidence(), borders);
}

TEST(Fronts, RibsOfARadiatorAreNoHandles) {
  Furniture radiator;
  radiator.add_panel(-0.5, 0.5, 0.15, 0.65);
  for (int rib = 0; rib < 9; ++rib) radiator.add_upright_bar(-0.4 + 0.1 * rib, 0.4, 0.42);
  for (const uint64_t seed : {1, 2}) EXPECT_EQ(fronts_of_furniture(radiator, seed).size(), 0U);
}

TEST(Fronts, ABarWithoutRoomForFingersBehindItIsNoHandle) {
  for (const bool is_free : {false, true}) {
    Furniture block;
    block.add_body(-0.3, 0.3, 0.1, 0.85);
    block.add_panel(-0.297, 0.297, 0.103, 0.847);
    const double behind = is_free ? 0.024 : 0.0;
    block.parts.push_back({{behind, -0.006, 0.4}, {behind + 0.010, 0.006, 0.6}});
    const std::vector<Front> fronts = fronts_of_furniture(block, 1);
    const bool has_handle =
        std::ranges::any_of(fronts, [](const Front& front) { return front.fixture.has_value(); });
    EXPECT_EQ(has_handle, is_free);
  }
}

TEST(Fronts, ABarAsLongAsItsFrontIsAHandle) {
  Furniture block;
  block.add_body(-0.3, 0.3, 0.1, 0.85);
  for (const double v : {0.1, 0.475}) {
    block.add_panel(-0.297, 0.297, v + 0.003, v + 0.372);
    block.add_level_bar(0, v + 0.25, 0.585);
  }
  const std::vector<Front> fronts = fronts_of_furniture(block, 1);
  for (const double v : {0.1, 0.475}) {
    const Front* front = front_at(fronts, block, -0.3, 0.3, v, v + 0.375);
    ASSERT_NE(front, nullptr) << v;
    ASSERT_TRUE(front->fixture.has_value()) << v;
    EXPECT_NEAR(front->fixture->length, 0.585, 0.06);
  }
}

TEST(Fronts, BarsThatNearlyMeetBelongToTheFrontsTheyAreOn) {
  Furniture block;
  block.add_body(-0.45, 0.45, 0.1, 0.85);
  for (const double u : {-0.45, -0.15, 0.15}) {
    block.add_panel(u + 0.003, u + 0.297, 0.1, 0.85);
    block.add_level_bar(u + 0.15, 0.79, 0.24);  // 6 cm to the next one
  }
  const std::vector<Front> fronts = fronts_of_furniture(block, 2);
  for (const double u : {-0.45, -0.15, 0.15}) {
    const Front* front = front_at(fronts, block, u, u + 0.3, 0.1, 0.85);
    ASSERT_NE(front, nullptr) << u;
    ASSERT_TRUE(front->fixture.has_value()) << u;
    EXPECT_NEAR(front->fixture->length, 0.24, 0.04);
    EXPECT_LT((front->fixture->centre - block.at(u + 0.15, 0.79, 0.03)).norm(), 0.02);
  }
}

TEST(Fronts, TheBackOfOpenShelvesIsNoFront) {
  Furniture shelf;
  shelf.add_body(-0.3, 0.3, 0.7, 1.3);
  for (const double u : {-0.3, 0.28}) shelf.parts.push_back({{0, -u - 0.02, 0.7}, {0.35, -u, 1.3}});
  for (const double v : {0.7, 1.0, 1.28}) shelf.parts.push_back({{0, -0.3, v}, {0.35, 0.3, v + 0.02}});
  EXPECT_TRUE(fronts_of_furniture(shelf, 5).empty());
}

TEST(Fronts, AHandleTenCentimetresBeforeItsFrontIsFound) {
  Furniture block;
  block.add_body(-0.3, 0.3, 0.1, 0.85);
  for (const double v : {0.1, 0.475}) {
    block.add_panel(-0.297, 0.297, v + 0.003, v + 0.372);
    block.parts.push_back({{0.085, -0.15, v + 0.2}, {0.099, 0.15, v + 0.214}});
  }
  const std::vector<Front> fronts = fronts_of_furniture(block, 1);
  for (const double v : {0.1, 0.475}) {
    const Front* front = front_at(fronts, block, -0.3, 0.3, v, v + 0.375);
    ASSERT_NE(front, nullptr) << v;
    EXPECT_TRUE(front->fixture.has_value()) << v;
  }
}

TEST(Fronts, MirrorLikeFrontLeavesItsNeighboursAlone) {
  Furniture furniture;
  furniture.add_body(-0.9, 0.9, 0.1, 0.8);
  for (int i = 0; i < 3; ++i) {
    const double u = -0.9 + 0.6 * i;
    furniture.add_panel(u + 0.003, u + 0.597, 0.1, 0.8, i == 1);
    furniture.add_level_bar(u + 0.3, 0.72, 0.2);
  }
  const std::vector<Front> fronts = fronts_of_furniture(furniture, 8);
  for (const int i : {0, 2}) {
    const double u = -0.9 + 0.6 * i;
    const Front* front = front_at(fronts, furniture, u, u + 0.6, 0.1, 0.8);
    ASSERT_NE(front, nullptr) << i;
    EXPECT_TRUE(front->fixture.has_value());
  }
  EXPECT_LE(fronts.size(), 3U);
}

TEST(Fronts, AreNamedColumnByColumnAndTheSameInEveryScan) {
  const Furniture block = drawer_block();
  NoProgress progress;
  const InterpretedMap first = interpret(scan_furniture(block, kStandpoints, 10), {}, progress);
  const InterpretedMap second = interpret(
      scan_furniture(block, {{1.3, 0.4, 1.25}, {1.5, -0.4, 1.25}, {1.7, 0.1, 1.25}}, 11), {}, progress);
  ASSERT_EQ(first.fronts.size(), 9U);
  ASSERT_EQ(second.fronts.size(), 9U);
  for (size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(first.fronts[i].name, second.fronts[i].name);
    EXPECT_LT((first.fronts[i].centre - second.fronts[i].centre).norm(), 0.03);
    EXPECT_NE(first.world.find_link(first.fronts[i].name + "_handle"), nullptr);
  }
  EXPECT_EQ(first.fronts[0].name, "drawer_1");
  EXPECT_GT(first.fronts[0].centre.z(), first.fronts[1].centre.z());
}

TEST(Fronts, NothingIsFoundInNothing) {
  EXPECT_TRUE(fronts_of_furniture({}, 9).empty());
}

}  // namespace
}  // namespace loci::mapping::test
