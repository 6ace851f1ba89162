#pragma once

#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// A box that stands upright.
struct UprightBox {
  Isometry3d map_from_box = Isometry3d::Identity();  ///< origin at the centre, z up, x along the longer side
  Vector3d size = Vector3d::Zero();                  ///< full extents along its axes, metres
};

/// The upright box of least base area around points of the map frame, without the `outliers` share at each
/// end of an axis. `ground`: height that the box reaches down to when the points end at most `reach` above
/// it.
UprightBox upright_box(const std::vector<Vector3d>& points, double ground, double reach, double outliers);

/// Oriented box of each object in the map and in the frame of its place.
class GeometryAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  double outliers_ = 0.005;
  double ground_m_ = 0.04;
};

/// How far a position is from the nearest edge of an outline, in words: "0.30 m from its left edge". Seen
/// along y of the place's frame: left is −x, right +x, front −y, back +y. `outline`: in that frame,
/// counter-clockwise. Empty where no edge lies beside, before or behind the position.
std::string edge_phrase(const Vector2d& position, const std::vector<Vector2d>& outline);

/// "on table_1", "in drawer_2"; a support without a name is "on a surface".
std::string place_phrase(const std::string& place, const std::string& support_class);

/// Where each object is: its place, its pose there, and a sentence.
class LocationAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void process(cas::Cas& cas, Context& context) override;
};

/// The rectangle that an object covers on its support.
struct Footprint {
  Vector2d centre = Vector2d::Zero(), half = Vector2d::Zero();
  double yaw = 0;

  bool holds(const Vector2d& point) const;
  /// Points that are spread over it evenly.
  std::vector<Vector2d> spread() const;
};

/// How two objects lie to each other, as seen along `away` (a horizontal unit vector). Shares of pairs of
/// points, one of each (a histogram of angles, Miyajima and Ralescu 1994): 1 when all of a is on that side of
/// all of b within 45 degrees, a half when the direction is half way to another side.
struct Arrangement {
  double left_of = 0, right_of = 0, in_front_of = 0, behind = 0;  ///< a of b
  double gap_m = 0;                                               ///< between them; 0 where they overlap
  double over = 0;                                                ///< share of a that is above b
};
Arrangement arrangement_of(const Footprint& a, const Footprint& b, const Vector2d& away);

/// Fills in the scene's table of relations (Table 3.1): left-of, in-front-of, near, on-top-of, on,
/// similar-appearance.
class RelationsAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  double near_m_ = 0.1;
  double reach_m_ = 0.6;
  double min_probability_ = 0.1;
};

}  // namespace loci::perception
