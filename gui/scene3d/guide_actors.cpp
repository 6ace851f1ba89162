#include "gui/scene3d/guide_actors.h"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <numeric>

#include "gui/scene3d/vtk_convert.h"

namespace loci::gui {
namespace {

constexpr double kAspect = 0.75;  // of a camera's image

vtkSmartPointer<vtkActor> line_actor(vtkRenderer* renderer) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(vtkNew<vtkPolyData>());
  mapper->SetStatic(1);
  // Lines that lie on a surface are drawn before it.
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyLineOffsetParameters(-4, -60);
  mapper->SetRelativeCoincidentTopologyPointOffsetParameter(-60);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->PickableOff();
  actor->GetProperty()->SetLighting(false);
  actor->SetVisibility(false);
  renderer->AddActor(actor);
  return actor;
}

/// A line through all points, and each of them.
vtkSmartPointer<vtkPolyData> path_of(const std::vector<Vector3d>& path) {
  vtkNew<vtkPoints> points;
  for (const Vector3d& point : path) points->InsertNextPoint(point.data());
  std::vector<vtkIdType> ids(path.size());
  std::iota(ids.begin(), ids.end(), 0);
  vtkNew<vtkCellArray> line, dots;
  if (ids.size() > 1) line->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  if (!ids.empty()) dots->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(line);
  data->SetVerts(dots);
  return data;
}

vtkSmartPointer<vtkPolyData> pyramids_of(const std::vector<Isometry3d>& cameras, double size) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  for (const Isometry3d& camera : cameras) {
    const vtkIdType eye = points->InsertNextPoint(camera.translation().data());
    for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
      const Vector3d corner = camera * (size * Vector3d(0.5 * x, 0.5 * kAspect * y, 1));
      points->InsertNextPoint(corner.data());
    }
    for (vtkIdType i = 0; i < 4; ++i) {
      const std::array<vtkIdType, 3> side = {eye, eye + 1 + i, eye + 1 + (i + 1) % 4};
      lines->InsertNextCell(3, side.data());
    }
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(lines);
  return data;
}

Eigen::AlignedBox3d box_of(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points) box.extend(point);
  return box;
}

void show(vtkActor& actor, vtkPolyData* data) {
  static_cast<vtkPolyDataMapper*>(actor.GetMapper())->SetInputData(data);
}

}  // namespace

GuideActors::GuideActors(vtkRenderer* renderer) {
  trace_.actor = line_actor(renderer);
  cameras_.actor = line_actor(renderer);
  ruler_.actor = line_actor(renderer);
  cameras_.wanted = false;
}

void GuideActors::refresh(const Lines& lines) {
  lines.actor->SetVisibility(lines.wanted && !lines.box.isEmpty());
}

void GuideActors::set_trace(std::vector<Vector3d> points) {
  trace_points_ = std::move(points);
  show(*trace_.actor, path_of(trace_points_));
  trace_.box = box_of(trace_points_);
  refresh(trace_);
}

void GuideActors::set_cameras(const std::vector<Isometry3d>& cameras, double size) {
  show(*cameras_.actor, pyramids_of(cameras, size));
  cameras_.box = {};
  for (const Isometry3d& camera : cameras) cameras_.box.extend(camera.translation());
  refresh(cameras_);
}

void GuideActors::set_ruler(const std::vector<Vector3d>& points) {
  show(*ruler_.actor, path_of(points));
  ruler_.box = box_of(points);
  refresh(ruler_);
}

void GuideActors::set_colors(const SceneColors& colors) {
  const auto paint = [&](vtkActor& actor, const SceneColor& color, double width) {
    set_color(*actor.GetProperty(), color);
    actor.GetProperty()->SetLineWidth(static_cast<float>(width * colors.pixels));
    actor.GetProperty()->SetPointSize(static_cast<float>(3 * width * colors.pixels));
  };
  paint(*trace_.actor, colors.accent, 2.5);
  paint(*cameras_.actor, colors.frustum, 1);
  paint(*ruler_.actor, colors.ruler, 3);
}

void GuideActors::set_trace_visible(bool visible) {
  trace_.wanted = visible;
  refresh(trace_);
}

void GuideActors::set_cameras_visible(bool visible) {
  cameras_.wanted = visible;
  refresh(cameras_);
}

Eigen::AlignedBox3d GuideActors::bounds() const {
  Eigen::AlignedBox3d all;
  for (const Lines* lines : {&trace_, &cameras_, &ruler_})
    if (lines->actor->GetVisibility() != 0) all.extend(lines->box);
  return all;
}

}  // namespace loci::gui
