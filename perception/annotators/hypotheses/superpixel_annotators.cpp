#include "perception/annotators/hypotheses/superpixel_annotators.h"

#include "perception/annotators/scene_data.h"
#include "perception/conversions/camera.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

Superpixels superpixels_of(const types::SceneCas& scene, const SuperpixelOptions& options) {
  const mapping::RgbdCamera camera = types::cameras(scene);
  const cv::Mat points = cloud_points(scene);
  const cv::Mat lab = lab_of_points(points, types::view_image(scene, types::SceneCas::kColor), camera);
  return find_superpixels(points, cloud_normals(scene), lab, camera.depth, options);
}

/// Share of a cluster's points in a ball (map frame).
double share_inside(const std::vector<Vector3d>& points, const Vector3d& center, double radius) {
  if (points.empty()) return 0;
  size_t inside = 0;
  for (const Vector3d& point : points) inside += (point - center).norm() <= radius ? 1 : 0;
  return static_cast<double>(inside) / static_cast<double>(points.size());
}

}  // namespace

AnnotatorDescriptor SuperpixelExtractor::descriptor() const {
  return {"SuperpixelExtractor",
          "Parts the image into patches of about one size in space, of one colour and direction.",
          {"Scene", "CameraInfo", "view:color", "view:cloud", "view:normals"},
          {"view:superpixels"}};
}

void SuperpixelExtractor::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  types::set_view_image(scene, kSuperpixelsView, superpixels_of(scene, options_).labels);
}

AnnotatorDescriptor SaliencyDetector::descriptor() const {
  return {"SaliencyDetector",
          "Hypotheses from what stands out by its colour: balls in the map frame.",
          {"Scene", "CameraInfo", "view:color", "view:cloud", "view:normals"},
          {"TFLinkSphereROI", "view:saliency"},
          {"Cluster", "ReferenceClusterPoints"},
          {"Cluster"}};
}

void SaliencyDetector::declare(OptionTable& table) {
  superpixels_.declare(table);
  table.number("reach_m", reach_m_, "m", "What is nearer than this is what something stands out from.", 0.01,
               10);
  table.number("share", share_, "", "Parts this salient, relative to the peak, belong to it.", 0.05, 1);
  table.number("max_radius_m", max_radius_m_, "m", "Larger balls are left out.", 0.01, 10);
  table.integer("most", most_, "", "So many balls, the most salient ones.", 1, 1000);
}

void SaliencyDetector::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const Superpixels superpixels = superpixels_of(scene, superpixels_);
  const std::vector<double> values = saliency(superpixels, reach_m_);
  cv::Mat image = cv::Mat::zeros(superpixels.labels.size(), CV_8U);
  for (int i = 0; i < image.rows * image.cols; ++i)
    if (const int label = superpixels.labels.ptr<uint16_t>()[i]; label > 0)
      image.ptr<uint8_t>()[i] = static_cast<uint8_t>(255 * values[static_cast<size_t>(label - 1)]);
  types::set_view_image(scene, kSaliencyView, image);
  const Isometry3d pose = map_from_camera(scene.scene());
  for (const SalientBall& ball : salient_balls(superpixels, values, share_, 2.5 * superpixels_.radius_m,
                                               max_radius_m_, static_cast<size_t>(most_))) {
    const auto sphere = types::TFLinkSphereROI::create(cas);
    sphere.source.set("SaliencyDetector");
    sphere.tf_frame.set("map");
    const Vector3d center = pose * ball.center;
    sphere.center.set(types::to(cas, center));
    sphere.radius.set(ball.radius);
    sphere.add_to_index(kSaliencyView);
    for (const types::Cluster& cluster : scene.clusters())
      if (share_inside(cluster_points(scene, cluster), center, ball.radius) > 0.5)
        cluster.hypotheses.push_back(sphere);
  }
}

}  // namespace loci::perception
