#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "perception/annotators/structure/normals.h"

namespace loci::perception {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const mapping::PinholeCamera kKinect{320, 240, 580, 580, 160, 120};

Vector3d leaning(double inclination_deg, double azimuth_deg) {
  const double sine = std::sin(inclination_deg * kDegree);
  return {sine * std::cos(azimuth_deg * kDegree), sine * std::sin(azimuth_deg * kDegree),
          -std::cos(inclination_deg * kDegree)};
}

/// A plane through the middle of the image as a Kinect measures it: noise, then steps of 1/8 px of
/// disparity.
cv::Mat plane(const Vector3d& normal, double distance, double sigma, uint64_t seed = 5) {
  Random random(seed);
  const double bf = NormalOptions().baseline_m * kKinect.fx;
  cv::Mat depth(kKinect.height, kKinect.width, CV_32F);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double inverse = normal.dot(kKinect.unproject(u, v, 1)) / (normal.z() * distance);
      depth.at<float>(v, u) =
          static_cast<float>(bf / (std::round(8 * (bf * inverse + random.normal(sigma))) / 8));
    }
  return depth;
}

DepthNormals estimate(const cv::Mat& depth, const NormalOptions& options = {},
                      const InclinationBias& bias = {}) {
  DepthNormals found;
  smooth_depth_and_normals(depth, kKinect, options, bias, found);
  return found;
}

struct Errors {
  double within = 0;   ///< share of the normals
  double density = 0;  ///< share of the pixels with depth
};

Errors errors(const cv::Mat& normals, const cv::Mat& depth, const Vector3d& truth, double limit_deg) {
  int pixels = 0, found = 0, good = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      if (!(depth.at<float>(v, u) > 0)) continue;
      ++pixels;
      const auto& n = normals.at<cv::Vec3f>(v, u);
      if (std::isnan(n[0])) continue;
      ++found;
      const Vector3d normal(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]));
      EXPECT_NEAR(normal.norm(), 1, 1e-4);
      good += std::acos(std::min(1.0, normal.dot(truth))) < limit_deg * kDegree ? 1 : 0;
    }
  return {double(good) / found, double(found) / pixels};
}

TEST(Normals, OfPlanesAreRightWithinOneAndAHalfDegrees) {
  for (const double sigma : {0.0, 1.0 / 16, 1.0 / 8})
    for (const double inclination : {0.0, 20.0, 45.0, 65.0}) {
      const Vector3d truth = leaning(inclination, 30 + 3 * inclination);
      const cv::Mat depth = plane(truth, 1.2, sigma);
      const Errors found = errors(estimate(depth).normals, depth, truth, 1.5);
      EXPECT_GT(found.within, 0.9) << sigma << " px, " << inclination << " deg";
      EXPECT_GT(found.density, 0.999);
    }
}

TEST(Normals, SurviveHolesAndAreNowhereElse) {
  const Vector3d truth = leaning(40, 110);
  cv::Mat depth = plane(truth, 1.2, 1.0 / 16);
  Random random(9);
  for (int hole = 0; hole < 120; ++hole)
    cv::circle(depth, {int(random.index(320)), int(random.index(240))}, 1 + int(random.index(6)), kNan, -1);
  ASSERT_LT(cv::countNonZero(depth > 0), 0.95 * double(depth.total()));
  const DepthNormals smooth = estimate(depth);
  const Errors found = errors(smooth.normals, depth, truth, 1.5);
  EXPECT_GT(found.within, 0.85);
  EXPECT_GT(found.density, 0.995);
  for (size_t i = 0; i < depth.total(); ++i) {
    const bool hole = std::isnan(depth.ptr<float>()[i]);
    ASSERT_EQ(std::isnan(smooth.depth.ptr<float>()[i]), hole);
    if (hole) {
      ASSERT_TRUE(std::isnan(smooth.normals.ptr<cv::Vec3f>()[i][0]));
    }
  }
}

TEST(Normals, SmoothingStaysWithinWhatTheMeasurementAllows) {
  for (const double sigma : {0.0, 0.05, 0.2}) {
    const cv::Mat depth = plane(leaning(30, 0), 1.0, sigma);
    const NormalOptions options;
    const cv::Mat smooth = smooth_depth(depth, kKinect, options);
    const double bf = options.baseline_m * kKinect.fx;
    // Two quanta, or three deviations of noise and quantisation together; the noise is estimated.
    const double limit = std::max(options.noise_quanta * options.disparity_quantum_px,
                                  3.6 * std::hypot(sigma, options.disparity_quantum_px / std::sqrt(12)));
    for (size_t i = 0; i < depth.total(); ++i)
      ASSERT_LE(std::abs(bf / double(depth.ptr<float>()[i]) - bf / double(smooth.ptr<float>()[i])),
                limit + 1e-3);
  }
}

