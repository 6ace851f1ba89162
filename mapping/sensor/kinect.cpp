#include "mapping/sensor/kinect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"

namespace loci::mapping {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// Whether there is a depth edge between two neighbours.
bool jumps(float a, float b, double fraction) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return std::abs(a - b) > static_cast<float>(fraction) * std::min(a, b);
}

/// Pixels that adjoin a depth edge.
cv::Mat edge_pixels(const cv::Mat& depth, double fraction) {
  cv::Mat edges(depth.rows, depth.cols, CV_8U, cv::Scalar(0));
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      if (u + 1 < depth.cols && jumps(z, depth.at<float>(v, u + 1), fraction))
        edges.at<uint8_t>(v, u) = edges.at<uint8_t>(v, u + 1) = 1;
      if (v + 1 < depth.rows && jumps(z, depth.at<float>(v + 1, u), fraction))
        edges.at<uint8_t>(v, u) = edges.at<uint8_t>(v + 1, u) = 1;
    }
  }
  return edges;
}

bool near_edge(const cv::Mat& edges, int u, int v, int width) {
  const int reach = width - 1;  // A pixel that adjoins the edge is the first of the band.
  for (int y = std::max(0, v - reach); y <= std::min(edges.rows - 1, v + reach); ++y)
    for (int x = std::max(0, u - reach); x <= std::min(edges.cols - 1, u + reach); ++x)
      if (edges.at<uint8_t>(y, x) != 0) return true;
  return false;
}

/// Which pixels of a row the projector does not reach: along the row (epipolar line) the pattern column of
/// pixel u is u - disparity, and the nearest surface in a column hides those behind it.
std::vector<bool> shadow_of_row(const float* depth, int width, double focal_times_baseline) {
  constexpr double tolerance_px = 1.5;  // Of disparity: slanted surfaces must not shade themselves.
  std::vector<float> nearest(static_cast<size_t>(width) + 2, 0);  // Largest disparity per pattern column.
  const auto column = [&](int u, double disparity) { return static_cast<double>(u) - disparity; };
  for (int u = 0; u < width; ++u) {
    if (std::isnan(depth[u])) continue;
    const double disparity = focal_times_baseline / static_cast<double>(depth[u]);
    const double at = std::floor(column(u, disparity));
    if (at < 0) continue;
    for (const auto i : {static_cast<size_t>(at), static_cast<size_t>(at) + 1})
      nearest[i] = std::max(nearest[i], static_cast<float>(disparity));
  }
  std::vector<bool> shadow(static_cast<size_t>(width), false);
  for (int u = 0; u < width; ++u) {
    if (std::isnan(depth[u])) continue;
    const double disparity = focal_times_baseline / static_cast<double>(depth[u]);
    const double at = std::round(column(u, disparity));
    if (at >= 0)
      shadow[static_cast<size_t>(u)] =
          static_cast<double>(nearest[static_cast<size_t>(at)]) > disparity + tolerance_px;
  }
  return shadow;
}

/// Disparity is what the sensor measures: noise and steps are equal there, and grow with z² in depth.
float measure(double z, double bias_per_square, double focal_times_baseline, const KinectModel& model,
              Random& random) {
  const double distorted = z + bias_per_square * z * z;
  double disparity = focal_times_baseline / distorted + random.normal(model.disparity_sigma_px);
  if (model.disparity_step_px > 0)
    disparity = std::round(disparity / model.disparity_step_px) * model.disparity_step_px;
  if (disparity <= 0) return kNothing;
  const double measured = focal_times_baseline / disparity;
  const bool in_range = measured >= model.range_min_m && measured <= model.range_max_m;
  return in_range ? static_cast<float>(measured) : kNothing;
}

bool too_slanted(const cv::Vec3f& normal, const Vector3d& ray, double cos_limit) {
  const Vector3d n(static_cast<double>(normal[0]), static_cast<double>(normal[1]),
                   static_cast<double>(normal[2]));
  return !n.isZero() && std::abs(n.dot(ray.normalized())) < cos_limit;
}

}  // namespace

RgbdCamera kinect_camera() {
  RgbdCamera camera;
  camera.color.fx = camera.color.fy = 528;
  camera.depth_from_color.translation().x() = 0.022;
  return camera;
}

