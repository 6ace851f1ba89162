#pragma once

#include <optional>
#include <vector>

#include "perception/classification/primitive_shape.h"

namespace loci::perception::primitive_fits {

// Only fit_primitive() uses these: one robust least-squares fit per kind of shape.

/// Points and normals in a frame whose z axis is up and whose ground is z = 0.
struct Samples {
  std::vector<Vector3d> points, normals;
  double sigma_m = 0;      ///< noise of a point
  double sigma_angle = 0;  ///< of a normal, radian
  double base = 0;         ///< height at which the thing begins
  bool grounded = false;   ///< whether that is the ground
};

/// How badly a shape explains the samples: mean squared distance and angle in standard deviations, each
/// sample's bounded by kWorst.
inline constexpr double kWorst = 9;
double cost_of(const PrimitiveShape& shape, const Samples& samples);
/// Fills in `explained` and `error`.
void judge(PrimitiveShape& shape, const Samples& samples);

// Every fit of a kind that the samples allow; none when they do not show enough.
std::vector<PrimitiveShape> fit_boxes(const Samples& samples);
std::vector<PrimitiveShape> fit_standing(const Samples& samples);  ///< a cylinder and a cone
std::vector<PrimitiveShape> fit_lying(const Samples& samples);     ///< cylinders
std::vector<PrimitiveShape> fit_spheres(const Samples& samples);

}  // namespace loci::perception::primitive_fits
