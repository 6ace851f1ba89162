#include "mapping/tracking/frame_images.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/tracking/parameters.h"

namespace loci::mapping::tracking {
namespace {

float jump_at(float inverse_depth) {
  return kImages.jump + kImages.relative_jump * inverse_depth;
}

/// Means over blocks of factor × factor pixels; of each block the nearest surface counts.
cv::Mat shrunk(const cv::Mat& inverse_depth, int factor) {
  cv::Mat result(inverse_depth.rows / factor, inverse_depth.cols / factor, CV_32F);
  for (int v = 0; v < result.rows; ++v) {
    for (int u = 0; u < result.cols; ++u) {
      float nearest = 0;
      for (int y = v * factor; y < (v + 1) * factor; ++y) {
        const auto* row = inverse_depth.ptr<float>(y) + static_cast<ptrdiff_t>(u) * factor;
        nearest = std::max(nearest, *std::max_element(row, row + factor));
      }
      const float limit = nearest - jump_at(nearest);
      float sum = 0, count = 0;
      for (int y = v * factor; y < (v + 1) * factor; ++y) {
        const auto* row = inverse_depth.ptr<float>(y) + static_cast<ptrdiff_t>(u) * factor;
        for (int x = 0; x < factor; ++x) {
          const float counts = row[x] > limit ? 1.0F : 0.0F;
          sum += counts * row[x];
          count += counts;
        }
      }
      result.at<float>(v, u) = nearest > 0 ? sum / count : 0;
    }
  }
  return result;
}

/// Means over neighbours that lie on the same surface.
cv::Mat smoothed(const cv::Mat& inverse_depth, int radius) {
  cv::Mat padded;
  cv::copyMakeBorder(inverse_depth, padded, radius, radius, radius, radius, cv::BORDER_CONSTANT, 0);
  cv::Mat result(inverse_depth.size(), CV_32F);
  const auto width = static_cast<size_t>(inverse_depth.cols);
  std::vector<float> sum(width), count(width), jump(width);
  for (int v = 0; v < inverse_depth.rows; ++v) {
    const auto* centre = inverse_depth.ptr<float>(v);
    std::fill(sum.begin(), sum.end(), 0.0F);
    std::fill(count.begin(), count.end(), 1e-20F);
    for (size_t u = 0; u < width; ++u) jump[u] = jump_at(centre[u]);
    for (int dv = 0; dv <= 2 * radius; ++dv) {
      for (int du = 0; du <= 2 * radius; ++du) {
        const float* row = padded.ptr<float>(v + dv) + du;
        for (size_t u = 0; u < width; ++u) {
          const float counts = std::abs(row[u] - centre[u]) < jump[u] ? 1.0F : 0.0F;
          sum[u] += counts * row[u];
          count[u] += counts;
        }
      }
    }
    auto* out = result.ptr<float>(v);
    for (size_t u = 0; u < width; ++u) out[u] = centre[u] > 0 ? sum[u] / count[u] : 0;
  }
  return result;
}

cv::Mat inverse_of(const cv::Mat& depth) {
  cv::Mat inverse(depth.size(), CV_32F);
  for (int v = 0; v < depth.rows; ++v) {
    const auto* z = depth.ptr<float>(v);
    auto* out = inverse.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) out[u] = z[u] > 0 ? 1 / z[u] : 0;  // NaN: not measured.
  }
  return inverse;
}

/// log_intensity() and its gradient, as three channels: they are interpolated together.
cv::Mat with_gradient(const cv::Mat& gray) {
  static const auto kLogarithm = [] {
    std::array<float, 256> table{};
    for (size_t i = 0; i < table.size(); ++i) table[i] = log_intensity(static_cast<float>(i));
    return table;
  }();
  cv::Mat blurred;
  cv::GaussianBlur(gray, blurred, {3, 3}, 0.8);
  cv::Mat result(gray.size(), CV_32FC3, cv::Scalar::all(0));
  for (int v = 0; v < gray.rows; ++v) {
    const auto* row = blurred.ptr<uint8_t>(v);
    const auto* above = blurred.ptr<uint8_t>(std::max(v - 1, 0));
    const auto* below = blurred.ptr<uint8_t>(std::min(v + 1, gray.rows - 1));
    auto* out = result.ptr<cv::Vec3f>(v);
    for (int u = 0; u < gray.cols; ++u) {
      const int left = std::max(u - 1, 0), right = std::min(u + 1, gray.cols - 1);
      out[u] = {kLogarithm[row[u]], 0.5F * (kLogarithm[row[right]] - kLogarithm[row[left]]),
                0.5F * (kLogarithm[below[u]] - kLogarithm[above[u]])};
    }
  }
  return result;
}

cv::Mat shrunk_gray(const cv::Mat& color, int factor) {
  cv::Mat gray, result;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::resize(gray, result, {color.cols / factor, color.rows / factor}, 0, 0, cv::INTER_AREA);
  return result;
}

int factor_to(int target_width, int width) {
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(width) / target_width)));
}

}  // namespace

