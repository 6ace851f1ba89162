#include "apps/evaluate/segmentation/peers.h"

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/lccp_segmentation.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <pcl/segmentation/supervoxel_clustering.h>

#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "mapping/base/stopwatch.h"

namespace loci::apps::segmentation_evaluation {
namespace {

using Point = pcl::PointXYZRGBA;
using Cloud = pcl::PointCloud<Point>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Cloud::Ptr cloud_of(const cv::Mat& depth, const mapping::PinholeCamera& camera) {
  Cloud::Ptr cloud(new Cloud(static_cast<uint32_t>(depth.cols), static_cast<uint32_t>(depth.rows)));
  cloud->is_dense = false;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      Point& p = cloud->at(u, v);
      p.x = p.y = p.z = kNan;
      if (!(z > 0)) continue;
      const Vector3d at = camera.unproject(u, v, static_cast<double>(z));
      p.x = static_cast<float>(at.x());
      p.y = static_cast<float>(at.y());
      p.z = z;
    }
  return cloud;
}

/// Signed height of every pixel over the largest plane, towards the camera; NaN without depth.
std::vector<float> heights_over_plane(const Cloud::Ptr& cloud, double threshold) {
  Cloud::Ptr finite(new Cloud);
  for (const Point& p : *cloud)
    if (!std::isnan(p.z)) finite->push_back(p);
  std::vector<float> heights(cloud->size(), kNan);
  if (finite->size() < 3) return heights;
  pcl::SACSegmentation<Point> method;
  method.setOptimizeCoefficients(true);
  method.setModelType(pcl::SACMODEL_PLANE);
  method.setMethodType(pcl::SAC_RANSAC);
  method.setMaxIterations(500);
  method.setDistanceThreshold(threshold);
  method.setInputCloud(finite);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  method.segment(inliers, plane);
  if (plane.values.size() != 4) return heights;
  const float sign = plane.values[3] < 0 ? -1.0f : 1.0f;
  for (size_t i = 0; i < cloud->size(); ++i) {
    const Point& p = (*cloud)[i];
    heights[i] =
        sign * (plane.values[0] * p.x + plane.values[1] * p.y + plane.values[2] * p.z + plane.values[3]);
  }
  return heights;
}

class Euclidean : public Peer {
 public:
  explicit Euclidean(const PeerOptions& options) : options_(options) {}

  Segmentation segment(const cv::Mat& depth, const mapping::PinholeCamera& camera) override {
    const Cloud::Ptr cloud = cloud_of(depth, camera);
    const Stopwatch watch;
    const std::vector<float> heights = heights_over_plane(cloud, options_.plane_m);
    Cloud::Ptr above(new Cloud);
    std::vector<int> pixels;
    for (size_t i = 0; i < cloud->size(); ++i)
      if (static_cast<double>(heights[i]) > options_.plane_m) {
        above->push_back((*cloud)[i]);
        pixels.push_back(static_cast<int>(i));
      }
    Segmentation result{cv::Mat::zeros(depth.size(), CV_16U), 0};
    if (!above->empty()) cluster(above, pixels, result.segments);
    result.seconds = watch.seconds();
    return result;
  }

 private:
  void cluster(const Cloud::Ptr& above, const std::vector<int>& pixels, cv::Mat& segments) const {
    pcl::VoxelGrid<Point> grid;
    const auto leaf = static_cast<float>(options_.leaf_m);
    grid.setLeafSize(leaf, leaf, leaf);
    grid.setSaveLeafLayout(true);
    grid.setInputCloud(above);
    Cloud::Ptr thinned(new Cloud);
    grid.filter(*thinned);
    pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
    tree->setInputCloud(thinned);
    pcl::EuclideanClusterExtraction<Point> method;
    method.setClusterTolerance(options_.tolerance_m);
    method.setSearchMethod(tree);
    method.setInputCloud(thinned);
    std::vector<pcl::PointIndices> clusters;
    method.extract(clusters);
    std::vector<uint16_t> number(thinned->size(), 0);
    for (size_t c = 0; c < clusters.size(); ++c)
      for (const int index : clusters[c].indices)
        number[static_cast<size_t>(index)] = static_cast<uint16_t>(c + 1);
    std::vector<int> count(clusters.size() + 1, 0);
    std::vector<uint16_t> own(pixels.size(), 0);
    for (size_t i = 0; i < pixels.size(); ++i) {
      const int voxel = grid.getCentroidIndex((*above)[i]);
      if (voxel >= 0) own[i] = number[static_cast<size_t>(voxel)];
      ++count[own[i]];
    }
    for (size_t i = 0; i < pixels.size(); ++i)
      if (count[own[i]] >= options_.min_points) segments.ptr<uint16_t>()[pixels[i]] = own[i];
  }

  PeerOptions options_;
};

class Lccp : public Peer {
 public:
  Lccp(const PeerOptions& options, bool above_plane) : options_(options), above_plane_(above_plane) {}

