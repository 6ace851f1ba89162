#include "gui/scene3d/object_actors.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gui/scene3d/vtk_convert.h"

namespace loci::gui {
namespace {

/// Nothing is drawn thinner than this, so that flat and unmeasured objects can be seen and clicked.
constexpr double kMinSize = 0.01;
constexpr vtkIdType kFaces = 6, kEdges = 12;
// Corner i has bit 0 for x, 1 for y, 2 for z.
constexpr std::array<std::array<vtkIdType, 4>, kFaces> kFaceCorners = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
constexpr std::array<std::array<vtkIdType, 2>, kEdges> kEdgeCorners = {
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

using Color4 = std::array<unsigned char, 4>;

Vector3d corner_of(const MapObject& object, int i) {
  const Vector3d half = object.size.cwiseMax(kMinSize) / 2;
  return object.map_from_object *
         Vector3d(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(), i & 4 ? half.z() : -half.z());
}

Eigen::AlignedBox3d box_of(const MapObject& object) {
  Eigen::AlignedBox3d box;
  for (int i = 0; i < 8; ++i) box.extend(corner_of(object, i));
  return box;
}

/// What is out of view is as opaque as it is probable: one that is surely there is almost solid.
double opacity_of(const MapObject& object) {
  return object.ghost ? 0.12 + 0.75 * object.probability * object.probability : 1.0;
}

Color4 face_color(const MapObject& object) {
  const double opacity = opacity_of(object);
  return {object.rgb[0], object.rgb[1], object.rgb[2],
          static_cast<unsigned char>(std::lround(255 * opacity))};
}

/// Edges are opaque, which costs no pass over the whole image; those of ghosts fade into the background.
Color4 edge_color(const MapObject& object, bool selected, const SceneColors& colors) {
  if (object.mark && !selected) return {(*object.mark)[0], (*object.mark)[1], (*object.mark)[2], 255};
  const SceneColor& line = selected ? colors.accent : colors.edges;
  const double fade = selected ? 0 : 0.7 * (1 - opacity_of(object));
  Color4 color = {0, 0, 0, 255};
  for (size_t i = 0; i < 3; ++i)
    color[i] = static_cast<unsigned char>(
        std::lround(255 * (line[i] * (1 - fade) + colors.background_bottom[i] * fade)));
  return color;
}

/// Points and cells of boxes with a colour per cell.
class Boxes {
 public:
  Boxes() { colors_->SetNumberOfComponents(4); }

  void add_faces(const MapObject& object) {
    const vtkIdType first = add_corners(object);
    for (const auto& face : kFaceCorners) {
      const std::array<vtkIdType, 4> ids = {first + face[0], first + face[1], first + face[2],
                                            first + face[3]};
      cells_->InsertNextCell(4, ids.data());
      colors_->InsertNextTypedTuple(face_color(object).data());
    }
  }
  void add_edges(const MapObject& object, const Color4& color) {
    const vtkIdType first = add_corners(object);
    for (const auto& edge : kEdgeCorners) {
      const std::array<vtkIdType, 2> ids = {first + edge[0], first + edge[1]};
      cells_->InsertNextCell(2, ids.data());
      colors_->InsertNextTypedTuple(color.data());
    }
  }
  void show_as(vtkActor& actor, bool lines) const {
    vtkNew<vtkPolyData> data;
    data->SetPoints(points_);
    if (lines)
      data->SetLines(cells_);
    else
      data->SetPolys(cells_);
    data->GetCellData()->SetScalars(colors_);
    static_cast<vtkPolyDataMapper*>(actor.GetMapper())->SetInputData(data);
  }

 private:
  vtkIdType add_corners(const MapObject& object) {
    const vtkIdType first = points_->GetNumberOfPoints();
    for (int i = 0; i < 8; ++i) points_->InsertNextPoint(corner_of(object, i).data());
    return first;
  }

  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> cells_;
  vtkNew<vtkUnsignedCharArray> colors_;
};

vtkSmartPointer<vtkActor> layer_actor(vtkRenderer& renderer, bool lines) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(vtkNew<vtkPolyData>());
  mapper->SetStatic(1);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.42);
  actor->GetProperty()->SetDiffuse(0.64);
  actor->GetProperty()->SetLighting(!lines);
  actor->SetPickable(!lines);
  renderer.AddActor(actor);
  return actor;
}

LabelLayer::Label label_of(const MapObject& object, bool selected) {
  const Eigen::AlignedBox3d box = box_of(object);
  LabelLayer::Label label;
  label.text = object.label;
  label.anchor = {box.center().x(), box.center().y(), box.max().z()};
  label.importance = (selected ? 10 : 0) + (object.ghost ? 0 : 1) + object.probability;
  label.emphasised = selected;
  return label;
}

}  // namespace

