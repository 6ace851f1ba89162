#pragma once

#include <vtkActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <optional>

#include "gui/scene3d/colored_cloud.h"
#include "gui/scene3d/scene_colors.h"
#include "mapping/sensor/camera.h"

namespace loci {

/// What one frame measured and from where: its cloud and its camera.
class FrameActors {
 public:
  explicit FrameActors(vtkRenderer* renderer);

  void set_cloud(const ColoredCloud& cloud);
  /// The pyramid that the camera sees, to `range` metres.
  void set_camera(const PinholeCamera& camera, const Isometry3d& map_from_camera, double range,
                  const SceneColors& colors);
  void clear();
  void set_cloud_visible(bool visible);
  void set_camera_visible(bool visible);
  /// Pixels; also for clouds that come later.
  void set_point_size(double size);
  double point_size() const { return point_size_; }
  size_t point_count() const { return point_count_; }
  /// Around points and camera, map frame; empty when there are none.
  Eigen::AlignedBox3d bounds() const { return cloud_box_.merged(camera_box_); }

 private:
  vtkSmartPointer<vtkActor> cloud_, frustum_;
  double point_size_ = 2;
  size_t point_count_ = 0;
  Eigen::AlignedBox3d cloud_box_, camera_box_;
  bool cloud_visible_ = true, camera_visible_ = true, has_camera_ = false;
};

}  // namespace loci
