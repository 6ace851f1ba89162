#pragma once

#include <vector>

#include "mapping/base/pose.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// The rectangle that a thing covers on its support.
struct Footprint {
  Vector2d centre = Vector2d::Zero(), half = Vector2d::Zero();
  double yaw = 0;

  bool holds(const Vector2d& point) const;
  /// Points that are spread over it evenly.
  std::vector<Vector2d> spread() const;
};

/// How two things lie to each other, as seen along `away` (a horizontal unit vector). Shares of pairs of
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
