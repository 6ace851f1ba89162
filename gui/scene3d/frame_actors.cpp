#include "gui/scene3d/frame_actors.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <vtkRenderWindow.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "gui/scene3d/vtk_convert.h"

namespace loci::gui {
namespace {

constexpr double kLineWidth = 1.5;

vtkSmartPointer<vtkActor> empty_actor(vtkRenderer* renderer) {
  auto actor = vtkSmartPointer<vtkActor>::New();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(vtkNew<vtkPolyData>());
  mapper->SetStatic(1);
  // What was measured on a surface of the map is drawn before it, not through it.
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyPointOffsetParameter(-30);
  actor->SetMapper(mapper);
  actor->PickableOff();
  actor->GetProperty()->SetLighting(false);
  renderer->AddActor(actor);
  return actor;
}

void show(vtkActor& actor, vtkPolyData* data) {
  static_cast<vtkPolyDataMapper*>(actor.GetMapper())->SetInputData(data);
}

}  // namespace

FrameActors::FrameActors(vtkRenderer* renderer)
    : cloud_(empty_actor(renderer)), frustum_(empty_actor(renderer)) {
  clear();
  set_pixels(1);
}

void FrameActors::clear() {
  set_cloud({});
  has_camera_ = false;
  camera_box_ = {};
  frustum_->SetVisibility(false);
}

void FrameActors::set_cloud(const ColoredCloud& cloud) {
  cloud_box_ = {};
  for (const Eigen::Vector3f& point : cloud.points) cloud_box_.extend(point.cast<double>());
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(static_cast<vtkIdType>(cloud.points.size()));
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  colors->SetNumberOfTuples(points->GetNumberOfPoints());
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    points->SetPoint(static_cast<vtkIdType>(i), cloud.points[i].cast<double>().eval().data());
    colors->SetTypedTuple(static_cast<vtkIdType>(i), cloud.colors[i].data());
  }
  std::vector<vtkIdType> ids(cloud.points.size());
  std::iota(ids.begin(), ids.end(), 0);
  vtkNew<vtkCellArray> cells;
  if (!ids.empty()) cells->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetVerts(cells);
  data->GetPointData()->SetScalars(colors);
  show(*cloud_, data);
  point_count_ = cloud.points.size();
  set_point_size(point_size_);
  set_cloud_visible(cloud_visible_);
}

void FrameActors::set_camera(const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera,
                             double range, const SceneColors& colors) {
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(map_from_camera.translation().data());
  const std::array<Vector2d, 4> corners = {Vector2d(0, 0), Vector2d(camera.width, 0),
                                           Vector2d(camera.width, camera.height), Vector2d(0, camera.height)};
  camera_box_ = Eigen::AlignedBox3d(map_from_camera.translation());
  for (const Vector2d& corner : corners) {
    const Vector3d point = map_from_camera * camera.unproject(corner.x(), corner.y(), range);
    points->InsertNextPoint(point.data());
    camera_box_.extend(point);
  }
  vtkNew<vtkCellArray> lines;
  for (vtkIdType i = 0; i < 4; ++i) {
    const std::array<vtkIdType, 3> side = {0, 1 + i, 1 + (i + 1) % 4};
    lines->InsertNextCell(3, side.data());
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(lines);
  show(*frustum_, data);
  set_color(*frustum_->GetProperty(), colors.frustum);
  has_camera_ = true;
  set_camera_visible(camera_visible_);
}

void FrameActors::set_cloud_visible(bool visible) {
  cloud_visible_ = visible;
  cloud_->SetVisibility(visible && point_count_ > 0);
}

void FrameActors::set_camera_visible(bool visible) {
  camera_visible_ = visible;
  frustum_->SetVisibility(visible && has_camera_);
}

void FrameActors::set_section(vtkPlane* plane) {
  section_ = plane;
  cloud_->GetMapper()->RemoveAllClippingPlanes();
  if (plane != nullptr) cloud_->GetMapper()->AddClippingPlane(plane);
}

std::optional<Vector3d> FrameActors::point_near(vtkRenderer& renderer, double x, double y,
                                                double reach) const {
  if (cloud_->GetVisibility() == 0) return std::nullopt;
  const int* size = renderer.GetRenderWindow()->GetSize();
  const double width = std::max(1, size[0]), height = std::max(1, size[1]);
  const vtkMatrix4x4* matrix =
      renderer.GetActiveCamera()->GetCompositeProjectionTransformMatrix(width / height, -1, 1);
  const Eigen::Matrix4d view_from_map =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix->GetData());
  vtkPoints* points = vtkPolyData::SafeDownCast(cloud_->GetMapper()->GetInput())->GetPoints();
  std::optional<Vector3d> nearest;
  double least = 2;  // depths are from -1 to 1
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i) {
    const Vector3d point(points->GetPoint(i));
    const Eigen::Vector4d seen = view_from_map * point.homogeneous();
    const Vector3d at = seen.hnormalized();
    const double dx = (at.x() + 1) / 2 * width - x, dy = (at.y() + 1) / 2 * height - y;
    if (seen.w() <= 0 || at.z() >= least || dx * dx + dy * dy > reach * reach) continue;
    if (section_ != nullptr && section_->EvaluateFunction(point.x(), point.y(), point.z()) < 0) continue;
    least = at.z();
    nearest = point;
  }
  return nearest;
}

void FrameActors::set_point_size(double size) {
  point_size_ = size;
  cloud_->GetProperty()->SetPointSize(static_cast<float>(size * pixels_));
}

void FrameActors::set_pixels(double pixels) {
  pixels_ = pixels;
  set_point_size(point_size_);
  frustum_->GetProperty()->SetLineWidth(static_cast<float>(kLineWidth * pixels));
}

}  // namespace loci::gui
