#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {

/// Everything that stands over one support, before it is taken apart.
struct Standing {
  std::vector<int> pixels;
  std::vector<Eigen::Vector3f> points;    ///< camera frame
  std::vector<Eigen::Vector3f> normals;   ///< camera frame
  std::vector<Eigen::Vector3f> in_plane;  ///< z = height over the support
  std::vector<Eigen::Vector3f> normals_in_plane;
  std::vector<float> areas;  ///< of a pixel on the surface, m²

  void add(const Standing& other, size_t i) {
    pixels.push_back(other.pixels[i]);
    points.push_back(other.points[i]);
    normals.push_back(other.normals[i]);
    in_plane.push_back(other.in_plane[i]);
    normals_in_plane.push_back(other.normals_in_plane[i]);
    areas.push_back(other.areas[i]);
  }
  void reserve(size_t count) {
    pixels.reserve(count);
    areas.reserve(count);
    for (auto* each : {&points, &normals, &in_plane, &normals_in_plane}) each->reserve(count);
  }
};

/// A support made ready to be asked about many points.
struct SupportGround {
  const SupportPlane& plane;
  PolygonOutline outline;
  Eigen::Matrix3f plane_from_camera;     ///< rotation
  std::optional<Eigen::Vector3f> color;  ///< of a support whose height is uncertain, CIE Lab; unset = unknown

  explicit SupportGround(const SupportPlane& support)
      : plane(support),
        outline(support.outline),
        plane_from_camera(support.camera_from_plane.linear().transpose().cast<float>()) {}
};

/// What a pixel shows, as the outlines of objects are judged by it.
enum class Shows : uint8_t { nothing, support, candidate, surroundings };

/// Gives every pixel to the highest support below it. `shows`: CV_8U, Shows of every pixel. The same on any
/// number of threads.
std::vector<Standing> stand_on_supports(const ClusterImages& images, const mapping::PinholeCamera& camera,
                                        const std::vector<SupportGround>& grounds,
                                        const ClusterOptions& options, int threads, cv::Mat& shows);

Standing subset(const Standing& all, const std::vector<size_t>& members);

/// Gives back to a support the single pixels that the noise of the depth lifts off it (one in fifteen): on
/// what stands as low, half of them and more are lifted.
void drop_specks(Standing& standing, const SupportPlane& support, const ClusterOptions& options,
                 cv::Mat& shows);

/// Colours of points (camera frame), CIE Lab in 8 bits; empty without a colour image.
std::vector<cv::Vec3b> lab_colors(const std::vector<Eigen::Vector3f>& points, const ClusterImages& images);

/// The colour of a support as far as it is in view: what is not measured there, or lies in its plane. Unset
/// without a colour image, or where little of it is seen.
std::optional<Eigen::Vector3f> color_of_support(const SupportGround& ground, const ClusterImages& images,
                                                const mapping::PinholeCamera& camera);

/// Gives back to a support of uncertain height what is little higher and has its colour.
void drop_like_support(Standing& standing, const SupportGround& ground, const ClusterOptions& options,
                       const ClusterImages& images, cv::Mat& shows);

}  // namespace loci::perception