TEST(Normals, AStepOfDepthStaysWhereItIs) {
  // A surface at 1 m before one at 1.05 m: 2 px of disparity.
  cv::Mat depth = plane(leaning(0, 0), 1.05, 1.0 / 16);
  const cv::Mat front = plane(leaning(0, 0), 1.0, 1.0 / 16, 6);
  front.colRange(100, 200).copyTo(depth.colRange(100, 200));
  const cv::Mat smooth = smooth_depth(depth, kKinect);
  for (int v = 0; v < depth.rows; ++v) {
    ASSERT_GT(smooth.at<float>(v, 99), 1.035F);
    ASSERT_LT(smooth.at<float>(v, 100), 1.015F);
    ASSERT_LT(smooth.at<float>(v, 199), 1.015F);
    ASSERT_GT(smooth.at<float>(v, 200), 1.035F);
  }
}

TEST(Normals, NeedANeighbourInEachDirection) {
  cv::Mat depth(20, 20, CV_32F, cv::Scalar(kNan));
  depth.at<float>(5, 5) = 1;  // alone
  depth.at<float>(10, 10) = 1;
  depth.at<float>(10, 11) = 1;  // a row of two
  depth.at<float>(15, 4) = depth.at<float>(15, 5) = depth.at<float>(16, 4) = 1;
  const cv::Mat normals = normals_from_depth(depth, kKinect);
  EXPECT_TRUE(std::isnan(normals.at<cv::Vec3f>(5, 5)[0]));
  EXPECT_TRUE(std::isnan(normals.at<cv::Vec3f>(10, 10)[0]));
  // The missing neighbours on the other sides are replaced by the point itself.
  EXPECT_NEAR(normals.at<cv::Vec3f>(15, 4)[2], -1, 1e-4);
}

TEST(Normals, AreTheSameBytesEveryTime) {
  const cv::Mat depth = plane(leaning(35, 70), 1.4, 1.0 / 8);
  const InclinationBias bias = measure_inclination_bias(kKinect, {});
  EXPECT_EQ(bias.correction_deg(), measure_inclination_bias(kKinect, {}).correction_deg());
  const DepthNormals first = estimate(depth, {}, bias);
  estimate(plane(leaning(10, 0), 2, 0.1));  // Another image between them leaves nothing behind.
  const DepthNormals second = estimate(depth, {}, bias);
  EXPECT_EQ(std::memcmp(first.normals.data, second.normals.data, first.normals.total() * sizeof(cv::Vec3f)),
            0);
  EXPECT_EQ(std::memcmp(first.depth.data, second.depth.data, first.depth.total() * sizeof(float)), 0);
}

TEST(InclinationBias, TurnsNormalsByWhatTheTableSays) {
  InclinationBias::Table table;
  table.fill(2);
  const InclinationBias bias(table);
  for (const double inclination : {10.0, 30.0, 45.0, 70.0}) {
    const cv::Mat depth = plane(leaning(inclination, 20), 1.0, 0);
    const cv::Mat plain = estimate(depth).normals;
    const cv::Mat turned = estimate(depth, {}, bias).normals;
    const cv::Vec3f before = plain.at<cv::Vec3f>(120, 160);
    const cv::Vec3f after = turned.at<cv::Vec3f>(120, 160);
    const auto lean = [](const cv::Vec3f& n) { return std::acos(-double(n[2])) / kDegree; };
    EXPECT_NEAR(lean(after) - lean(before), 2, 0.3) << inclination;
    // About z × n: the direction in which it leans stays.
    EXPECT_NEAR(std::atan2(after[1], after[0]), std::atan2(before[1], before[0]), 1e-3);
  }
}

TEST(InclinationBias, OfPlanesIsAFewDegrees) {
  NormalOptions narrow;
  narrow.widen = false;
  for (const NormalOptions& options : {NormalOptions(), narrow}) {
    const InclinationBias bias = measure_inclination_bias(kKinect, options);
    for (const double correction : bias.correction_deg()) EXPECT_LT(std::abs(correction), 5);
  }
}

}  // namespace
}  // namespace loci::perception