float log_intensity(float intensity) {
  return kImages.intensity_scale * std::log(1 + intensity / kImages.intensity_offset);
}

bool is_saturated(float logarithm) {
  static const float kSaturated = log_intensity(kImages.saturated);
  return logarithm >= kSaturated;
}

PinholeCamera coarser(const PinholeCamera& camera, int factor) {
  const auto f = static_cast<double>(factor);
  return {camera.width / factor, camera.height / factor,      camera.fx / f,
          camera.fy / f,         (camera.cx + 0.5) / f - 0.5, (camera.cy + 0.5) / f - 0.5};
}

cv::Mat normals_of(const cv::Mat& inverse_depth, const PinholeCamera& camera, int step) {
  cv::Mat normals(inverse_depth.size(), CV_32FC3, cv::Scalar::all(0));
  const auto fx = static_cast<float>(camera.fx / (2 * step)), fy = static_cast<float>(camera.fy / (2 * step));
  for (int v = step; v + step < inverse_depth.rows; ++v) {
    const auto* row = inverse_depth.ptr<float>(v);
    const auto* above = inverse_depth.ptr<float>(v - step);
    const auto* below = inverse_depth.ptr<float>(v + step);
    const auto y = static_cast<float>((v - camera.cy) / camera.fy);
    for (int u = step; u + step < inverse_depth.cols; ++u) {
      const float d = row[u], left = row[u - step], right = row[u + step], up = above[u], down = below[u];
      if (d <= 0 || left <= 0 || right <= 0 || up <= 0 || down <= 0) continue;
      const float bend = jump_at(d);
      if (std::abs(left + right - 2 * d) > bend || std::abs(up + down - 2 * d) > bend) continue;
      const float a = (right - left) * fx, b = (down - up) * fy;
      const float c = d - a * static_cast<float>((u - camera.cx) / camera.fx) - b * y;
      const float length = -1 / std::sqrt(a * a + b * b + c * c);
      normals.at<cv::Vec3f>(v, u) = {a * length, b * length, c * length};
    }
  }
  return normals;
}

FrameImages frame_images(const RgbdFrame& frame, const cv::Mat& offsets) {
  FrameImages images;
  images.depth_from_color = frame.camera.depth_from_color;
  const int depth_factor = factor_to(kImages.width, frame.depth.cols);
  ImageLevel level;
  level.depth_camera = coarser(frame.camera.depth, depth_factor);
  level.inverse_depth = shrunk(inverse_of(frame.depth), depth_factor);
  if (!offsets.empty())
    cv::subtract(level.inverse_depth, offsets, level.inverse_depth, level.inverse_depth > 0);
  level.inverse_depth = smoothed(level.inverse_depth, kImages.smoothing_radius);
  images.measured = static_cast<double>(cv::countNonZero(level.inverse_depth)) /
                    static_cast<double>(level.inverse_depth.total());
  if (!frame.color.empty()) {
    const int color_factor = factor_to(kImages.width, frame.color.cols);
    level.color_camera = coarser(frame.camera.color, color_factor);
    images.gray = shrunk_gray(frame.color, color_factor);
  }
  cv::Mat gray = images.gray;
  for (int step = kImages.normal_step;; step = 2) {
    level.normals = normals_of(level.inverse_depth, level.depth_camera, step);
    if (!gray.empty()) level.intensity = with_gradient(gray);
    images.levels.push_back(level);
    if (images.levels.size() == std::size(kAlignment.stride) ||
        level.depth_camera.width / 2 < kImages.min_level_width)
      return images;
    level.depth_camera = coarser(level.depth_camera, 2);
    level.inverse_depth = shrunk(level.inverse_depth, 2);
    if (!gray.empty()) {
      level.color_camera = coarser(level.color_camera, 2);
      cv::resize(gray, gray, {gray.cols / 2, gray.rows / 2}, 0, 0, cv::INTER_AREA);
    }
  }
}

}  // namespace loci::mapping::tracking
