#include "mapping/sensor/scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "mapping/base/files.h"
#include "mapping/sensor/pcd.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

ScanSet small_set() {
  ScanSet set;
  set.sensor = "kinect";
  set.range_max = 4;
  set.resolution = 0.01;
  Scan scan;
  scan.name = "scan_000";
  scan.map_from_scan.translation() << 1, 2, 0.5;
  scan.covariance(0, 5) = 0.25;
  scan.origins = {{0, 0, 0}, {0.5F, 0, 0.125F}};
  for (int i = 0; i < 100; ++i) {
    ScanPoint point;
    point.position = {0.1F * static_cast<float>(i), -1.5F, 2.25F};
    point.intensity = 0.5F;
    point.r = static_cast<uint8_t>(i);
    point.b = 255;
    point.origin_index = static_cast<uint16_t>(i % 2);
    point.returned = i % 10 != 0;
    scan.points.push_back(point);
  }
  set.scans = {scan, scan};
  set.scans[1].name = "scan_001";
  return set;
}

class ScanSetFiles : public testing::Test {
 protected:
  ScanSetFiles() { make_folder(folder_); }
  ~ScanSetFiles() override { fs::remove_all(folder_); }

  std::string message_of(const std::function<void()>& call) {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_ = fs::path(testing::TempDir()) /
                     (std::string("scan_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ScanSetFiles, ComeBackEqual) {
  const ScanSet set = small_set();
  write_scan_set(set, folder_);
  const ScanSet back = read_scan_set(folder_);
  ASSERT_EQ(back.scans.size(), 2U);
  EXPECT_EQ(back.sensor, "kinect");
  EXPECT_EQ(back.range_max, 4);
  EXPECT_EQ(back.resolution, 0.01);
  EXPECT_TRUE(back.free_space);
  const Scan& scan = back.scans[0];
  EXPECT_EQ(scan.name, "scan_000");
  EXPECT_TRUE(scan.map_from_scan.isApprox(set.scans[0].map_from_scan, 0));
  EXPECT_EQ(scan.covariance, set.scans[0].covariance);
  EXPECT_EQ(scan.origins, set.scans[0].origins);
  ASSERT_EQ(scan.points.size(), 100U);
  for (size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(scan.points[i].position, set.scans[0].points[i].position);
    EXPECT_EQ(scan.points[i].r, i);
    EXPECT_EQ(scan.points[i].b, 255);
    EXPECT_EQ(scan.points[i].origin_index, i % 2);
    EXPECT_EQ(scan.points[i].returned, i % 10 != 0);
  }
}

TEST_F(ScanSetFiles, BareCloudHasNoFreeSpace) {
  write_scan_set(small_set(), folder_);
  const ScanSet set = read_scan_set(folder_ / "scan_001.pcd");
  EXPECT_FALSE(set.free_space);
  ASSERT_EQ(set.scans.size(), 1U);
  EXPECT_EQ(set.scans[0].points.size(), 100U);
}

TEST_F(ScanSetFiles, WithoutOriginsThereIsNoFreeSpace) {
  ScanSet set = small_set();
  set.scans[1].origins.clear();
  write_scan_set(set, folder_);
  const ScanSet read = read_scan_set(folder_);
  EXPECT_FALSE(read.free_space);
  EXPECT_TRUE(read.scans[1].origins.empty());
}

TEST_F(ScanSetFiles, TruncatedAndMalformedPcdIsRefused) {
  write_scan_set(small_set(), folder_);
  const std::string whole = read_file(folder_ / "scan_000.pcd");
  write_file_atomically(folder_ / "scan_000.pcd", whole.substr(0, whole.size() - 1));
  EXPECT_THAT(message_of([&] { read_scan_set(folder_); }),
              HasSubstr("scan_000.pcd: the PCD file is truncated"));
  write_file_atomically(folder_ / "scan_000.pcd", whole.substr(0, 60));
  EXPECT_THAT(message_of([&] { read_scan_set(folder_); }), HasSubstr("not a PCD file"));
  fs::remove(folder_ / "scan_000.pcd");
  EXPECT_THAT(message_of([&] { read_scan_set(folder_); }), HasSubstr("scan_000.pcd: no such file"));
  EXPECT_THAT(message_of([&] { read_scan_set(folder_ / "nowhere"); }), HasSubstr("no such scan set"));
}

TEST_F(ScanSetFiles, UnknownKeyIsNamedWithTheNearest) {
  write_scan_set(small_set(), folder_);
  write_file_atomically(folder_ / "scans.yaml", "sensr: kinect\nscans: []\n");
  EXPECT_THAT(message_of([&] { read_scan_set(folder_); }),
              HasSubstr("unknown key 'sensr'; did you mean 'sensor'?"));
}

TEST_F(ScanSetFiles, AsciiPcdIsRead) {
  write_file_atomically(folder_ / "a.pcd",
                        "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\n"
                        "HEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3 16711680\nnan nan nan 0\n");
  const ScanSet set = read_scan_set(folder_ / "a.pcd");
  ASSERT_EQ(set.scans[0].points.size(), 1U);
  EXPECT_EQ(set.scans[0].points[0].position, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(set.scans[0].points[0].r, 255);
}

TEST(Pcd, OtherPeoplesFilesAreRead) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/pcl_scans";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data";
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".pcd") continue;
    const PcdCloud cloud = read_pcd(entry.path());
    EXPECT_GT(cloud.size(), 1000U) << entry.path();
    EXPECT_NE(cloud.find("x"), nullptr) << entry.path();
    const ScanSet set = read_scan_set(entry.path());
    double largest = 0;
    for (const ScanPoint& point : set.scans[0].points)
      largest = std::max(largest, static_cast<double>(point.position.norm()));
    EXPECT_GT(largest, 0.1) << entry.path();
    EXPECT_LT(largest, 100) << entry.path();
  }
}

TEST_F(ScanSetFiles, ScansThatCouldNotBeRegisteredAreLeftOutOfMaps) {
  ScanSet set;
  for (const char* scan : {"a", "b", "c"}) {
    set.scans.emplace_back().name = scan;
    set.scans.back().origins.emplace_back(0.F, 0.F, 0.F);
    set.scans.back().points.emplace_back();
  }
  set.scans[1].registered = false;
  write_scan_set(set, folder_);
  EXPECT_EQ(read_scan_set(folder_).scans.size(), 3U);
  Warnings warnings;
  const ScanSet registered = read_registered_scans(folder_, warnings);
  ASSERT_EQ(registered.scans.size(), 2U);
  EXPECT_EQ(registered.scans[1].name, "c");
  ASSERT_EQ(warnings.texts().size(), 1U);
  for (Scan& scan : set.scans) scan.registered = false;
  write_scan_set(set, folder_);
  EXPECT_THAT(message_of([&] { read_registered_scans(folder_, warnings); }), HasSubstr("register"));
}

}  // namespace
}  // namespace loci::mapping
