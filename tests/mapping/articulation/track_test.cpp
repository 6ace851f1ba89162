#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>

#include "mapping/articulation/articulation.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Recorded {
  double noise = 0.002;
  double outliers = 0;
  int poses = 80;
  bool oriented = false;
  double turn_noise = 0.02;
};

/// A track whose pose at u in [0, 1] is given, recorded with noise; outliers are anywhere within 30 cm.
Track record(const std::function<Isometry3d(double)>& pose_at, const Recorded& how, uint64_t seed = 1) {
  Random random(seed);
  const auto normal = [&](double sigma) {
    return Vector3d(random.normal(sigma), random.normal(sigma), random.normal(sigma));
  };
  Track track;
  for (int i = 0; i < how.poses; ++i) {
    const Isometry3d pose = pose_at(static_cast<double>(i) / (how.poses - 1));
    Vector3d position = pose.translation() + normal(how.noise);
    if (random.uniform() < how.outliers)
      position += 0.3 * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    track.positions.push_back(position);
    if (!how.oriented) continue;
    const Vector3d off = normal(how.turn_noise);
    track.orientations.emplace_back(Eigen::AngleAxisd(off.norm(), off.normalized()) * pose.linear());
  }
  return track;
}

const Vector3d kAxis = Vector3d(0.2, -0.3, 0.9).normalized();
const Vector3d kHingePoint(0.5, -1.0, 2.0);

std::function<Isometry3d(double)> door(double radius, double arc_deg) {
  return [=](double u) {
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(u * arc_deg * kPi / 180, kAxis).toRotationMatrix();
    pose.translation() = kHingePoint + pose.linear() * (radius * kAxis.unitOrthogonal());
    return pose;
  };
}

std::function<Isometry3d(double)> drawer(double travel) {
  return [=](double u) { return Isometry3d(Eigen::Translation3d(kHingePoint + u * travel * kAxis)); };
}

double probability(const TrackResult& result, ArticulationType type) {
  return result.estimate.probabilities[static_cast<size_t>(type)] * (1 - result.unknown_probability);
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180 / kPi;
}

TEST(Track, ArcGivesAxisHingeRadiusAndOpening) {
  for (const bool oriented : {false, true}) {
    const TrackResult result = fit_track(record(door(0.4, 80), {.oriented = oriented}), {});
    ASSERT_EQ(result.type_name(), "revolute");
    EXPECT_GT(probability(result, ArticulationType::revolute), 0.9);
    EXPECT_LT(angle_deg(result.estimate.axis, kAxis), 1);  // sense included: it opens by the right hand
    EXPECT_LT((result.estimate.origin - kHingePoint).cross(kAxis).norm(), 0.01);
    EXPECT_NEAR(result.fits[2].radius, 0.4, 0.01);
    EXPECT_NEAR(result.estimate.upper, 80 * kPi / 180, 0.04);
    EXPECT_NEAR(result.estimate.lower, 0, 0.02);
  }
}

TEST(Track, StraightPathGivesAxisAndTravel) {
  for (const bool oriented : {false, true}) {
    const TrackResult result = fit_track(record(drawer(0.4), {.oriented = oriented}), {});
    ASSERT_EQ(result.type_name(), "prismatic");
    EXPECT_GT(probability(result, ArticulationType::prismatic), 0.9);
    EXPECT_LT(angle_deg(result.estimate.axis, kAxis), 0.5);
    EXPECT_NEAR(result.estimate.upper - result.estimate.lower, 0.4, 0.01);
  }
}

TEST(Track, WhatIsHeldStillIsRigidAtAnyNoise) {
  for (const double noise : {0.0, 0.0005, 0.003, 0.02})
    for (const int poses : {15, 50, 200}) {
      const TrackResult result = fit_track(record(drawer(0), {.noise = noise, .poses = poses}), {});
      EXPECT_EQ(result.type_name(), "rigid") << noise << ", " << poses << " poses";
    }
}

TEST(Track, TypeIsRightDespiteAQuarterOfOutliers) {
  for (uint64_t seed = 1; seed <= 4; ++seed)
    for (const double noise : {0.0005, 0.003}) {
      const Recorded how{.noise = noise, .outliers = 0.25, .poses = 100};
      const TrackResult turned = fit_track(record(door(0.4, 70), how, seed), {});
      EXPECT_EQ(turned.type_name(), "revolute");
      EXPECT_LT(angle_deg(turned.estimate.axis, kAxis), 2);
      EXPECT_EQ(fit_track(record(drawer(0.4), how, seed), {}).type_name(), "prismatic");
      EXPECT_EQ(fit_track(record(drawer(0), how, seed), {}).type_name(), "rigid");
    }
}

TEST(Track, NeitherLineNorCircleIsSaidToBeUnknown) {
  const auto corner = [](double u) {
    const Vector3d p = u < 0.5 ? Vector3d(u, 0, 0) : Vector3d(0.5, u - 0.5, 0);
    return Isometry3d(Eigen::Translation3d(p));
  };
  const auto wave = [](double u) {
    return Isometry3d(Eigen::Translation3d(0.6 * u, 0.06 * std::sin(4 * kPi * u), 0.0));
  };
  for (const auto& path :
       {std::function<Isometry3d(double)>(corner), std::function<Isometry3d(double)>(wave)})
    for (const double noise : {0.001, 0.005}) {
      const TrackResult result = fit_track(record(path, {.noise = noise}), {});
      EXPECT_FALSE(result.usable);
      EXPECT_EQ(result.type_name(), "unknown");
      EXPECT_EQ(result.reason, "neither line nor circle fits");
      const Json report = result.report();
      EXPECT_TRUE(report["axis"].is_null());
      for (const char* type : {"rigid", "prismatic", "revolute"})
        EXPECT_LT(report["probabilities"][type].get<double>(), 0.3);
    }
}

