#include "gui/scene3d/overlay_actors.h"

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
#include <vtkRenderWindow.h>
#include <vtkUnsignedCharArray.h>
#include <algorithm>
#include <array>
#include <numeric>

#include "gui/scene3d/vtk_convert.h"

namespace loci::gui {
namespace {

constexpr double kFrustumWidth = 1.5;  // pixels
constexpr double kAspect = 0.75;       // of a camera's image

/// An actor whose points are drawn before a coincident surface of the map, by so many units of depth.
vtkSmartPointer<vtkActor> overlay_actor(vtkRenderer* renderer, double units) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(vtkNew<vtkPolyData>());
  mapper->SetStatic(1);
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyPointOffsetParameter(-units);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->PickableOff();
  actor->GetProperty()->SetLighting(false);
  renderer->AddActor(actor);
  return actor;
}

/// The same for lines; hidden until it has some.
vtkSmartPointer<vtkActor> line_actor(vtkRenderer* renderer) {
  auto actor = overlay_actor(renderer, 60);
  actor->GetMapper()->SetRelativeCoincidentTopologyLineOffsetParameters(-4, -60);
  actor->SetVisibility(false);
  return actor;
}

void show(vtkActor& actor, vtkPolyData* data) {
  static_cast<vtkPolyDataMapper*>(actor.GetMapper())->SetInputData(data);
}

/// One cell of all points, in order.
vtkSmartPointer<vtkCellArray> cell_of(size_t count, size_t min_count) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  std::vector<vtkIdType> ids(count);
  std::iota(ids.begin(), ids.end(), 0);
  if (count >= min_count) cells->InsertNextCell(static_cast<vtkIdType>(count), ids.data());
  return cells;
}

/// A line through all points, and each of them.
vtkSmartPointer<vtkPolyData> path_of(const std::vector<Vector3d>& path) {
  vtkNew<vtkPoints> points;
  for (const Vector3d& point : path) points->InsertNextPoint(point.data());
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(cell_of(path.size(), 2));
  data->SetVerts(cell_of(path.size(), 1));
  return data;
}

/// Lines from camera centres to the corners of what they see.
class Pyramids {
 public:
  void add(const Vector3d& eye, const std::array<Vector3d, 4>& corners) {
    const vtkIdType first = points_->InsertNextPoint(eye.data());
    for (const Vector3d& corner : corners) points_->InsertNextPoint(corner.data());
    for (vtkIdType i = 0; i < 4; ++i) {
      const std::array<vtkIdType, 3> side = {first, first + 1 + i, first + 1 + (i + 1) % 4};
      lines_->InsertNextCell(3, side.data());
    }
  }
  void show_as(vtkActor& actor) const {
    vtkNew<vtkPolyData> data;
    data->SetPoints(points_);
    data->SetLines(lines_);
    show(actor, data);
  }

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> lines_;
};

Eigen::AlignedBox3d box_around(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points) box.extend(point);
  return box;
}

}  // namespace

FrameActors::FrameActors(vtkRenderer* renderer)
    : cloud_(overlay_actor(renderer, 30)), frustum_(overlay_actor(renderer, 30)) {
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
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetVerts(cell_of(cloud.points.size(), 1));
  data->GetPointData()->SetScalars(colors);
  show(*cloud_, data);
  point_count_ = cloud.points.size();
  set_point_size(point_size_);
  set_cloud_visible(cloud_visible_);
}

void FrameActors::set_camera(const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera,
                             double range, const SceneColors& colors) {
  const Vector3d eye = map_from_camera.translation();
  const auto corner = [&](double x, double y) -> Vector3d {
    return map_from_camera * camera.unproject(x, y, range);
  };
  const std::array<Vector3d, 4> corners = {corner(0, 0), corner(camera.width, 0),
                                           corner(camera.width, camera.height), corner(0, camera.height)};
  camera_box_ = Eigen::AlignedBox3d(eye);
  for (const Vector3d& point : corners) camera_box_.extend(point);
  Pyramids pyramid;
  pyramid.add(eye, corners);
  pyramid.show_as(*frustum_);
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
  frustum_->GetProperty()->SetLineWidth(static_cast<float>(kFrustumWidth * pixels));
}

// ---- Room.

RoomActor::RoomActor(vtkRenderer* renderer) : actor_(vtkSmartPointer<vtkActor>::New()) {
  actor_->SetMapper(vtkNew<vtkPolyDataMapper>());
  actor_->PickableOff();
  actor_->GetProperty()->SetLighting(false);
  actor_->SetVisibility(false);
  renderer->AddActor(actor_);
}

void RoomActor::set_mesh(const mapping::ColoredMesh& mesh) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  box_.setEmpty();
  for (const Eigen::Vector3f& position : mesh.positions) {
    points->InsertNextPoint(position.data());
    box_.extend(position.cast<double>());
  }
  for (const auto& color : mesh.colors) colors->InsertNextTypedTuple(color.data());
  vtkNew<vtkCellArray> cells;
  for (const auto& triangle : mesh.triangles) cells->InsertNextCell({triangle[0], triangle[1], triangle[2]});
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetPointData()->SetScalars(colors);
  show(*actor_, data);
}

void RoomActor::set_visible(bool visible) {
  actor_->SetVisibility(visible && !box_.isEmpty());
}

void RoomActor::set_section(vtkPlane* plane) {
  actor_->GetMapper()->RemoveAllClippingPlanes();
  if (plane != nullptr) actor_->GetMapper()->AddClippingPlane(plane);
}

// ---- Guides.

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
  trace_.box = box_around(trace_points_);
  refresh(trace_);
}

void GuideActors::set_cameras(const std::vector<Isometry3d>& cameras, double size) {
  Pyramids pyramids;
  cameras_.box = {};
  for (const Isometry3d& camera : cameras) {
    const auto corner = [&](double x, double y) -> Vector3d {
      return camera * (size * Vector3d(0.5 * x, 0.5 * kAspect * y, 1));
    };
    pyramids.add(camera.translation(), {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)});
    cameras_.box.extend(camera.translation());
  }
  pyramids.show_as(*cameras_.actor);
  refresh(cameras_);
}

void GuideActors::set_ruler(const std::vector<Vector3d>& points) {
  show(*ruler_.actor, path_of(points));
  ruler_.box = box_around(points);
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
