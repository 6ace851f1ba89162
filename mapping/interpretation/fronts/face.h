#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "mapping/interpretation/fronts/furniture_face.h"
#include "mapping/interpretation/fronts/parameters.h"
#include "mapping/interpretation/surfaces/surface.h"

namespace loci::mapping {

/// Vertical planes of any size and direction by Hough votes of small pieces of surface: the strongest plane
/// takes its inliers, then the next. Layers 3 cm apart are separate planes.
std::vector<FurnitureFace> find_faces(const Surface& surface, double floor_height);

/// A ray that met a face or came near it, in the face's coordinates.
struct FaceRay {
  float u = 0, v = 0;              ///< crossing with the plane: independent of range noise
  float depth = 0;                 ///< of the point before (+) or behind (-) the plane, metres
  float slope_u = 0, slope_v = 0;  ///< change of u and v per metre of depth along the ray; 0 without origins
  uint16_t scan = 0;
  bool returned = true;
  std::array<float, 4> appearance{};  ///< intensity over cosine of incidence, red, green, blue in [0,1]

  double plane_u() const { return static_cast<double>(u); }
  double plane_v() const { return static_cast<double>(v); }
  /// Of the point itself.
  double point_u() const { return static_cast<double>(u + slope_u * depth); }
  double point_v() const { return static_cast<double>(v + slope_v * depth); }
  /// Where the ray is at a depth.
  Vector2d at_depth(double at) const {
    return {plane_u() + static_cast<double>(slope_u) * at, plane_v() + static_cast<double>(slope_v) * at};
  }
  float cosine() const { return 1 / std::sqrt(1 + slope_u * slope_u + slope_v * slope_v); }  ///< of incidence
  bool is_on_face() const { return returned && std::abs(depth) < static_cast<float>(kFaces.relief_m); }
};

/// A rectangle in a face, metres.
struct FaceRect {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;

  double width() const { return u1 - u0; }
  double height() const { return v1 - v0; }
  double u() const { return (u0 + u1) / 2; }
  double v() const { return (v0 + v1) / 2; }
  /// Bounds along u (upright lines) or v (level lines).
  double& low(bool along_u) { return along_u ? u0 : v0; }
  double& high(bool along_u) { return along_u ? u1 : v1; }
  double low(bool along_u) const { return along_u ? u0 : v0; }
  double high(bool along_u) const { return along_u ? u1 : v1; }
  bool contains(double u, double v, double margin = 0) const {
    return u >= u0 - margin && u <= u1 + margin && v >= v0 - margin && v <= v1 + margin;
  }
  bool contains(const FaceRay& ray, double margin = 0) const {
    return contains(ray.plane_u(), ray.plane_v(), margin);
  }
  bool intersects(const FaceRect& other) const {
    return u0 < other.u1 && other.u0 < u1 && v0 < other.v1 && other.v0 < v1;
  }
  FaceRect grown(double by) const { return {u0 - by, u1 + by, v0 - by, v1 + by}; }
};

/// The rays of all scans that met a face or its surroundings. Offsets and rotations between scans are
/// removed: the seams of furniture are finer than the errors of registration.
struct FaceRays {
  FurnitureFace face;
  std::vector<FaceRay> rays;
  double sigma = 0;  ///< of single depths on the face, metres
  size_t scans = 0;  ///< number of scans that saw it
};

FaceRays gather_rays(const Surface& surface, const FurnitureFace& face, double floor_height);

/// Grid over a face; the first row is at the bottom.
struct FaceGrid {
  double u0 = 0, v0 = 0;
  int width = 0, height = 0;

  explicit FaceGrid(const FurnitureFace& face);
  FaceRect extent() const { return {u0, u0 + width * kFaces.cell_m, v0, v0 + height * kFaces.cell_m}; }
  int column(double u) const { return static_cast<int>(std::floor((u - u0) / kFaces.cell_m)); }
  int row(double v) const { return static_cast<int>(std::floor((v - v0) / kFaces.cell_m)); }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  size_t number(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  size_t size() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  double u(int x) const { return u0 + (x + 0.5) * kFaces.cell_m; }
  double v(int y) const { return v0 + (y + 0.5) * kFaces.cell_m; }
};

/// Depth of a face's surface by place: fronts before the body, panels in frames. Where two layers meet, the
/// depth of the front one; handles and knobs are too small to affect it.
class FaceGround {
 public:
  explicit FaceGround(const FaceRays& rays);

  /// Depth against the plane, metres; 0 where too little was seen.
  double at(double u, double v) const;

 private:
  FaceGrid grid_;
  int width_ = 0, height_ = 0;
  std::vector<float> depth_;
};

}  // namespace loci::mapping
