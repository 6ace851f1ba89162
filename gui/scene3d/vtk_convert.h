#pragma once

#include <vtkMatrix4x4.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <vector>

#include "gui/scene3d/scene_colors.h"
#include "mapping/base/math/pose.h"
#include "mapping/world/mesh.h"

class vtkProperty;

namespace loci::gui {

/// Triangles with the pose and colour that they are drawn with.
struct MeshPart {
  mapping::TriangleMesh mesh;
  Isometry3d target_from_mesh = Isometry3d::Identity();
  mapping::Rgba color = {0.7F, 0.7F, 0.7F, 1};  ///< of triangles that bring none
};

/// All parts in one frame, with one RGBA value per triangle.
vtkSmartPointer<vtkPolyData> surface_of(const std::vector<MeshPart>& parts);

/// The edges at which a surface bends by more than 30 degrees or ends; what makes boxes readable.
vtkSmartPointer<vtkPolyData> sharp_edges_of(const std::vector<MeshPart>& parts);

/// A flat outline (x, y) at a height, filled, and its closed edge.
vtkSmartPointer<vtkPolyData> area_of(const std::vector<Vector2d>& outline, double height);
vtkSmartPointer<vtkPolyData> loop_of(const std::vector<Vector2d>& outline, double height);

void set_color(vtkProperty& property, const SceneColor& color);

vtkSmartPointer<vtkMatrix4x4> matrix_of(const Isometry3d& pose);

}  // namespace loci::gui
