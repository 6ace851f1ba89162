#include "mapping/recording/rectification.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/text/text.h"

namespace loci::mapping {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

/// Whether depths belong to one surface.
bool on_one_surface(float a, float b) {
  return std::abs(a - b) < 0.01F + 0.01F * std::min(a, b);
}

double coefficient(const std::vector<double>& values, size_t i) {
  return i < values.size() ? values[i] : 0;
}

/// The largest |ray| up to which the lens maps different rays to different places: beyond it polynomials
/// fold.
double max_ray(const Distortion& distortion) {
  constexpr double kStep = 0.01, kEnd = 10;
  double before = 0;
  for (double r = kStep; r < kEnd; r += kStep) {
    const double now = distortion.distorted({r, 0}).x();
    if (now <= before) return r - kStep;
    before = now;
  }
  return kEnd;
}

/// The nearest depth on one side of a pixel, at most two steps away.
struct Neighbour {
  float z = kHole;
  int steps = 0;
};
Neighbour neighbour(const cv::Mat& depth, int u, int v, int du, int dv) {
  for (int steps = 1; steps <= 2; ++steps) {
    const int x = u + steps * du, y = v + steps * dv;
    if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) break;
    if (const float z = depth.at<float>(y, x); z > 0) return {z, steps};
  }
  return {};
}

/// What opposite neighbours of a hole agree on; NaN where they do not.
float bridged(const cv::Mat& depth, int u, int v) {
  constexpr std::array<std::array<int, 2>, 4> kDirections = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  float best = kHole;
  int nearest = std::numeric_limits<int>::max();
  for (const auto& [du, dv] : kDirections) {
    const Neighbour a = neighbour(depth, u, v, du, dv), b = neighbour(depth, u, v, -du, -dv);
    if (a.steps == 0 || b.steps == 0 || !on_one_surface(a.z, b.z) || a.steps + b.steps >= nearest) continue;
    nearest = a.steps + b.steps;
    best =
        (a.z * static_cast<float>(b.steps) + b.z * static_cast<float>(a.steps)) / static_cast<float>(nearest);
  }
  return best;
}

}  // namespace

Vector2d Distortion::distorted(const Vector2d& ray) const {
  if (model == Model::none) return ray;
  const auto k = [this](size_t i) { return coefficient(coefficients, i); };
  const double r2 = ray.squaredNorm();
  if (model == Model::equidistant) {
    const double r = std::sqrt(r2), angle = std::atan(r), a2 = angle * angle;
    if (r < 1e-12) return ray;
    return ray * (angle * (1 + a2 * (k(0) + a2 * (k(1) + a2 * (k(2) + a2 * k(3)))))) / r;
  }
  const double radial =
      (1 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (1 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
  const double x = ray.x(), y = ray.y();
  return {x * radial + 2 * k(2) * x * y + k(3) * (r2 + 2 * x * x) + r2 * (k(8) + r2 * k(9)),
          y * radial + k(2) * (r2 + 2 * y * y) + 2 * k(3) * x * y + r2 * (k(10) + r2 * k(11))};
}

Distortion distortion_from(const std::string& model, const std::vector<double>& coefficients,
                           const FileLocation& location) {
  Distortion distortion;
  if (!std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return std::isfinite(k); }))
    throw Error("distortion coefficients are finite numbers", location);
  if (std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return k == 0; }))
    return distortion;
  const std::string name = lower_case(model);
  size_t min = 0, max = 0;
  if (name == "plumb_bob" || name == "brown_conrady") {
    distortion.model = Distortion::Model::plumb_bob;
    min = 4, max = 5;
  } else if (name == "rational_polynomial") {
    distortion.model = Distortion::Model::rational_polynomial;
    min = 5, max = 12;
  } else if (name == "equidistant" || name == "fisheye" || name == "kannala_brandt4") {
    distortion.model = Distortion::Model::equidistant;
    min = max = 4;
  } else {
    throw Error(fmt::format("distortion of model '{}' is not read", model), location,
                "plumb_bob, rational_polynomial and equidistant are; undistort the images, or leave it out");
  }
  // Longer lists, as some drivers write, end in zeros.
  distortion.coefficients = coefficients;
  while (distortion.coefficients.size() > max && distortion.coefficients.back() == 0)
    distortion.coefficients.pop_back();
  if (distortion.coefficients.size() < min || distortion.coefficients.size() > max)
    throw Error(fmt::format("{} has {} to {} coefficients, not {}", name, min, max, coefficients.size()),
                location);
  return distortion;
}

