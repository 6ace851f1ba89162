#include "apps/evaluate/registration/pairs.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"

namespace loci::apps::registration_evaluation {
namespace {

namespace fs = std::filesystem;

/// A folder with two clouds: two corners of walls, the second 0.1 m along x.
fs::path two_clouds() {
  const fs::path folder = fs::path(::testing::TempDir()) / "listed_pairs";
  fs::create_directories(folder);
  for (const char* name : {"a.pcd", "b.pcd"}) {
    const double shift = name[0] == 'b' ? -0.1 : 0;
    std::string points;
    for (int i = 0; i < 20; ++i) points += std::to_string(0.1 * i + shift) + " 1 0.5\n";
    write_file_atomically(folder / name,
                          "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 20\n"
                          "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 20\nDATA ascii\n" +
                              points);
  }
  return folder;
}

TEST(ListedPairs, AreReadWithTheirPoses) {
  const fs::path folder = two_clouds();
  write_file_atomically(folder / "pairs.csv",
                        "target,source,x_m,y_m,z_m,rx_deg,ry_deg,rz_deg\na.pcd,b.pcd,0.1,0,0,0,0,0\n");
  const PairSet set = listed_pairs(folder / "pairs.csv", folder);
  ASSERT_EQ(set.pairs.size(), 1U);
  EXPECT_DOUBLE_EQ(set.pairs[0].target_from_source.translation().x(), 0.1);
  EXPECT_GT(set.pairs[0].overlap, 0.5);
}

TEST(ListedPairs, NameTheFileThatIsMissing) {
  const fs::path folder = two_clouds();
  write_file_atomically(folder / "bad.csv",
                        "target,source,x_m,y_m,z_m,rx_deg,ry_deg,rz_deg\na.pcd,none.pcd,0,0,0,0,0,0\n");
  try {
    listed_pairs(folder / "bad.csv", folder);
    FAIL() << "a cloud that is not there was read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("none.pcd"), std::string::npos) << error.what();
  }
}

TEST(Perturbed, StaysWithinItsBounds) {
  const Random seed(3);
  for (size_t i = 0; i < 50; ++i) {
    Random random = seed.fork(i);
    const Isometry3d off = perturbed(Isometry3d::Identity(), 0.5, 30, true, random);
    EXPECT_LE(off.translation().norm(), 0.5 + 1e-9);
    EXPECT_NEAR(off.translation().z(), 0, 1e-12);
    EXPECT_NEAR(off.linear()(2, 2), 1, 1e-12);
  }
}

}  // namespace
}  // namespace loci::apps::registration_evaluation
