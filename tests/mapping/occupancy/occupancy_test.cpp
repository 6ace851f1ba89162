#include "mapping/occupancy/occupancy.h"
#include "mapping/base/temporary_folder.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <filesystem>

#include "mapping/base/error.h"
#include "tests/mapping/occupancy/box_room.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

OccupancyOptions options(int threads, double resolution = 0.05, double range = 5) {
  OccupancyOptions result;
  result.threads = threads;
  result.resolution_m = resolution;
  result.range_max_m = range;
  return result;
}

Isometry3d scanner_at(double x, double y, double yaw) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(x, y, 1.25);
  pose.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// OctoMap's own insertion of the same rays.
void insert_by_octomap(octomap::OcTree& tree, const Scan& scan, double range) {
  octomap::Pointcloud cloud;
  for (const ScanPoint& point : scan.points) {
    const Eigen::Vector3f p = (scan.map_from_scan * point.position.cast<double>()).cast<float>();
    cloud.push_back(p.x(), p.y(), p.z());
  }
  const Eigen::Vector3f o = (scan.map_from_scan * scan.origins[0].cast<double>()).cast<float>();
  tree.insertPointCloud(cloud, octomap::point3d(o.x(), o.y(), o.z()), range);
}

std::vector<Scan> sweeps(int azimuths = 120, int tilts = 60) {
  BoxRoom room = BoxRoom::kitchen();
  room.room = {Vector3d(-5, -4, 0), Vector3d(6, 4, 2.6)};  // Larger than the range: some rays end nowhere.
  std::vector<Scan> scans;
  for (int i = 0; i < 4; ++i)
    scans.push_back(room.sweep(scanner_at(0.3 * i, 0.1 - 0.4 * i, 0.3 + i), azimuths, tilts, 10, 0.01,
                               static_cast<uint64_t>(i)));
  for (int i = 0; i < 4; ++i) scans.push_back(scans[0]);  // Until values stand at their limits.
  return scans;
}

TEST(OccupancyMap, TreeIsOctoMapsOwnNodeForNodeOnAnyNumberOfThreads) {
  const std::vector<Scan> scans = sweeps();
  for (const double resolution : {0.07, 0.13}) {
    octomap::OcTree peer(resolution);
    OccupancyMap one(options(1, resolution)), two(options(2, resolution)), seven(options(7, resolution));
    for (const Scan& scan : scans) {
      insert_by_octomap(peer, scan, 5);
      for (OccupancyMap* map : {&one, &two, &seven}) map->insert(scan);
      ASSERT_EQ(two.tree().size(), peer.size());
    }
    for (const OccupancyMap* map : {&one, &two, &seven}) {
      EXPECT_TRUE(map->tree() == peer);  // Structure, keys, values and number of nodes.
      EXPECT_EQ(map->tree().calcNumNodes(), peer.size());
    }
    EXPECT_GT(peer.getNumLeafNodes(), 5000U);
  }
}

TEST(OccupancyMap, RaysAlongAxesAndThroughEdgesAreOctoMapsToo) {
  Scan scan;
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  Random random(5);
  for (int i = 0; i < 4000; ++i) {
    ScanPoint point;  // Multiples of a quarter of a voxel: many rays touch edges and corners.
    for (int k = 0; k < 3; ++k)
      point.position[k] = 0.0125F * static_cast<float>(static_cast<int>(random.index(321)) - 160);
    if (i % 5 == 0) point.position[i / 5 % 3] = 0;
    if (i % 7 == 0) point.position[i / 7 % 3] = 0;
    scan.points.push_back(point);
  }
  octomap::OcTree peer(0.05);
  insert_by_octomap(peer, scan, 1.5);
  OccupancyMap map(options(2, 0.05, 1.5));
  map.insert(scan);
  EXPECT_TRUE(map.tree() == peer);
}

TEST(OccupancyMap, RealRoomGivesOctoMapsTree) {
  const fs::path path = fs::path(LOCI_SHARED_DIR) / "data/pcl_scans/room_scan1.pcd";
  if (!fs::exists(path)) GTEST_SKIP() << "no shared data";
  const Scan scan = read_scan_set(path).scans[0];
  octomap::OcTree peer(0.05);
  insert_by_octomap(peer, scan, 5);
  OccupancyMap map(options(2));
  map.insert(scan);
  EXPECT_TRUE(map.tree() == peer);
}

TEST(OccupancyMap, RayWithoutReturnIsFreeUpToRangeAndOccupiesNothing) {
  Scan scan;
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  ScanPoint point;
  point.returned = false;
  point.position = {10, 0.01F, 0.01F};  // Beyond the range.
  scan.points.push_back(point);
  point.position = {0.01F, 2, 0.01F};  // The sensor's range ends before the map's.
  scan.points.push_back(point);
  OccupancyMap map(options(1));
  map.insert(scan);
  EXPECT_EQ(map.at({4.9, 0.01, 0.01}), Occupancy::free);
  EXPECT_EQ(map.at({5.1, 0.01, 0.01}), Occupancy::unknown);
  EXPECT_EQ(map.at({0.01, 1.9, 0.01}), Occupancy::free);
  EXPECT_EQ(map.at({0.01, 2.1, 0.01}), Occupancy::unknown);
  for (const Occupancy state : map.voxels().states) EXPECT_NE(state, Occupancy::occupied);
}

