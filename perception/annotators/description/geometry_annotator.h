#pragma once

#include <optional>
#include <vector>

#include "mapping/base/pose.h"
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

}  // namespace loci::perception