ObjectActors::ObjectActors(vtkRenderer* renderer, vtkRenderer* overlay)
    : renderer_(renderer), labels_(overlay) {
  solid_.actor = layer_actor(*renderer_, false);
  ghosts_.actor = layer_actor(*renderer_, false);
  // VTK's pass for what is translucent costs more than all else under software rendering. Sorted, and without
  // their backs, boxes need none: they are blended as they are drawn.
  ghosts_.actor->ForceOpaqueOn();
  ghosts_.actor->GetProperty()->BackfaceCullingOn();
  edges_.actor = layer_actor(*renderer_, true);
  selected_edges_.actor = layer_actor(*renderer_, true);
}

void ObjectActors::set(std::vector<MapObject> objects, const SceneColors& colors) {
  objects_ = std::move(objects);
  set_colors(colors);
}

void ObjectActors::select(std::optional<int64_t> id, const SceneColors& colors) {
  if (std::exchange(selected_, id) != id) set_colors(colors);
}

/// However much changes at once, it is made once, and only when it is drawn.
void ObjectActors::set_colors(const SceneColors& colors) {
  colors_ = colors;
  edges_.actor->GetProperty()->SetLineWidth(static_cast<float>(1.5 * colors.pixels));
  selected_edges_.actor->GetProperty()->SetLineWidth(static_cast<float>(4 * colors.pixels));
  due_ = true;
}

void ObjectActors::rebuild() {
  due_ = false;
  Boxes solid, edges, selected_edges;
  std::vector<LabelLayer::Label> labels;
  for (Layer* layer : {&solid_, &ghosts_, &edges_, &selected_edges_}) layer->objects.clear();
  for (size_t i = 0; i < objects_.size(); ++i) {
    const MapObject& object = objects_[i];
    const bool selected = selected_ == object.id;
    if (!object.ghost) solid.add_faces(object);
    (object.ghost ? ghosts_ : solid_).objects.push_back(i);
    const bool thick = selected || object.mark;
    (thick ? selected_edges : edges).add_edges(object, edge_color(object, selected, colors_));
    (thick ? selected_edges_ : edges_).objects.push_back(i);
    labels.push_back(label_of(object, selected));
  }
  solid.show_as(*solid_.actor, false);
  edges.show_as(*edges_.actor, true);
  selected_edges.show_as(*selected_edges_.actor, true);
  ghosts_due_ = true;
  labels_.set(labels, colors_);
  set_visible(visible_);
}

void ObjectActors::arrange(const Vector3d& eye) {
  if (due_) rebuild();
  labels_.lay_out();
  if (!ghosts_due_ && eye == eye_) return;
  eye_ = eye;
  ghosts_due_ = false;
  const auto distance = [&](size_t i) { return (objects_[i].map_from_object.translation() - eye).norm(); };
  std::stable_sort(ghosts_.objects.begin(), ghosts_.objects.end(),
                   [&](size_t a, size_t b) { return distance(a) > distance(b); });
  Boxes boxes;
  for (const size_t i : ghosts_.objects) boxes.add_faces(objects_[i]);
  boxes.show_as(*ghosts_.actor, false);
}

void ObjectActors::draw_last() {
  renderer_->RemoveActor(ghosts_.actor);
  renderer_->AddActor(ghosts_.actor);
}

void ObjectActors::set_visible(bool visible) {
  visible_ = visible;
  for (const Layer* layer : {&solid_, &ghosts_, &edges_, &selected_edges_})
    layer->actor->SetVisibility(visible && !layer->objects.empty());
}

std::optional<int64_t> ObjectActors::object_of(const vtkActor* actor, int64_t cell) const {
  for (const Layer* layer : {&solid_, &ghosts_})
    if (layer->actor.Get() == actor && cell >= 0) {
      const auto box = static_cast<size_t>(cell / kFaces);
      if (box < layer->objects.size()) return objects_[layer->objects[box]].id;
    }
  return std::nullopt;
}

std::optional<Eigen::AlignedBox3d> ObjectActors::bounds() const {
  Eigen::AlignedBox3d all;
  for (const MapObject& object : objects_) all.extend(box_of(object));
  return all.isEmpty() ? std::nullopt : std::optional(all);
}

std::optional<Eigen::AlignedBox3d> ObjectActors::bounds_of(int64_t id) const {
  for (const MapObject& object : objects_)
    if (object.id == id) return box_of(object);
  return std::nullopt;
}

std::vector<vtkActor*> ObjectActors::pickable() const {
  std::vector<vtkActor*> actors;
  for (const Layer* layer : {&solid_, &ghosts_})
    if (layer->actor->GetVisibility() != 0) actors.push_back(layer->actor);
  return actors;
}

}  // namespace loci::gui
