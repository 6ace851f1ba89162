#pragma once

#include <array>

namespace loci::perception {

/// Loops over rows of disparity (floats, pixels, 0 = missing) that compilers turn into vector instructions.
/// All of them only add, multiply and compare, without contraction: the same bytes whatever instructions the
/// processor has.
///
/// Lines are surrounded by zeros as far as the taps reach. A zero is further than any edge from a value, so
/// no loop needs to ask for borders or holes.
struct SmoothingStep {
  float edge;   ///< taps that are further from the line through the others belong to another surface
  float width;  ///< results stay within measured ± width
};

/// One box filter of three taps over a line: `before`, `centre` and `after` point to its values, `stride`
/// apart from one another. Where the three do not lie on one line within `edge`, the centre stays.
void box_step(const float* before, const float* centre, const float* after, const float* measured,
              float* result, int count, const SmoothingStep& step);

/// result = scale / value, 0 where value is not positive (NaN included).
void disparity_of_depth(const float* depth, float* result, int count, float scale);
/// The inverse; NaN where the disparity is 0.
void depth_of_disparity(const float* disparity, float* result, int count, float scale);

/// How neighbours are compared when slopes are taken.
struct SlopeOptions {
  int far;         ///< distance of the far neighbours, even
  float straight;  ///< far neighbours count when they are on one line within so many pixels of disparity
  float near;      ///< direct neighbours count when they differ by less than this part of the value
};

/// Slope of the disparity (per pixel) along a line, `pitch` being the distance of neighbours in memory; NaN
/// where neither neighbour is on the surface.
void slopes(const float* centre, int pitch, float* result, int count, const SlopeOptions& options);

/// Number of entries of a table over the cosine of the inclination, 0 to 1.
constexpr int kCosineSteps = 256;
using CosineTable = std::array<float, kCosineSteps + 1>;

/// What turns slopes into normals: the camera of a row of pixels.
struct RowRays {
  float fx, fy, cx;
  float v;  ///< row, counted from the principal point
};

/// Unit normals towards the camera from a row of disparities and its slopes; NaN where one is missing.
void normals_of_slopes(const float* disparity, const float* slope_u, const float* slope_v, float* x, float* y,
                       float* z, int count, const RowRays& rays);

/// Adds to the z of unit normals what the table has for the cosine of their inclination, and makes them unit
/// vectors again.
void tilt_normals(float* x, float* y, float* z, int count, const CosineTable& tilt);

/// result = x0 y0 z0 x1 y1 z1 …
void interleave(const float* x, const float* y, const float* z, float* result, int count);

}  // namespace loci::perception
