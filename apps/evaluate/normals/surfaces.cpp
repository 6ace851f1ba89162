#include "apps/evaluate/normals/surfaces.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "mapping/base/math/math.h"

namespace loci::apps::normals_evaluation {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const cv::Vec3f kNoNormal(kNan, kNan, kNan);

/// A plane in disparity: value = d0 + du · u + dv · v, with its normal.
struct Patch {
  double u = 0, v = 0;  ///< the pixel around which it lies
  Vector3d disparity = Vector3d::Zero();
  cv::Vec3f normal;
};

cv::Vec3f to_float(const Vector3d& n) {
  return {static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())};
}

Patch random_patch(const mapping::PinholeCamera& camera, double bf, Random& random) {
  constexpr double kSteepest = 75 * kPi / 180;
  Patch patch;
  patch.u = random.uniform(0, camera.width);
  patch.v = random.uniform(0, camera.height);
  const double inclination = random.uniform(0, kSteepest), azimuth = random.uniform(0, 2 * kPi);
  const double sine = std::sin(inclination);
  const Vector3d normal(sine * std::cos(azimuth), sine * std::sin(azimuth), -std::cos(inclination));
  patch.normal = to_float(normal);
  // Inverse depth of a plane n · p = c is n · ray / c, linear in the pixel.
  const double depth = random.uniform(0.7, 3.0);
  const double c = normal.dot(camera.unproject(patch.u, patch.v, depth));
  patch.disparity =
      bf / c *
      Vector3d(normal.dot(camera.unproject(0, 0, 1)), normal.x() / camera.fx, normal.y() / camera.fy);
  return patch;
}

/// Least squares over the pixels of a square that lie within `limit` of `plane` (all of them when it is
/// null). Offsets are counted from the square's corner.
struct Fit {
  Vector3d plane = Vector3d::Zero();
  int measured = 0, inliers = 0;
};

Fit fit_plane(const cv::Mat& disparity, const Vector3d* plane, double limit) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  Fit fit;
  for (int v = 0; v < disparity.rows; ++v)
    for (int u = 0; u < disparity.cols; ++u) {
      const double d = static_cast<double>(disparity.at<float>(v, u));
      if (!(d > 0)) continue;
      ++fit.measured;
      const Vector3d row(1, u, v);
      if (plane != nullptr && std::abs(row.dot(*plane) - d) > limit) continue;
      ++fit.inliers;
      normal += row * row.transpose();
      right += d * row;
    }
  if (fit.inliers >= 3) fit.plane = normal.ldlt().solve(right);
  return fit;
}

}  // namespace

Surfaces planar_patches(const mapping::PinholeCamera& camera, const DisparityNoise& noise, Random& random) {
  constexpr size_t kPatches = 8;
  constexpr double kNearest = 0.5, kFarthest = 5;
  const double bf = noise.baseline_m * camera.fx;
  std::vector<Patch> patches;
  for (size_t i = 0; i < kPatches; ++i) patches.push_back(random_patch(camera, bf, random));
  Surfaces surfaces{cv::Mat(camera.height, camera.width, CV_32F, cv::Scalar(kNan)),
                    cv::Mat(camera.height, camera.width, CV_32FC3, cv::Scalar::all(kNan))};
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Patch* nearest = nullptr;
      double least = std::numeric_limits<double>::infinity();
      for (const Patch& patch : patches) {
        const double away = (patch.u - u) * (patch.u - u) + (patch.v - v) * (patch.v - v);
        if (away < least) {
          least = away;
          nearest = &patch;
        }
      }
      const double measured = nearest->disparity.dot(Vector3d(1, u, v)) + random.normal(noise.sigma_px);
      const double disparity = std::round(measured / noise.quantum_px) * noise.quantum_px;
      if (disparity * kFarthest < bf || disparity * kNearest > bf) continue;
      surfaces.depth.at<float>(v, u) = static_cast<float>(bf / disparity);
      surfaces.truth.at<cv::Vec3f>(v, u) = nearest->normal;
    }
  return surfaces;
}

Surfaces flat_areas(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                    const DisparityNoise& sensor) {
  constexpr int kSquare = 48, kRounds = 4;
  constexpr double kMeasured = 0.5, kOnPlane = 0.97, kQuanta = 3;
  const double bf = sensor.baseline_m * camera.fx;
  const double limit = kQuanta * sensor.quantum_px;
  Surfaces surfaces{depth, cv::Mat(depth.size(), CV_32FC3, cv::Scalar::all(kNan))};
  cv::Mat disparity(depth.size(), CV_32F);
  for (size_t i = 0; i < depth.total(); ++i)
    disparity.ptr<float>()[i] = static_cast<float>(bf) / depth.ptr<float>()[i];
  for (int top = 0; top + kSquare <= depth.rows; top += kSquare)
    for (int left = 0; left + kSquare <= depth.cols; left += kSquare) {
      const cv::Rect square(left, top, kSquare, kSquare);
      Fit fit = fit_plane(disparity(square), nullptr, 0);
      if (fit.measured < kMeasured * kSquare * kSquare) continue;
      for (int round = kRounds; round-- > 0 && fit.inliers >= 3;)
        fit = fit_plane(disparity(square), &fit.plane, (1 << round) * limit);
      if (fit.inliers < kOnPlane * fit.measured) continue;
      const double du = fit.plane(1), dv = fit.plane(2), d0 = fit.plane(0) - du * left - dv * top;
      const Vector3d normal =
          -Vector3d(du * camera.fx, dv * camera.fy, d0 + du * camera.cx + dv * camera.cy).normalized();
      for (int v = top; v < top + kSquare; ++v)
        for (int u = left; u < left + kSquare; ++u) {
          const Vector3d pixel(1, u - left, v - top);
          const double off = fit.plane.dot(pixel) - static_cast<double>(disparity.at<float>(v, u));
          if (std::abs(off) <= limit) surfaces.truth.at<cv::Vec3f>(v, u) = to_float(normal);
        }
    }
  return surfaces;
}

double share_of_holes(const cv::Mat& depth) {
  return 1 - static_cast<double>(cv::countNonZero(depth > 0)) / static_cast<double>(depth.total());
}

}  // namespace loci::apps::normals_evaluation
