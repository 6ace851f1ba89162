#include <gtest/gtest.h>

#include <cmath>

#include "apps/evaluate/normals/comparison.h"
#include "apps/evaluate/normals/peers.h"
#include "apps/evaluate/normals/surfaces.h"
#include "mapping/base/math/math.h"

namespace loci::apps::normals_evaluation {
namespace {

const mapping::PinholeCamera kCamera{320, 240, 290, 290, 160, 120};

/// Angle between the truth at a pixel and the plane through it and its neighbours.
double angle_to_neighbours(const Surfaces& surfaces, int u, int v) {
  const auto point = [&](int x, int y) {
    return kCamera.unproject(x, y, static_cast<double>(surfaces.depth.at<float>(y, x)));
  };
  const Vector3d across = point(u + 1, v) - point(u - 1, v), down = point(u, v + 1) - point(u, v - 1);
  const cv::Vec3f& t = surfaces.truth.at<cv::Vec3f>(v, u);
  const Vector3d truth(static_cast<double>(t[0]), static_cast<double>(t[1]), static_cast<double>(t[2]));
  return std::acos(std::min(1.0, std::abs(across.cross(down).normalized().dot(truth)))) / kDegree;
}

TEST(PlanarPatches, HaveTheNormalsThatTheyClaim) {
  DisparityNoise fine;
  fine.quantum_px = 1e-6;
  Random random(3);
  const Surfaces surfaces = planar_patches(kCamera, fine, random);
  int right = 0, all = 0;
  for (int v = 1; v < 239; v += 7)
    for (int u = 1; u < 319; u += 7) {
      const double angle = angle_to_neighbours(surfaces, u, v);
      if (std::isnan(angle)) continue;
      ++all;
      right += angle < 0.5 ? 1 : 0;
    }
  EXPECT_GT(all, 800);
  EXPECT_GT(right, 0.9 * all);  // the others are at edges
}

TEST(FlatAreas, FindThePlanesOfPatchesAndNothingAcrossEdges) {
  Random random(4);
  const DisparityNoise noise{0.075, 0.125, 1.0 / 16};
  const Surfaces surfaces = planar_patches(kCamera, noise, random);
  const Surfaces flat = flat_areas(surfaces.depth, kCamera, noise);
  MethodErrors errors;
  errors.add(flat.truth, surfaces.truth, {});
  EXPECT_GT(errors.normals, 10000U);
  EXPECT_GT(errors.to_truth.within(1.5), 0.95);
}

TEST(Peers, AgreeWithAPlaneWithoutNoise) {
  // A metre away: PCL's linear least squares are right there only, it multiplies one coordinate by the depth.
  const Vector3d normal = Vector3d(0.2, 0.1, -1).normalized();
  Surfaces surfaces{cv::Mat(240, 320, CV_32F), cv::Mat(240, 320, CV_32FC3)};
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) {
      surfaces.depth.at<float>(v, u) =
          static_cast<float>(normal.z() / normal.dot(kCamera.unproject(u, v, 1)));
      surfaces.truth.at<cv::Vec3f>(v, u) = {float(normal.x()), float(normal.y()), float(normal.z())};
    }
  for (const auto& method : {pcl_normal_estimation(), pcl_integral_image(), pcl_linear_least_squares()}) {
    const Estimate found = method->estimate(surfaces.depth, kCamera);
    MethodErrors errors;
    errors.add(found.normals, surfaces.truth, {});
    EXPECT_GT(errors.to_truth.within(3.5), 0.9);
    EXPECT_GT(errors.density(), 0.8);
    EXPECT_GT(found.seconds, 0);
  }
}

TEST(ErrorHistogram, CountsSharesAndMedian) {
  ErrorHistogram histogram;
  for (int i = 0; i < 100; ++i) histogram.add(0.1 * i + 0.05);
  EXPECT_NEAR(histogram.within(1.5), 0.15, 1e-12);
  EXPECT_NEAR(histogram.median(), 5, 0.11);
}

TEST(NormalsComparison, MeetsTheAimsOfTheSection) {
  ComparisonOptions options;
  options.frames = 4;
  options.peers = false;
  NoProgress progress;
  const Comparison comparison = compare({}, options, {}, progress);
  const SetResult& quiet = comparison.sets.front();
  EXPECT_GT(quiet.find(kBefore)->to_truth.within(3.5), 0.85);
  EXPECT_GT(quiet.find(kAfter)->to_truth.within(1.5), 0.85);
}

}  // namespace
}  // namespace loci::apps::normals_evaluation
