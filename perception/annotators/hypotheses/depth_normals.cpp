#include "perception/annotators/hypotheses/depth_normals.h"

#include <cmath>
#include <limits>
#include <vector>

namespace loci {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// One box filter along a line: the mean of a value and those of its two neighbours that are on the same
/// surface. Missing values are 0 in disparity, which is across an edge from everything.
void average_row(const float* left, const float* centre, const float* right, float* result, int count,
                 float edge) {
  for (int i = 0; i < count; ++i) {
    const float c = centre[i];
    const float dl = left[i] - c;
    const float dr = right[i] - c;
    const float wl = std::abs(dl) < edge ? 1.0f : 0.0f;
    const float wr = std::abs(dr) < edge ? 1.0f : 0.0f;
    const float scale = wl + wr > 1.5f ? 1.0f / 3.0f : 0.5f;
    result[i] = c + (wl * dl + wr * dr) * scale;
  }
}

void clamp_row(const float* measured, float* value, int count, float width) {
  for (int i = 0; i < count; ++i) {
    const float low = measured[i] - width;
    const float high = measured[i] + width;
    float v = value[i];
    v = v < low ? low : v;
    value[i] = v > high ? high : v;
  }
}

}  // namespace

void NormalOptions::declare(OptionTable& table) {
  table.number("disparity_quantum_px", disparity_quantum_px, "px", "Step of the sensor's disparity.", 1e-3,
               10);
  table.number("noise_quanta", noise_quanta, "",
               "How many quanta the smoothed disparity may leave the measured one.", 0, 20);
  table.number("baseline_m", baseline_m, "m", "Distance between projector and camera.", 1e-3, 1);
  table.integer("iterations", iterations, "", "How often the 3-pixel box filter is applied.", 0, 100);
  table.number("edge_px", edge_px, "px", "Neighbours that differ by more disparity are another surface.",
               0.01, 100);
}

cv::Mat smooth_depth(const cv::Mat& depth, const PinholeCamera& camera, const NormalOptions& options) {
  // A frame of one missing pixel all around spares the loops their borders.
  const int rows = depth.rows;
  const int cols = depth.cols;
  const auto bf = static_cast<float>(options.baseline_m * camera.fx);
  const auto edge = static_cast<float>(options.edge_px);
  const auto width = static_cast<float>(options.disparity_quantum_px * options.noise_quanta);
  cv::Mat measured(rows + 2, cols + 2, CV_32F, cv::Scalar(0));
  for (int v = 0; v < rows; ++v) {
    const float* in = depth.ptr<float>(v);
    float* out = measured.ptr<float>(v + 1) + 1;
    for (int u = 0; u < cols; ++u) out[u] = in[u] > 0 ? bf / in[u] : 0.0f;
  }
  cv::Mat value = measured.clone();
  cv::Mat across(rows + 2, cols + 2, CV_32F, cv::Scalar(0));
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    for (int v = 1; v <= rows; ++v) {
      const float* row = value.ptr<float>(v);
      average_row(row, row + 1, row + 2, across.ptr<float>(v) + 1, cols, edge);
    }
    for (int v = 1; v <= rows; ++v) {
      float* row = value.ptr<float>(v) + 1;
      average_row(across.ptr<float>(v - 1) + 1, across.ptr<float>(v) + 1, across.ptr<float>(v + 1) + 1, row,
                  cols, edge);
      clamp_row(measured.ptr<float>(v) + 1, row, cols, width);
    }
  }
  cv::Mat result(rows, cols, CV_32F);
  for (int v = 0; v < rows; ++v) {
    const float* measure = measured.ptr<float>(v + 1) + 1;
    const float* in = value.ptr<float>(v + 1) + 1;
    float* out = result.ptr<float>(v);
    for (int u = 0; u < cols; ++u) out[u] = measure[u] > 0 ? bf / in[u] : kNan;
  }
  return result;
}

cv::Mat points_from_depth(const cv::Mat& depth, const PinholeCamera& camera) {
  cv::Mat points(depth.rows, depth.cols, CV_32FC3);
  std::vector<float> x_slope(static_cast<size_t>(depth.cols));
  for (int u = 0; u < depth.cols; ++u)
    x_slope[static_cast<size_t>(u)] = static_cast<float>((u - camera.cx) / camera.fx);
  for (int v = 0; v < depth.rows; ++v) {
    const auto y_slope = static_cast<float>((v - camera.cy) / camera.fy);
    const float* in = depth.ptr<float>(v);
    cv::Vec3f* out = points.ptr<cv::Vec3f>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const float z = in[u];
      out[u] = std::isnan(z) ? cv::Vec3f(kNan, kNan, kNan)
                             : cv::Vec3f(x_slope[static_cast<size_t>(u)] * z, y_slope * z, z);
    }
  }
  return points;
}

cv::Mat normals_from_points(const cv::Mat& points) {
  const int rows = points.rows;
  const int cols = points.cols;
  cv::Mat normals(rows, cols, CV_32FC3);
  for (int v = 0; v < rows; ++v) {
    const cv::Vec3f* here = points.ptr<cv::Vec3f>(v);
    const cv::Vec3f* above = points.ptr<cv::Vec3f>(v > 0 ? v - 1 : v);
    const cv::Vec3f* below = points.ptr<cv::Vec3f>(v + 1 < rows ? v + 1 : v);
    cv::Vec3f* out = normals.ptr<cv::Vec3f>(v);
    for (int u = 0; u < cols; ++u) {
      const cv::Vec3f& p = here[u];
      const float reach = 0.05f * p[2];
      // A comparison with NaN is false: a missing neighbour is replaced by the point itself.
      const auto near = [&](const cv::Vec3f& q) -> const cv::Vec3f& {
        return std::abs(q[2] - p[2]) < reach ? q : p;
      };
      const cv::Vec3f h = near(here[u + 1 < cols ? u + 1 : u]) - near(here[u > 0 ? u - 1 : u]);
      const cv::Vec3f w = near(below[u]) - near(above[u]);
      const cv::Vec3f n(w[1] * h[2] - w[2] * h[1], w[2] * h[0] - w[0] * h[2], w[0] * h[1] - w[1] * h[0]);
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      if (!(length > 0)) {
        out[u] = cv::Vec3f(kNan, kNan, kNan);
        continue;
      }
      const bool away = n[0] * p[0] + n[1] * p[1] + n[2] * p[2] > 0;
      out[u] = n * ((away ? -1.0f : 1.0f) / length);
    }
  }
  return normals;
}

}  // namespace loci