Rectifier::Rectifier(const PinholeCamera& camera, const Distortion& distortion, const PinholeCamera& lens) {
  if (distortion.model == Distortion::Model::none && lens == camera) return;
  const double limit = max_ray(distortion);
  source_.create(camera.height, camera.width, CV_32FC2);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Vector2d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      const Vector2d there = ray.norm() < limit ? distortion.distorted(ray) : Vector2d(1e6, 1e6);
      source_.at<cv::Vec2f>(v, u) = {static_cast<float>(there.x() * lens.fx + lens.cx),
                                     static_cast<float>(there.y() * lens.fy + lens.cy)};
    }
}

cv::Mat Rectifier::color(const cv::Mat& image) const {
  if (source_.empty() || image.empty()) return image;
  cv::Mat rectified;
  cv::remap(image, rectified, source_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return rectified;
}

cv::Mat Rectifier::depth(const cv::Mat& image) const {
  if (source_.empty()) return image;
  cv::Mat rectified(image.size(), CV_32F, cv::Scalar(static_cast<double>(kHole)));
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const cv::Vec2f& at = source_.at<cv::Vec2f>(v, u);
      const int x = cvRound(at[0]), y = cvRound(at[1]);
      if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) continue;
      float& z = rectified.at<float>(v, u);
      z = image.at<float>(y, x);
      const int x0 = cvFloor(at[0]), y0 = cvFloor(at[1]);
      if (x0 < 0 || y0 < 0 || x0 + 1 >= image.cols || y0 + 1 >= image.rows) continue;
      const std::array<float, 4> corners = {image.at<float>(y0, x0), image.at<float>(y0, x0 + 1),
                                            image.at<float>(y0 + 1, x0), image.at<float>(y0 + 1, x0 + 1)};
      const auto near = [&](float corner) { return on_one_surface(corner, corners[0]); };  // Not NaN either.
      if (!std::all_of(corners.begin(), corners.end(), near)) continue;
      const float a = at[0] - static_cast<float>(x0), b = at[1] - static_cast<float>(y0);
      z = (1 - b) * ((1 - a) * corners[0] + a * corners[1]) + b * ((1 - a) * corners[2] + a * corners[3]);
    }
  return rectified;
}

cv::Mat z_along_rays(const PinholeCamera& camera) {
  cv::Mat z(camera.height, camera.width, CV_32F);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u)
      z.at<float>(v, u) = static_cast<float>(1 / camera.unproject(u, v, 1).norm());
  return z;
}

void ImageCorrection::apply(RgbdFrame& frame) const {
  if (close_grid_holes) mapping::close_grid_holes(frame.depth);
  frame.depth = depth.depth(frame.depth);
  if (!z_of_distance.empty())
    frame.depth = frame.depth.mul(z_of_distance);  // No measurement, NaN, stays NaN.
  frame.color = color.color(frame.color);
}

bool has_grid_holes(const cv::Mat& depth) {
  constexpr double kShare = 0.25;  // Sensors leave single pixels without depth: at most a few in a hundred.
  size_t measured = 0, bridges = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      if (depth.at<float>(v, u) > 0)
        ++measured;
      else if (bridged(depth, u, v) > 0)
        ++bridges;
    }
  return static_cast<double>(bridges) > kShare * static_cast<double>(measured);
}

void close_grid_holes(cv::Mat& depth) {
  const cv::Mat before = depth.clone();
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      if (!(before.at<float>(v, u) > 0)) depth.at<float>(v, u) = bridged(before, u, v);
}

}  // namespace loci::mapping
