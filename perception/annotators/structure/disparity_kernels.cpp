#include "perception/annotators/structure/disparity_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

// The loops are compiled for several generations of processors, and the right one is taken when the program
// starts. Sanitizers do not bear the functions that choose.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LOCI_VECTORISED __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define LOCI_VECTORISED
#endif

namespace loci::perception {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// 1/√x to 5e-6 for positive x: the exponent's guess and two of Newton's steps.
inline float inverse_root(float x) {
  float y = std::bit_cast<float>(0x5f375a86 - (std::bit_cast<int32_t>(x) >> 1));
  y *= 1.5f - 0.5f * x * y * y;
  return y * (1.5f - 0.5f * x * y * y);
}

}  // namespace

LOCI_VECTORISED
void box_step(const float* before, const float* centre, const float* after, const float* measured,
              float* __restrict result, int count, const SmoothingStep& step) {
  const float edge = step.edge;
  const float width = step.width;
  for (int i = 0; i < count; ++i) {
    const float c = centre[i];
    const float bend = before[i] + after[i] - 2 * c;
    float v = c + (std::abs(bend) < edge ? bend * (1.0f / 3.0f) : 0.0f);
    const float low = measured[i] - width;
    const float high = measured[i] + width;
    v = v < low ? low : v;
    result[i] = v > high ? high : v;
  }
}

LOCI_VECTORISED
void disparity_of_depth(const float* depth, float* __restrict result, int count, float scale) {
  for (int i = 0; i < count; ++i) {
    const float d = scale / depth[i];
    result[i] = depth[i] > 0 ? d : 0.0f;
  }
}

LOCI_VECTORISED
void depth_of_disparity(const float* disparity, float* __restrict result, int count, float scale) {
  for (int i = 0; i < count; ++i) {
    const float z = scale / disparity[i];
    result[i] = disparity[i] > 0 ? z : kNan;
  }
}

LOCI_VECTORISED
void slopes(const float* centre, int pitch, float* __restrict result, int count,
            const SlopeOptions& options) {
  const int far = options.far * pitch;
  const float part = 1.0f / static_cast<float>(options.far);
  const float straight = options.straight;
  const float* far_left = centre - far;
  const float* half_left = centre - far / 2;
  const float* left = centre - pitch;
  const float* right = centre + pitch;
  const float* half_right = centre + far / 2;
  const float* far_right = centre + far;
  for (int i = 0; i < count; ++i) {
    const float c = centre[i];
    // Direct neighbours, each replaced by the point itself when it is on another surface.
    const float near = options.near * c;
    const float to_right = right[i] - c;
    const float to_left = c - left[i];
    const bool has_right = std::abs(to_right) < near;
    const bool has_left = std::abs(to_left) < near;
    const float sum = (has_right ? to_right : 0.0f) + (has_left ? to_left : 0.0f);
    float slope = has_right || has_left ? sum : kNan;
    slope = has_right && has_left ? 0.5f * sum : slope;
    // Better ones further away, on the straighter side or, best, on both.
    const float a = far_left[i];
    const float b = far_right[i];
    const float bend_left = std::abs(a - 2 * half_left[i] + c);
    const float bend_right = std::abs(c - 2 * half_right[i] + b);
    const float bend = bend_left < bend_right ? bend_left : bend_right;
    const float side = bend_left < bend_right ? c - a : b - c;
    slope = bend < straight ? side * part : slope;
    const bool both = std::abs(a - 2 * c + b) < straight && bend_left < straight && bend_right < straight;
    result[i] = both ? (b - a) * (0.5f * part) : slope;
  }
}

LOCI_VECTORISED
void normals_of_slopes(const float* disparity, const float* slope_u, const float* slope_v,
                       float* __restrict x, float* __restrict y, float* __restrict z, int count,
                       const RowRays& rays) {
  const float fx = rays.fx, fy = rays.fy, cx = rays.cx, row = rays.v;
  for (int i = 0; i < count; ++i) {
    // The plane through the neighbours has an inverse depth that is linear in the pixel.
    const float nx = -fx * slope_u[i];
    const float ny = -fy * slope_v[i];
    const float nz = slope_u[i] * (static_cast<float>(i) - cx) + slope_v[i] * row - disparity[i];
    const float unit = inverse_root(nx * nx + ny * ny + nz * nz);
    const float length = disparity[i] > 0 ? unit : kNan;
    x[i] = nx * length;
    y[i] = ny * length;
    z[i] = nz * length;
  }
}

LOCI_VECTORISED
void tilt_normals(float* __restrict x, float* __restrict y, float* __restrict z, int count,
                  const CosineTable& tilt) {
  const float* table = tilt.data();
  constexpr int kPart = 128;
  int entry[kPart];
  for (int begin = 0; begin < count; begin += kPart) {
    const int end = begin + kPart < count ? begin + kPart : count;
    for (int i = begin; i < end; ++i) {
      // What is not a number fails the comparison.
      const float position = z[i] < 0 ? 0.5f - z[i] * kCosineSteps : 0.0f;
      entry[i - begin] = static_cast<int>(position);
    }
    // Loads from the table do not vectorise well, so they are alone.
    for (int i = begin; i < end; ++i) z[i] += table[entry[i - begin]];
    for (int i = begin; i < end; ++i) {
      const float unit = inverse_root(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
      x[i] *= unit;
      y[i] *= unit;
      z[i] *= unit;
    }
  }
}

LOCI_VECTORISED
void interleave(const float* x, const float* y, const float* z, float* __restrict result, int count) {
  for (int i = 0; i < count; ++i) {
    result[3 * i] = x[i];
    result[3 * i + 1] = y[i];
    result[3 * i + 2] = z[i];
  }
}

}  // namespace loci::perception
