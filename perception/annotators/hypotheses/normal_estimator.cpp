#include "perception/annotators/hypotheses/normal_estimator.h"

#include "perception/annotators/scene_data.h"
#include "perception/conversions/camera.h"
#include "perception/conversions/opencv.h"

namespace loci {

AnnotatorDescriptor NormalEstimator::descriptor() const {
  return {"NormalEstimator",
          "Smooths the depth picture within what its measurements allow, and gives every point a normal.",
          {"Scene", "view:depth", "CameraInfo"},
          {"view:smoothed_depth", "view:cloud", "view:normals"}};
}

void NormalEstimator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const PinholeCamera camera = types::cameras(scene).depth;
  const cv::Mat smoothed = smooth_depth(types::view_image(scene, types::SceneCas::kDepth), camera, options_);
  const cv::Mat points = points_from_depth(smoothed, camera);
  types::set_view_image(scene, types::SceneCas::kSmoothedDepth, smoothed);
  set_cloud_points(scene, points);
  set_cloud_normals(scene, normals_from_points(points));
}

}  // namespace loci