TEST(OccupancyMap, RaysOfAllOriginsAreOneMeasurementInWhichHitsWin) {
  Scan scan;
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  scan.origins.emplace_back(0.F, 1.F, 0.F);
  const auto ray = [&](uint16_t origin, float x, float y) {
    ScanPoint point;
    point.origin_index = origin;
    point.position = {x, y, 0.F};
    scan.points.push_back(point);
  };
  ray(0, 2.02F, 0.02F);
  ray(1, 2.02F, 0.02F);
  ray(1, 4.04F, -0.96F);  // Passes through the voxel that the others end in.
  OccupancyMap map(options(2));
  map.insert(scan);
  const octomap::OcTree& tree = map.tree();
  EXPECT_FLOAT_EQ(tree.search(2.02, 0.02, 0.0)->getLogOdds(), tree.getProbHitLog());
}

TEST(OccupancyMap, LeavesOutWhatIsNotFiniteOrOutsideTheTree) {
  Scan scan;
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  OccupancyMap map(options(2));
  map.insert(scan);  // Empty.
  EXPECT_EQ(map.tree().size(), 0U);
  EXPECT_TRUE(map.voxels().states.empty());
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    ScanPoint point;
    point.position = {1, bad, 0};
    scan.points.push_back(point);
  }
  map.insert(scan);
  EXPECT_EQ(map.tree().size(), 0U);
  scan.map_from_scan.translation().x() = 1e6;  // Beyond OctoMap's keys.
  scan.points.resize(1);
  scan.points[0].position = {1, 0, 0};
  map.insert(scan);
  EXPECT_EQ(map.tree().size(), 0U);
}

TEST(OccupancyMap, RefusesAScanThatSpansTooManyVoxels) {
  Scan scan = BoxRoom::kitchen().sweep(scanner_at(0, 0, 0), 8, 4, 10, 0, 1);
  scan.map_from_scan.translation().setZero();
  scan.origins = {{0, 0, 0}, {60, 60, 60}};
  ScanPoint far;
  far.origin_index = 1;
  far.position = {60, 60, 59};
  scan.points.push_back(far);
  OccupancyMap map(options(2, 0.01));
  EXPECT_THROW(map.insert(scan), Error);
}

TEST(OccupancyMap, VoxelsThatWereHitOnceAndPassedThroughLaterAreDoubtful) {
  Scan scan;  // A false point before a wall, in the first scan only.
  scan.origins.emplace_back(0.025F, 0.025F, 0.025F);
  ScanPoint wall, stray;
  wall.position = {1.525F, 0.025F, 0.025F};
  stray.position = {0.925F, 0.025F, 0.025F};
  OccupancyMap map(options(2));
  scan.points = {wall, stray};
  map.insert(scan);
  EXPECT_TRUE(map.voxels().doubtful.empty());
  scan.points = {wall};
  map.insert(scan);
  const Voxels voxels = map.voxels();
  const size_t voxel = voxels.index(voxels.voxel_of(stray.position.cast<double>()));
  EXPECT_EQ(voxels.states[voxel], Occupancy::occupied);
  EXPECT_EQ(voxels.doubtful, std::vector<size_t>{voxel});
}

TEST(OccupancyMap, VoxelsAndFileSayWhatTheTreeSays) {
  OccupancyMap map(options(2));
  map.insert(sweeps()[0]);
  const Voxels voxels = map.voxels();
  size_t counts[3] = {};
  for (int z = 0; z < voxels.size.z(); ++z)
    for (int y = 0; y < voxels.size.y(); ++y)
      for (int x = 0; x < voxels.size.x(); ++x) {
        const Eigen::Vector3i voxel(x, y, z);
        const Occupancy state = voxels.at(voxel);
        ASSERT_EQ(state, map.at(voxels.center(voxel)));
        ++counts[static_cast<size_t>(state)];
      }
  for (const size_t count : counts) EXPECT_GT(count, 100U);
  EXPECT_EQ(voxels.at({-1, 0, 0}), Occupancy::unknown);

  const TemporaryFolder folder("loci_test");
  const fs::path path = folder.path() / "map.bt";
  map.write_bt(path);
  octomap::OcTree read(0.05);
  ASSERT_TRUE(read.readBinary(path.string()));
  for (auto leaf = map.tree().begin_leafs(); leaf != map.tree().end_leafs(); ++leaf) {
    const octomap::OcTreeNode* node = read.search(leaf.getCoordinate());
    ASSERT_NE(node, nullptr);
    ASSERT_EQ(read.isNodeOccupied(node), map.tree().isNodeOccupied(*leaf));
  }
}

}  // namespace
}  // namespace loci::mapping
