#pragma once

#include <vtkActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <vector>

#include "gui/scene3d/scene_colors.h"
#include "mapping/base/pose.h"

namespace loci::gui {

/// Lines that explain what is seen: the way of the chosen object, from where all scenes were looked at, and
/// what is being measured. Map frame.
class GuideActors {
 public:
  explicit GuideActors(vtkRenderer* renderer);

  /// Where the object was, in the order of time.
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
