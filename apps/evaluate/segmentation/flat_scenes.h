#pragma once

#include <opencv2/core.hpp>

#include "apps/evaluate/segmentation/scores.h"
#include "mapping/base/random.h"
#include "mapping/render/render.h"
#include "mapping/sensor/camera.h"
#include "mapping/sensor/kinect.h"

namespace loci::apps::segmentation_evaluation {

/// One image of a flat scene.
struct FlatImage {
  cv::Mat depth;        ///< CV_32F, as the sensor measures it
  cv::Mat color;        ///< CV_8UC3, twice as large
  LabelledImage truth;  ///< of the colour image: which piece
};

/// A workspace of two tables side by side, uneven by some millimetres, before a Kinect that stands still and
/// has a colour image of twice the depth image's size (§4.3). Pieces of a toy train's track, 10 mm high,
/// lie on it.
class FlatWorkspace {
 public:
  /// The camera looks at the tables' middle from `distance` metres; everything else is drawn from `random`.
  FlatWorkspace(double distance, Random random);

  const mapping::RgbdCamera& camera() const { return camera_; }
  /// The ideal plane of the tables in the depth camera's frame: normal · p = offset.
  Vector3d normal() const;
  double offset() const;
  /// CV_8U: depth pixels in which the tables are seen.
  cv::Mat inside() const;

  /// Depth of the empty tables, with noise of its own.
  cv::Mat empty_depth(uint64_t number) const;
  /// Some pieces anew, under light of another strength and tint, with a bright strip somewhere, as an
  /// automatic exposure shows it.
  FlatImage image(uint64_t number) const;

 private:
  cv::Mat measured(const mapping::RenderedView& view, const Random& random) const;

  struct Colors {
    mapping::Rgba left_table, right_table;
    mapping::Rgba pieces[3];
  };
  double surface(double x, double y) const;
  mapping::TriangleMesh tables() const;
  mapping::TriangleMesh piece(Random& draw, const Vector2d& at) const;

  Random random_;
  mapping::RgbdCamera camera_;
  Isometry3d map_from_camera_ = Isometry3d::Identity();
  Colors colors_;
  std::array<double, 8> waves_;
  double seam_ = 0;
  double step_ = 0;
  mapping::RenderScene empty_;
  mapping::RenderedView empty_view_;
};

}  // namespace loci::apps::segmentation_evaluation
