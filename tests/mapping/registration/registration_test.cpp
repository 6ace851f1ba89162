#include "mapping/registration/registration.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/text/json.h"
#include "mapping/registration/prepared_scan.h"
#include "tests/mapping/registration/box_room.h"

namespace loci::mapping {
namespace {

using ::testing::HasSubstr;
using testing::kitchen;
using testing::study;
using testing::sweep;

Isometry3d planar_motion(double x, double y, double yaw_deg) {
  Isometry3d motion = Isometry3d::Identity();
  motion.translation() = Vector3d(x, y, 0);
  motion.linear() = Eigen::AngleAxisd(yaw_deg * kDegree, Vector3d::UnitZ()).toRotationMatrix();
  return motion;
}

Isometry3d between(const Scan& target, const Scan& source) {
  return target.map_from_scan.inverse() * source.map_from_scan;
}

double position_error(const Isometry3d& a, const Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

double angle_error_deg(const Isometry3d& a, const Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() / kDegree;
}

Scan kitchen_scan(double x, double y, double yaw_deg, uint64_t seed) {
  return sweep(testing::kitchen(), x, y, yaw_deg * kDegree, seed);
}

TEST(Align, FindsThePoseFromHalfAMetreAndThirtyDegreesOff) {
  const Scan target = kitchen_scan(-0.8, -0.3, 60, 1), source = kitchen_scan(0.3, 0.2, 100, 2);
  const Isometry3d truth = between(target, source);
  for (const double side : {-1.0, 1.0}) {
    for (const char* method : {"plane", "generalised", "point"}) {
      RegistrationOptions options;
      options.method = method;
      const Isometry3d guess = truth * planar_motion(0.35 * side, 0.35, -30 * side);
      const PairAlignment pair = align(target, source, guess, options);
      EXPECT_TRUE(pair.trusted) << method << ": " << pair.reason;
      const bool paper = std::string(method) == "point";
      EXPECT_LT(position_error(pair.target_from_source, truth), paper ? 0.02 : 0.005) << method;
      EXPECT_LT(angle_error_deg(pair.target_from_source, truth), paper ? 0.4 : 0.1) << method;
    }
  }
}

TEST(Align, FindsAllSixDegreesOfFreedom) {
  const Scan target = kitchen_scan(-0.8, -0.3, 60, 1), source = kitchen_scan(0.3, 0.2, 100, 2);
  const Isometry3d truth = between(target, source);
  RegistrationOptions options;
  options.dof = 6;
  Isometry3d guess = truth * planar_motion(0.2, -0.2, 10);
  guess.rotate(Eigen::AngleAxisd(8 * kDegree, Vector3d::UnitX()));
  guess.translation().z() += 0.2;
  const PairAlignment pair = align(target, source, guess, options);
  EXPECT_TRUE(pair.trusted) << pair.reason;
  EXPECT_LT(position_error(pair.target_from_source, truth), 0.008);
  EXPECT_LT(angle_error_deg(pair.target_from_source, truth), 0.15);
}

TEST(Align, RefusesScansOfTwoDifferentRooms) {
  const Scan target = kitchen_scan(-0.3, -0.3, 60, 1);
  for (const double yaw_deg : {0.0, 60.0, 120.0, 200.0, 290.0}) {
    const Scan source = sweep(testing::study(), 0.2, 0, yaw_deg * kDegree, 7);
    const PairAlignment pair = align(target, source, between(target, source), {});
    EXPECT_FALSE(pair.trusted) << yaw_deg << ": " << pair.reason;
    EXPECT_FALSE(pair.reason.empty());
  }
}

TEST(Align, RefusesWhatCouldSlide) {
  testing::BoxRoom corridor;  // Two parallel walls, floor and ceiling, the ends out of sight.
  corridor.shell = {{-50, -1, 0}, {50, 1, 2.5}};
  const Scan target = sweep(corridor, 0, 0, 0, 1), source = sweep(corridor, 0.5, 0, 0, 2);
  const PairAlignment pair = align(target, source, between(target, source), {});
  EXPECT_FALSE(pair.trusted) << pair.reason;
  EXPECT_LT(pair.degeneracy, 0.001);
}

TEST(Align, RefusesAScanUpsideDown) {
  const Scan target = kitchen_scan(-0.8, -0.3, 60, 1);
  Scan source = kitchen_scan(-0.6, -0.2, 80, 2);
  const Isometry3d guess = between(target, source);
  for (ScanPoint& point : source.points)
    point.position = {point.position.x(), -point.position.y(), -point.position.z()};
  const PairAlignment pair = align(target, source, guess, {});
  EXPECT_FALSE(pair.trusted) << pair.reason;
}

TEST(Align, RefusesAnEmptyScan) {
  const Scan target = kitchen_scan(-0.8, -0.3, 60, 1);
  Scan empty;
  empty.name = "nothing";
  const PairAlignment pair = align(target, empty, Isometry3d::Identity(), {});
  EXPECT_FALSE(pair.trusted);
  EXPECT_THAT(pair.reason, HasSubstr("nothing has no points"));
}

ScanSet tour(double position_error_m, double yaw_error_deg) {
  ScanSet set;
  set.range_max = 10;
  Random random(5);
  const std::vector<std::array<double, 3>> stops = {
      {-1.2, 0.4, 20}, {-0.6, -0.4, 50}, {0.2, 0.3, 110}, {1.2, 0.2, 190}, {0.6, 0.5, 250}};
  for (const auto& [x, y, yaw] : stops) set.scans.push_back(kitchen_scan(x, y, yaw, set.scans.size() + 1));
  for (size_t i = 1; i < set.scans.size(); ++i)
    set.scans[i].map_from_scan = set.scans[i].map_from_scan * planar_motion(random.normal(position_error_m),
                                                                            random.normal(position_error_m),
                                                                            random.normal(yaw_error_deg));
  return set;
}

TEST(Align, OriginsFitAScanThatWasTakenThereOnly) {
  Scan scan = kitchen_scan(-0.8, -0.3, 0, 1);
  EXPECT_TRUE(origins_fit(scan));
  // Behind a wall: its points would hide all others.
  scan.origins[0] = (scan.map_from_scan.inverse() * Vector3d(4.5, 0, 1.25)).cast<float>();
  EXPECT_FALSE(origins_fit(scan));
  scan.origins.clear();
  EXPECT_FALSE(origins_fit(scan));
}

TEST(Registration, BringsATourToMillimetres) {
  const ScanSet truth = tour(0, 0), drifted = tour(0.1, 4);
  NoProgress progress;
  const RegistrationResult result = register_scans(drifted, {}, progress);
  ASSERT_EQ(result.connected_count(), truth.scans.size()) << result.summary();
  for (size_t i = 0; i < truth.scans.size(); ++i) {
    EXPECT_LT(position_error(result.map_from_scan[i], truth.scans[i].map_from_scan), 0.005) << i;
    EXPECT_LT(angle_error_deg(result.map_from_scan[i], truth.scans[i].map_from_scan), 0.1) << i;
  }
}

TEST(Registration, SameResultOnAnyNumberOfThreads) {
  const ScanSet set = tour(0.1, 4);
  NoProgress progress;
  RegistrationOptions one, many;
  one.threads = 1;
  many.threads = 3;
  Json a = register_scans(set, one, progress).report(), b = register_scans(set, many, progress).report();
  a.erase("seconds");
  b.erase("seconds");
  EXPECT_EQ(a.dump(), b.dump());
}

TEST(Registration, NamesTheScanOfAnotherRoomAndLeavesItBesideTheScanBefore) {
  ScanSet set = tour(0.05, 2);
  set.scans.push_back(sweep(testing::study(), 0.2, 0, 1.0, 9));
  NoProgress progress;
  const RegistrationResult result = register_scans(set, {}, progress);
  EXPECT_TRUE(result.usable());
  EXPECT_EQ(result.connected_count(), set.scans.size() - 1) << result.summary();
  EXPECT_FALSE(result.connected.back());
  EXPECT_THAT(result.summary(), HasSubstr("scan_9 has no trusted connection and is placed by odometry only"));
  const size_t last = set.scans.size() - 1;
  const Isometry3d driven = between(set.scans[last - 1], set.scans[last]);
  const Isometry3d found = result.map_from_scan[last - 1].inverse() * result.map_from_scan[last];
  EXPECT_LT(position_error(found, driven), 1e-4);
  EXPECT_LT(angle_error_deg(found, driven), 0.01);
}

/// A tour with a look out of a window, of which no surface comes back, as its third scan.
ScanSet tour_with_blind_scan(double position_error_m, double yaw_error_deg) {
  ScanSet set = tour(position_error_m, yaw_error_deg);
  for (ScanPoint& point : set.scans[2].points) point.returned = false;
  for (Scan& scan : set.scans) {
    scan.covariance.diagonal() << 0.0025, 0.0025, 0, 0, 0, 0.0012;
  }
  return set;
}

TEST(Registration, OdometryPlacesAScanThatSeesNothingBetweenItsNeighbours) {
  const ScanSet truth = tour(0, 0), drifted = tour_with_blind_scan(0.05, 2);
  NoProgress progress;
  IncrementalRegistration incremental{RegistrationOptions{}};
  for (const Scan& scan : drifted.scans) incremental.add(scan);
  for (const RegistrationResult& result : {register_scans(drifted, {}, progress), incremental.result()}) {
    ASSERT_EQ(result.connected, (std::vector<bool>{true, true, false, true, true})) << result.summary();
    EXPECT_LT(position_error(result.map_from_scan[2], truth.scans[2].map_from_scan), 0.2);
    EXPECT_LT(angle_error_deg(result.map_from_scan[2], truth.scans[2].map_from_scan), 6);
    EXPECT_EQ(result.report()["scans"][2]["placed_by"], "odometry");
    // It does not pull at those that are known well.
    EXPECT_LT(position_error(result.map_from_scan[4], truth.scans[4].map_from_scan), 0.005);
  }
}

TEST(Registration, ALaterScanPullsInWhatStoodByOdometryOnly) {
  ScanSet set;
  set.range_max = 10;
  // The second scan looks the other way and shares too little with the first; the third sees both.
  const std::vector<std::array<double, 3>> stops = {{-0.9, 0.2, 30}, {-0.9, 0.1, 170}, {-0.4, 0.0, 100}};
  for (const auto& [x, y, yaw] : stops) set.scans.push_back(kitchen_scan(x, y, yaw, set.scans.size() + 1));
  const ScanSet truth = set;
  for (size_t i = 1; i < set.scans.size(); ++i) {
    set.scans[i].map_from_scan = set.scans[i].map_from_scan * planar_motion(0.08, -0.06, 4);
    set.scans[i].covariance.diagonal() << 0.0036, 0.0036, 0, 0, 0, 0.002;
  }
  IncrementalRegistration incremental{RegistrationOptions{}};
  incremental.add(set.scans[0]);
  ASSERT_FALSE(incremental.add(set.scans[1]).connected[1]) << incremental.result().summary();
  EXPECT_LT(position_error(incremental.result().map_from_scan[1], set.scans[1].map_from_scan), 1e-6);
  const RegistrationResult& result = incremental.add(set.scans[2]);
  ASSERT_EQ(result.connected_count(), 3U) << result.summary();
  for (size_t i = 1; i < 3; ++i)
    EXPECT_LT(position_error(result.map_from_scan[i], truth.scans[i].map_from_scan), 0.005) << i;
}

TEST(Registration, TheLargestGroupWinsOverTheFirstScan) {
  // The first scan shows another room: what it has in common with nobody does not count.
  ScanSet set = tour(0.05, 2);
  Scan elsewhere = sweep(testing::study(), 0.2, 0, 1.0, 9);
  elsewhere.map_from_scan = set.scans.front().map_from_scan;
  set.scans.insert(set.scans.begin(), elsewhere);
  NoProgress progress;
  IncrementalRegistration incremental{RegistrationOptions{}};
  for (const Scan& scan : set.scans) incremental.add(scan);
  const std::vector<bool> expected = {false, true, true, true, true, true};
  EXPECT_EQ(register_scans(set, {}, progress).connected, expected);
  EXPECT_EQ(incremental.result().connected, expected) << incremental.result().summary();
}

TEST(Registration, AScanThatStartedTooFarOffIsConnectedWhenItIsTriedAgain) {
  ScanSet set = tour(0, 0);
  // The pose of the last scan is off by more than its covariance says.
  set.scans.back().map_from_scan = set.scans.back().map_from_scan * planar_motion(0.3, 0.2, 12);
  set.scans.back().covariance.diagonal() << 1e-4, 1e-4, 0, 0, 0, 1e-4;
  IncrementalRegistration incremental{RegistrationOptions{}};
  for (const Scan& scan : set.scans) incremental.add(scan);
  ASSERT_FALSE(incremental.result().connected.back()) << incremental.result().summary();
  const RegistrationResult& result = incremental.retry();
  ASSERT_TRUE(result.connected.back()) << result.summary();
  EXPECT_LT(position_error(result.map_from_scan.back(), tour(0, 0).scans.back().map_from_scan), 0.005);
}

TEST(Registration, DuplicatesOfOneScanStandInOnePlace) {
  ScanSet set;
  set.range_max = 10;
  for (const double off : {0.0, 0.1, -0.15}) {
    set.scans.push_back(kitchen_scan(-0.8, -0.3, 60, 1));
    set.scans.back().map_from_scan = set.scans.back().map_from_scan * planar_motion(off, off, 20 * off);
  }
  NoProgress progress;
  const RegistrationResult result = register_scans(set, {}, progress);
  ASSERT_EQ(result.connected_count(), set.scans.size()) << result.summary();
  for (const Isometry3d& pose : result.map_from_scan) {
    EXPECT_LT(position_error(pose, result.map_from_scan[0]), 1e-3);
    EXPECT_LT(angle_error_deg(pose, result.map_from_scan[0]), 0.05);
  }
}

TEST(Registration, OneByOneIsAsGoodAsAllAtOnce) {
  const ScanSet truth = tour(0, 0), drifted = tour(0.05, 2);
  IncrementalRegistration incremental{RegistrationOptions{}};
  for (const Scan& scan : drifted.scans) incremental.add(scan);
  const RegistrationResult& result = incremental.result();
  ASSERT_EQ(result.connected_count(), truth.scans.size()) << result.summary();
  for (size_t i = 0; i < truth.scans.size(); ++i)
    EXPECT_LT(position_error(result.map_from_scan[i], truth.scans[i].map_from_scan), 0.005) << i;
}

TEST(Registration, RejectsFiveDegreesOfFreedom) {
  NoProgress progress;
  RegistrationOptions options;
  options.dof = 5;
  EXPECT_THROW(register_scans(tour(0, 0), options, progress), Error);
}

TEST(FreeSpace, RaysAlongASurfaceDoNotPassIt) {
  Scan scan;
  scan.origins = {Eigen::Vector3f::Zero()};
  for (float y = -0.2F; y < 0.2F; y += 0.01F)
    for (float z = -0.2F; z < 0.2F; z += 0.01F) {
      scan.points.emplace_back();
      scan.points.back().position = 3 * Eigen::Vector3f(1, y, z).normalized();
    }
  const registration::FreeSpace space(scan, Isometry3d::Identity());
  const Eigen::Vector3f point(2.8F, 0, 0), facing(-1, 0, 0),
      along = Eigen::Vector3f(-0.1F, 1, 0).normalized();
  EXPECT_TRUE(space.passed(point, 0.05F));
  EXPECT_TRUE(space.passed(point, facing, 0.05F));
  EXPECT_FALSE(space.passed(point, along, 0.05F));
}

TEST(FreeSpace, FusedPointsStopTheRaysOfAllOrigins) {
  Scan scan;
  scan.origins = {Eigen::Vector3f::Zero(), Eigen::Vector3f(0, 0.02F, 0)};
  const auto add = [&](const Eigen::Vector3f& position, uint16_t origin) {
    scan.points.emplace_back();
    scan.points.back().position = position;
    scan.points.back().origin_index = origin;
  };
  for (float y = -0.4F; y < 0.4F; y += 0.01F)
    for (float z = -0.4F; z < 0.4F; z += 0.01F) add({3, y, z}, 1);
  for (float z = -0.4F; z < 0.4F; z += 0.01F) add({2, 0, z}, 0);  // A pole, which fusion gave to one of them.
  const registration::FreeSpace space(scan, Isometry3d::Identity());
  EXPECT_FALSE(space.passed({2, 0, 0}, 0.05F));
  EXPECT_TRUE(space.passed({2, 0.2F, 0}, 0.05F));
}

}  // namespace
}  // namespace loci::mapping
