#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/sensor/camera.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/pipeline/annotator.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Where an object is in the colour image.
struct ColorRegion {
  cv::Rect box;  ///< in the colour image; empty when the object falls outside it
  cv::Mat mask;  ///< CV_8U, of the box's size: 255 = object
};

/// Projects pixels of the depth image (indices row · width + column into `points`, CV_32FC3 in the camera
/// frame) through the registration of the two cameras into a colour image of `size`, and closes the gaps
/// between them.
ColorRegion color_region(const cv::Mat& points, const std::vector<int>& pixels,
                         const mapping::RgbdCamera& camera, const cv::Size& size);

// What every expert that finds clusters puts into them.

/// The cluster's points as indices into the scene's cloud (row · width + column), and its centroid from them.
/// `pose` = map_from_camera.
void set_points(const types::Cluster& cluster, const std::string& source, const std::vector<int>& pixels,
                const types::SceneCas& scene, const Isometry3d& pose);

/// Its image, cut out of the colour view with its mask. Nothing where it lies outside that view.
void add_image(const types::Cluster& cluster, const std::string& source, const ColorRegion& region,
               const types::SceneCas& scene);

/// Supporting planes and the objects that stand on them (§4.3). With regions of interest (from
/// KnownStructureFilter) a support is the region's surface, refined on what the frame shows; without, all
/// horizontal planes of the frame are supports, as yet without names.
class PlaneClusterExtractor : public Annotator {
 public:
  static constexpr const char* kName = "PlaneClusterExtractor";
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  SupportOptions support_options_;
  ClusterOptions cluster_options_;
};

}  // namespace loci::perception
