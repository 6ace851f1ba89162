#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"

namespace loci::apps::segmentation_evaluation {

/// How PCL's methods are set.
struct PeerOptions {
  double plane_m = 0.01;
  double leaf_m = 0.005;
  double tolerance_m = 0.015;
  double voxel_m = 0.005;
  double seed_m = 0.02;
  double concavity_deg = 10;
  int min_points = 150;

  void declare(OptionTable& table);
};

/// What a method made of one image.
struct Segmentation {
  cv::Mat segments;  ///< CV_16U, 0 = none
  double seconds = 0;
};

/// One of PCL's ways to segment a table scene; one thread.
class Peer {
 public:
  virtual ~Peer() = default;
  /// `depth`: CV_32F, metres, NaN = none.
  virtual Segmentation segment(const cv::Mat& depth, const mapping::PinholeCamera& camera) = 0;
};

/// SACSegmentation removes the largest plane; what is above it goes through VoxelGrid and
/// EuclideanClusterExtraction.
std::unique_ptr<Peer> pcl_euclidean(const PeerOptions& options);

/// SupervoxelClustering and LCCPSegmentation of the whole image; segments that lie in the largest plane for
/// the most part are the table. With `above_plane` only what is above that plane is segmented. Extended
/// convexity and the sanity criterion keep objects apart from the table, and without one only tear them: each
/// way as it does best.
std::unique_ptr<Peer> pcl_lccp(const PeerOptions& options, bool above_plane);

}  // namespace loci::apps::segmentation_evaluation
