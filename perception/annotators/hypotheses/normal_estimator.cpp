#include "perception/annotators/hypotheses/normal_estimator.h"

#include "perception/annotators/scene_data.h"
#include "perception/conversions/camera.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {

AnnotatorDescriptor NormalEstimator::descriptor() const {
  return {"NormalEstimator",
          "Smooths the depth image within what its measurements allow, and gives every point a normal.",
          {"Scene", "view:depth", "CameraInfo"},
          {"view:smoothed_depth", "view:cloud", "view:normals"}};
}

void NormalEstimator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const mapping::PinholeCamera camera = types::cameras(scene).depth;
  if (!bias_ || camera != bias_camera_) {
    bias_ = options_.correct_inclination ? measure_inclination_bias(camera, options_) : InclinationBias();
    bias_camera_ = camera;
  }
  DepthNormals found;
  smooth_depth_and_normals(types::view_image(scene, types::SceneCas::kDepth), camera, options_, *bias_,
                           found);
  types::set_view_image(scene, types::SceneCas::kSmoothedDepth, found.depth);
  set_cloud_points(scene, points_from_depth(found.depth, camera));
  set_cloud_normals(scene, found.normals);
}

}  // namespace loci::perception