TEST(Track, ShortArcsAreLeftOpenAndLongOnesAreSure) {
  const auto mean_probability = [](double arc_deg) {
    double mean = 0;
    for (uint64_t seed = 1; seed <= 8; ++seed)
      mean +=
          probability(fit_track(record(door(0.5, arc_deg), {}, seed), {}), ArticulationType::revolute) / 8;
    return mean;
  };
  for (const double arc : {2.0, 4.0, 6.0}) {
    EXPECT_GT(mean_probability(arc), 0.1) << arc;
    EXPECT_LT(mean_probability(arc), 0.75) << arc;
  }
  for (const double arc : {25.0, 60.0}) EXPECT_GT(mean_probability(arc), 0.9) << arc;
}

TEST(Track, OrientationTellsAShortArcFromALine) {
  const Recorded with{.noise = 0.003, .oriented = true};
  for (uint64_t seed = 1; seed <= 4; ++seed)
    EXPECT_EQ(fit_track(record(door(0.5, 16), with, seed), {}).type_name(), "revolute");
}

TEST(Track, UncertaintyCoversTheError) {
  int within = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    const TrackResult result = fit_track(record(door(0.4, 40), {.noise = 0.004}, seed), {});
    ASSERT_EQ(result.type_name(), "revolute");
    within += angle_deg(result.estimate.axis, kAxis) < 2 * result.estimate.axis_sd_deg;
  }
  EXPECT_GE(within, 30);
}

TEST(Track, GivenNoiseIsUsed) {
  const Track track = record(door(0.5, 10), {.noise = 0.001});
  const TrackResult fine = fit_track(track, {}), coarse = fit_track(track, {.position_sigma_m = 0.02});
  EXPECT_NEAR(coarse.sigma_m, 0.02, 1e-12);
  EXPECT_LT(probability(coarse, ArticulationType::revolute), probability(fine, ArticulationType::revolute));
}

TEST(Track, OptionsOutOfBoundsAreRefused) {
  EXPECT_THROW(fit_track(record(door(0.5, 10), {}), {.outlier_probability = 2}), Error);
}

TEST(Track, ProbabilitiesOfTheReportSumToOne) {
  for (const double arc : {0.0, 5.0, 60.0}) {
    double sum = 0;
    const Json report = fit_track(record(door(0.4, arc), {}), {}).report();
    for (const auto& [type, p] : report["probabilities"].items()) sum += p.get<double>();
    EXPECT_NEAR(sum, 1, 1e-9);
  }
}

class TrackFile : public testing::Test {
 protected:
  std::string error_of(const std::string& text) {
    const fs::path file = fs::path(testing::TempDir()) / "loci_track.csv";
    write_file_atomically(file, text);
    try {
      fit_track(read_track(file), {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(TrackFile, BadInputIsRefusedWithItsPlace) {
  EXPECT_THAT(error_of("index,x,y,z\n0,1,2,3\n"), HasSubstr("1 poses"));
  EXPECT_THAT(error_of("index,x,y,z\n"), HasSubstr("0 poses"));
  EXPECT_THAT(error_of("x,y\n1,2\n"), HasSubstr("z"));
  EXPECT_THAT(error_of("x,y,z\n0,0,0\n0,nan,0\n0,0,0\n"), HasSubstr(":3"));
  EXPECT_THAT(error_of("x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n0,0,0,1,0,0,1\n"), HasSubstr("unit length"));
  EXPECT_THAT(error_of("x,y,z,qx,qy,qz\n0,0,0,0,0,0\n"), HasSubstr("qw"));
}

TEST_F(TrackFile, EqualPosesAreRigidAndFewPosesAreAnswered) {
  EXPECT_EQ(error_of("x,y,z\n1,1,1\n1,1,1\n1,1,1\n1,1,1\n"), "");
  EXPECT_EQ(error_of("x,y,z\n0,0,0\n1,0,0\n2,0,0\n"), "");
  EXPECT_EQ(fit_track({{Vector3d::Ones(), Vector3d::Ones(), Vector3d::Ones()}, {}}, {}).type_name(), "rigid");
}

TEST(Track, EveryHighConfidenceTrackOfTheSharedDataIsRight) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/articulation_tracks";
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const CsvTable index = CsvTable::read(folder / "index.csv");
  size_t high = 0;
  for (size_t row = 0; row < index.rows(); ++row) {
    if (index.cell(row, index.require_column("confidence")) != "high") continue;
    const std::string file = index.cell(row, index.require_column("file"));
    const std::string truth = index.cell(row, index.require_column("joint_type"));
    EXPECT_EQ(fit_track(read_track(folder / file), {}).type_name(),
              truth == "rotational" ? "revolute" : truth)
        << file;
    ++high;
  }
  EXPECT_GT(high, 80u);
}

}  // namespace
}  // namespace loci::mapping