void KinectModel::declare(OptionTable& table) {
  table.number("range_min_m", range_min_m, "m", "Nearest measurement.", 0.01, 10);
  table.number("range_max_m", range_max_m, "m", "Farthest measurement.", 0.1, 100);
  table.number("baseline_m", baseline_m, "m", "From the depth camera to the projector on its right.", 0.001,
               1);
  table.number("disparity_sigma_px", disparity_sigma_px, "px", "Standard deviation of the disparity.", 0, 10);
  table.number("disparity_step_px", disparity_step_px, "px", "Disparity is rounded to this; 0 = not.", 0, 10);
  table.number("distortion_per_m", distortion_per_m, "1/m", "Amplitude of the fixed depth error, times z².",
               0, 0.1);
  table.number("incidence_max_deg", incidence_max_deg, "deg", "No measurement at more slanted surfaces.", 1,
               90);
  table.number("edge_probability", edge_probability, "", "Of a missing measurement beside a depth edge.", 0,
               1);
  table.integer("edge_width_px", edge_width_px, "px", "How far measurements are missing beside an edge.", 0,
                20);
  table.number("edge_jump", edge_jump, "", "A depth edge is a jump by this part of the depth.", 0.001, 1);
  table.flag("shadow", shadow, "No measurement where the projector does not reach.");
  table.number("color_sigma", color_sigma, "", "Noise of the colour camera, of 255.", 0, 100);
}

double distortion_field(const PinholeCamera& camera, int u, int v) {
  const double x = static_cast<double>(u) / camera.width;
  const double y = static_cast<double>(v) / camera.height;
  // Low frequency, no symmetry, as calibrations of this sensor show it; the numbers are no one unit's.
  return 0.6 * std::sin(2 * kPi * (0.9 * x + 0.35 * y) + 0.7) +
         0.4 * std::cos(2 * kPi * (0.5 * x - 1.1 * y) - 0.4);
}

cv::Mat measured_by_kinect(const cv::Mat& depth, const cv::Mat& normal, const PinholeCamera& camera,
                           const KinectModel& model, const Random& random, int threads) {
  cv::Mat result(depth.rows, depth.cols, CV_32F, cv::Scalar(static_cast<double>(kNothing)));
  const bool edged = model.edge_width_px > 0 && model.edge_probability > 0;
  const cv::Mat edges = edged ? edge_pixels(depth, model.edge_jump) : cv::Mat();
  const double cos_limit = std::cos(model.incidence_max_deg * kDegree);
  const double focal_times_baseline = camera.fx * model.baseline_m;
  parallel_for(static_cast<size_t>(depth.rows), threads, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int v = static_cast<int>(row);
      Random draws = random.fork(row);
      const auto shadow = model.shadow ? shadow_of_row(depth.ptr<float>(v), depth.cols, focal_times_baseline)
                                       : std::vector<bool>(static_cast<size_t>(depth.cols), false);
      for (int u = 0; u < depth.cols; ++u) {
        const float z = depth.at<float>(v, u);
        if (std::isnan(z) || shadow[static_cast<size_t>(u)]) continue;
        if (!normal.empty() && too_slanted(normal.at<cv::Vec3f>(v, u), camera.unproject(u, v, 1), cos_limit))
          continue;
        if (edged && near_edge(edges, u, v, model.edge_width_px) && draws.uniform() < model.edge_probability)
          continue;
        result.at<float>(v, u) =
            measure(static_cast<double>(z), model.distortion_per_m * distortion_field(camera, u, v),
                    focal_times_baseline, model, draws);
      }
    }
  });
  return result;
}

void add_color_noise(cv::Mat& color, const KinectModel& model, const Random& random, int threads) {
  if (model.color_sigma <= 0) return;
  parallel_for(static_cast<size_t>(color.rows), threads, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      Random draws = random.fork(row);
      uint8_t* values = color.ptr<uint8_t>(static_cast<int>(row));
      for (int i = 0; i < 3 * color.cols; ++i)
        values[i] = cv::saturate_cast<uint8_t>(values[i] + draws.normal(model.color_sigma));
    }
  });
}

}  // namespace loci::mapping
