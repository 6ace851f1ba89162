#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/options.h"
#include "perception/annotators/segmentation/clustering/convex_parts.h"
#include "perception/annotators/segmentation/clustering/part_assembly.h"
#include "perception/annotators/segmentation/clustering/stack_splitting.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {

/// What counts as an object on a support.
struct ClusterOptions {
  double tolerance_m = 0.02;
  double floor_m = 0.005;
  double min_height_m = 0.02;
  double max_height_m = 0.6;
  double min_extent_m = 0.025;
  double max_extent_m = 0.7;
  int min_points = 150;
  int min_clear_points = 30;
  double resting_m = 0.04;
  double margin_m = 0.02;
  bool split = true;
  ConvexPartsOptions parts;
  AssemblyOptions assembly;
  StackOptions stacks;

  void declare(OptionTable& table);
};

/// The box around pixels (row · width + column) of a depth image.
cv::Rect box_of(const std::vector<int>& pixels, const cv::Size& image);
/// Whether the edge of the depth image, or what a Kinect leaves empty there, cuts it off.
bool is_at_image_border(const cv::Rect& box, const cv::Size& image);

/// One object on a support, as the pixels of the depth image that show it.
struct ObjectCluster {
  int support = 0;                   ///< index into the supports
  std::vector<int> pixels;           ///< row · width + column, ascending
  cv::Rect box;                      ///< around the pixels
  double bottom = 0;                 ///< lowest and
  double top = 0;                    ///< highest point over the support (2nd and 98th percentile), metres
  bool at_image_border = false;      ///< cut off by the edge of the image
  bool at_region_border = false;     ///< reaches over the edge of the support
  bool partly_hidden = false;        ///< something nearer covers a part of it
  double open = 0;                   ///< share of its outline across which its surface goes on in no object
  int stands_on = -1;                ///< index of the cluster below it; -1 = the support itself
  Vector2d low = Vector2d::Zero();   ///< corners of its footprint's box in the support's plane (2nd and
  Vector2d high = Vector2d::Zero();  ///< 98th percentile), metres
};

/// What clusters are found in. All but the colour image of one size.
struct ClusterImages {
  cv::Mat points;   ///< CV_32FC3, camera frame, metres, NaN = none
  cv::Mat normals;  ///< CV_32FC3, unit, camera frame
  cv::Mat region;   ///< CV_16U: which support's region of interest a pixel belongs to (SupportPlane::region);
                    ///< 0 = none, the pixel is left out. May be empty
  cv::Mat map_depth;   ///< CV_32F: what the map alone would measure, metres, NaN = nothing. May be empty
  cv::Mat color = {};  ///< CV_8UC3, BGR, of `color_camera`, which may have another size. May be empty
  mapping::PinholeCamera color_camera = {};
  Isometry3d color_from_depth = Isometry3d::Identity();
};

/// Leaves out the other clusters; `stands_on` follows, and is -1 where what it meant is left out.
void keep_only(const std::vector<bool>& keep, std::vector<ObjectCluster>& clusters);

/// Objects on supports: connected points above a plane, split where they are concave, put together again
/// where one object only looks like several, and cut where one stands upon another. Left out is what is not
/// an object: surfaces that go on beyond their outline in the surroundings, that protrude from a surface of
/// the map by no more than noise, or that nothing holds up. The same on any number of threads (0 = all
/// cores).
std::vector<ObjectCluster> extract_clusters(const ClusterImages& images, const mapping::PinholeCamera& camera,
                                            const std::vector<SupportPlane>& supports,
                                            const ClusterOptions& options, int threads = 1);

}  // namespace loci::perception
