#pragma once

#include <array>
#include <vector>

#include "mapping/interpretation/face_planes.h"
#include "mapping/interpretation/surface.h"

namespace loci::mapping {

/// A ray that met a face or came near it, in the face's coordinates.
struct FaceRay {
  float u = 0, v = 0;              ///< where it crosses the plane: free of the noise of the range
  float depth = 0;                 ///< of the point before (+) or behind (-) the plane, metres
  float slope_u = 0, slope_v = 0;  ///< change of u and v per metre of depth along the ray; 0 without origins
  uint16_t scan = 0;
  bool returned = true;
  std::array<float, 4> look{};  ///< intensity over cosine of incidence, red, green, blue in [0,1]

  /// Of the point itself.
  double point_u() const { return static_cast<double>(u + slope_u * depth); }
  double point_v() const { return static_cast<double>(v + slope_v * depth); }
};

/// A rectangle in a face, metres.
struct FaceRect {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;

  double width() const { return u1 - u0; }
  double height() const { return v1 - v0; }
  double u() const { return (u0 + u1) / 2; }
  double v() const { return (v0 + v1) / 2; }
  bool contains(double u, double v, double margin = 0) const {
    return u >= u0 - margin && u <= u1 + margin && v >= v0 - margin && v <= v1 + margin;
  }
  FaceRect grown(double by) const { return {u0 - by, u1 + by, v0 - by, v1 + by}; }
};

/// The rays that met a face or its surroundings, gathered over all scans. The offset and turn of every scan
/// against the others are taken out: registration is good to some millimetres, the seams of furniture ask for
/// less.
struct FaceRays {
  Face face;
  std::vector<FaceRay> rays;
  double sigma = 0;  ///< of single depths on the face, metres
  size_t scans = 0;  ///< number of scans that saw it
};

inline constexpr double kFaceCell = 0.004;     // m; of all rasters over faces
inline constexpr double kFaceMargin = 0.12;    // m around a face
inline constexpr double kFaceRelief = 0.035;   // m; what lies nearer to the plane belongs to the face
inline constexpr double kFixtureReach = 0.09;  // m; handles do not stand out farther
inline constexpr double kBeforeFace = 0.30;    // m; rays that end farther before a face say nothing about it

FaceRays gather_rays(const Surface& surface, const Face& face, double floor_height);

/// Grid over a face; the first row is at the bottom.
struct FaceGrid {
  double u0 = 0, v0 = 0;
  int width = 0, height = 0;

  explicit FaceGrid(const Face& face);
  int column(double u) const { return static_cast<int>(std::floor((u - u0) / kFaceCell)); }
  int row(double v) const { return static_cast<int>(std::floor((v - v0) / kFaceCell)); }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  size_t number(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  size_t size() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  double u(int x) const { return u0 + (x + 0.5) * kFaceCell; }
  double v(int y) const { return v0 + (y + 0.5) * kFaceCell; }
};

}  // namespace loci::mapping