  Segmentation segment(const cv::Mat& depth, const mapping::PinholeCamera& camera) override {
    const Cloud::Ptr cloud = cloud_of(depth, camera);
    const Stopwatch watch;
    const std::vector<float> heights = heights_over_plane(cloud, options_.plane_m);
    if (above_plane_)
      for (size_t i = 0; i < cloud->size(); ++i)
        if (!(static_cast<double>(heights[i]) > options_.plane_m))
          (*cloud)[i].x = (*cloud)[i].y = (*cloud)[i].z = kNan;
    const pcl::PointCloud<pcl::PointXYZL>::Ptr labels = labels_of(cloud);
    Segmentation result{without_table(*labels, *cloud, heights, depth.size()), 0};
    result.seconds = watch.seconds();
    return result;
  }

 private:
  pcl::PointCloud<pcl::PointXYZL>::Ptr labels_of(const Cloud::Ptr& cloud) const {
    const auto voxel = static_cast<float>(options_.voxel_m);
    const auto seed = static_cast<float>(options_.seed_m);
    pcl::SupervoxelClustering<Point> supervoxels(voxel, seed);
    supervoxels.setUseSingleCameraTransform(false);
    supervoxels.setInputCloud(cloud);
    supervoxels.setColorImportance(0);
    supervoxels.setSpatialImportance(1);
    supervoxels.setNormalImportance(4);
    std::map<uint32_t, pcl::Supervoxel<Point>::Ptr> patches;
    supervoxels.extract(patches);
    std::multimap<uint32_t, uint32_t> adjacency;
    supervoxels.getSupervoxelAdjacency(adjacency);
    pcl::LCCPSegmentation<Point> method;
    method.setConcavityToleranceThreshold(static_cast<float>(options_.concavity_deg));
    method.setSanityCheck(!above_plane_);
    method.setKFactor(above_plane_ ? 0 : 1);
    method.setSmoothnessCheck(true, voxel, seed, 0.1f);
    method.setMinSegmentSize(3);
    method.setInputSupervoxels(patches, adjacency);
    method.segment();
    pcl::PointCloud<pcl::PointXYZL>::Ptr labels = supervoxels.getLabeledCloud();
    method.relabelCloud(*labels);
    return labels;
  }

  cv::Mat without_table(const pcl::PointCloud<pcl::PointXYZL>& labels, const Cloud& cloud,
                        const std::vector<float>& heights, const cv::Size& size) const {
    struct Count {
      int all = 0;
      int low = 0;
    };
    std::map<uint32_t, Count> counts;
    for (size_t i = 0; i < labels.size(); ++i) {
      if (labels[i].label == 0 || std::isnan(cloud[i].z)) continue;
      Count& count = counts[labels[i].label];
      ++count.all;
      count.low += static_cast<double>(std::abs(heights[i])) <= options_.plane_m ? 1 : 0;
    }
    std::map<uint32_t, uint16_t> number;
    for (const auto& [label, count] : counts)
      if (count.all >= options_.min_points && 2 * count.low < count.all)
        number.emplace(label, static_cast<uint16_t>(number.size() + 1));
    cv::Mat segments = cv::Mat::zeros(size, CV_16U);
    for (size_t i = 0; i < labels.size(); ++i)
      if (const auto it = number.find(labels[i].label); it != number.end() && !std::isnan(cloud[i].z))
        segments.ptr<uint16_t>()[i] = it->second;
    return segments;
  }

  PeerOptions options_;
  bool above_plane_;
};

}  // namespace

void PeerOptions::declare(OptionTable& table) {
  table.number("pcl_plane_m", plane_m, "m", "PCL: points this near to the largest plane are the table.",
               0.001, 0.1);
  table.number("pcl_leaf_m", leaf_m, "m", "PCL EuclideanClusterExtraction: voxels before it.", 0.001, 0.1);
  table.number("pcl_tolerance_m", tolerance_m, "m", "PCL EuclideanClusterExtraction: largest gap.", 0.001,
               0.1);
  table.number("pcl_voxel_m", voxel_m, "m", "PCL LCCP: voxels.", 0.001, 0.1);
  table.number("pcl_seed_m", seed_m, "m", "PCL LCCP: supervoxels.", 0.002, 0.5);
  table.number("pcl_concavity_deg", concavity_deg, "deg", "PCL LCCP: tolerated concavity.", 0, 90);
  table.integer("pcl_min_points", min_points, "px", "PCL: smaller segments are left out.", 1, 100000);
}

std::unique_ptr<Peer> pcl_euclidean(const PeerOptions& options) {
  return std::make_unique<Euclidean>(options);
}

std::unique_ptr<Peer> pcl_lccp(const PeerOptions& options, bool above_plane) {
  return std::make_unique<Lccp>(options, above_plane);
}

}  // namespace loci::apps::segmentation_evaluation
