#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/sensor/camera.h"
#include "mapping/world/mesh.h"

namespace loci::apps::filter_evaluation {

/// The same image by Embree: single rays into a tree of instances, on the calling thread.
class InstanceRays {
 public:
  /// Instance i is mesh i modulo the number of meshes. The tree is built on one thread.
  InstanceRays(const std::vector<mapping::TriangleMesh>& meshes,
               const std::vector<Isometry3d>& camera_from_instances);
  ~InstanceRays();
  InstanceRays(const InstanceRays&) = delete;
  InstanceRays& operator=(const InstanceRays&) = delete;

  /// z-depth, CV_32F, NaN = nothing.
  cv::Mat depth(const mapping::PinholeCamera& camera) const;
  /// What the tree over the instances took, without those of the meshes.
  double tree_seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::apps::filter_evaluation
