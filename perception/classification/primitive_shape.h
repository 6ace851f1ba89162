#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "perception/classification/shape_features.h"

namespace loci::perception {

/// A shape that a few numbers describe.
struct PrimitiveShape {
  enum class Kind { box, cylinder, cone, sphere };

  Kind kind = Kind::box;
  /// Origin at the centre, z along the axis; that of a box is upright.
  Isometry3d frame_from_shape = Isometry3d::Identity();
  Vector3d size = Vector3d::Zero();  ///< full extent along the axes of the shape, m
  double radius_low = 0;             ///< of what is round: at the end of the axis with the smaller z, m
  double radius_high = 0;            ///< at the other end; the same unless it is a cone
  double explained = 0;              ///< share of the points that lie on it
  double error = 0;                  ///< root of the mean squared distance of these from it, m
  double probability = 0;            ///< that it is this kind and none of the others

  double radius() const { return (radius_low + radius_high) / 2; }
};

/// "box", "cylinder", "cone", "sphere".
std::string name_of(PrimitiveShape::Kind kind);

struct PrimitiveOptions {
  double noise_m = 0.002;        ///< of the distance of a point from a surface
  double noise_per_m2 = 0.0015;  ///< what is added at a metre from the camera; grows with the square
  double normal_deg = 15;        ///< of a normal
  double ground_m = 0.04;        ///< what ends this near above the ground reaches down to it

  void declare(OptionTable& table);
};

/// The box, cylinder, cone or sphere that explains a surface best: each is fitted to points and normals
/// (robust least squares; standing and lying objects, boxes with one pair of faces level), and the
/// likelihood of distances and angles decides, with a price for each number that a shape needs. What nobody
/// sees follows from symmetry (round objects) or is taken to end where the points do (boxes). Points in the
/// camera's frame (origin = camera). None when fewer than 30 points have a normal.
std::optional<PrimitiveShape> fit_primitive(const SurfacePoints& surface, const Ground& ground,
                                            const PrimitiveOptions& options = {});

}  // namespace loci::perception
