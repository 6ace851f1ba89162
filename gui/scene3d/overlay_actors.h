#pragma once

#include <vtkActor.h>
#include <vtkPlane.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <optional>
#include <vector>

#include "gui/core/colored_cloud.h"
#include "gui/scene3d/scene_colors.h"
#include "mapping/base/math/pose.h"
#include "mapping/sensor/camera.h"
#include "mapping/sensor/colored_mesh.h"

namespace loci::gui {

/// What one frame measured and from where: its cloud and its camera.
class FrameActors {
 public:
  explicit FrameActors(vtkRenderer* renderer);

  void set_cloud(const ColoredCloud& cloud);
  /// The pyramid that the camera sees, to `range` metres.
  void set_camera(const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera, double range,
                  const SceneColors& colors);
  void clear();
  void set_cloud_visible(bool visible);
  void set_camera_visible(bool visible);
  /// Pixels; also for clouds that come later.
  void set_point_size(double size);
  double point_size() const { return point_size_; }
  /// How many pixels of the screen one of the window has.
  void set_pixels(double pixels);
  size_t point_count() const { return point_count_; }
  /// Cuts away the points behind a plane; nullptr = none.
  void set_section(vtkPlane* plane);
  /// The point of the cloud nearest to the eye within `reach` pixels of a pixel (from the lower left corner);
  /// unset when there is none.
  std::optional<Vector3d> point_near(vtkRenderer& renderer, double x, double y, double reach) const;
  /// Around points and camera, map frame; empty when there are none.
  Eigen::AlignedBox3d bounds() const { return cloud_box_.merged(camera_box_); }

 private:
  vtkSmartPointer<vtkActor> cloud_, frustum_;
  vtkSmartPointer<vtkPlane> section_;  ///< null = none
  double point_size_ = 2, pixels_ = 1;
  size_t point_count_ = 0;
  Eigen::AlignedBox3d cloud_box_, camera_box_;
  bool cloud_visible_ = true, camera_visible_ = true, has_camera_ = false;
};

/// The room as a depth camera saw it.
class RoomActor {
 public:
  explicit RoomActor(vtkRenderer* renderer);

  void set_mesh(const mapping::ColoredMesh& mesh);
  void set_visible(bool visible);
  void set_section(vtkPlane* plane);
  Eigen::AlignedBox3d bounds() const { return box_; }

 private:
  vtkSmartPointer<vtkActor> actor_;
  Eigen::AlignedBox3d box_;
};

/// Lines that explain what is seen: the trajectory of the selected object, the cameras of all scenes, and the
/// ruler. Map frame.
class GuideActors {
 public:
  explicit GuideActors(vtkRenderer* renderer);

  /// Where the object was, in order of time.
  void set_trace(std::vector<Vector3d> points);
  /// Poses map_from_camera, drawn as pyramids of `size` metres.
  void set_cameras(const std::vector<Isometry3d>& cameras, double size);
  /// Up to two points and the line between them.
  void set_ruler(const std::vector<Vector3d>& points);
  void set_colors(const SceneColors& colors);
  void set_trace_visible(bool visible);
  void set_cameras_visible(bool visible);
  const std::vector<Vector3d>& trace() const { return trace_points_; }
  /// Around what is shown; empty when nothing is.
  Eigen::AlignedBox3d bounds() const;

 private:
  struct Lines {
    vtkSmartPointer<vtkActor> actor;
    Eigen::AlignedBox3d box;
    bool wanted = true;
  };
  static void refresh(const Lines& lines);

  std::vector<Vector3d> trace_points_;
  Lines trace_, cameras_, ruler_;
};

}  // namespace loci::gui
