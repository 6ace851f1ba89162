#include "gui/scene3d/object_actors.h"

#include <vtkActor.h>
#include <vtkCubeSource.h>
#include <vtkNew.h>
#include <vtkOutlineSource.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <algorithm>

#include "gui/scene3d/vtk_convert.h"

namespace loci {
namespace {

/// Nothing is drawn thinner than this, so that flat and unmeasured things can be seen and clicked.
constexpr double kLeastSize = 0.01;

Vector3d drawn_size(const MapObject& object) {
  return object.size.cwiseMax(kLeastSize);
}

template <class Source>
vtkSmartPointer<vtkActor> actor_of(Source* source, const MapObject& object) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(source->GetOutputPort());
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->SetUserMatrix(matrix_of(object.map_from_object));
  return actor;
}

Eigen::AlignedBox3d box_of(const MapObject& object) {
  const Vector3d half = drawn_size(object) / 2;
  const Eigen::AlignedBox3d local(-half, half);
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner)
    box.extend(object.map_from_object * local.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  return box;
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

void ObjectActors::set(std::vector<MapObject> objects, const SceneColors& colors) {
  for (Actors& actors : actors_) {
    renderer_->RemoveActor(actors.surface);
    renderer_->RemoveActor(actors.edges);
  }
  actors_.clear();
  objects_ = std::move(objects);
  for (const MapObject& object : objects_) {
    const Vector3d size = drawn_size(object);
    vtkNew<vtkCubeSource> cube;
    cube->SetXLength(size.x());
    cube->SetYLength(size.y());
    cube->SetZLength(size.z());
    vtkNew<vtkOutlineSource> outline;
    outline->SetBounds(-size.x() / 2, size.x() / 2, -size.y() / 2, size.y() / 2, -size.z() / 2, size.z() / 2);
    Actors actors = {actor_of(cube.Get(), object), actor_of(outline.Get(), object)};
    actors.edges->PickableOff();
    renderer_->AddActor(actors.surface);
    renderer_->AddActor(actors.edges);
    actors_.push_back(std::move(actors));
  }
  restyle(colors);
}

void ObjectActors::select(std::optional<int64_t> id, const SceneColors& colors) {
  selected_ = id;
  restyle(colors);
}

void ObjectActors::restyle(const SceneColors& colors) {
  std::vector<LabelLayer::Label> labels;
  for (size_t i = 0; i < objects_.size(); ++i) {
    const MapObject& object = objects_[i];
    const bool selected = selected_ == object.id;
    vtkProperty* surface = actors_[i].surface->GetProperty();
    surface->SetColor(object.rgb[0] / 255.0, object.rgb[1] / 255.0, object.rgb[2] / 255.0);
    surface->SetAmbient(0.42);
    surface->SetDiffuse(0.64);
    surface->SetOpacity(object.ghost ? 0.12 + 0.28 * object.probability : 1.0);
    vtkProperty* edges = actors_[i].edges->GetProperty();
    edges->SetLighting(false);
    set_color(*edges, selected ? colors.accent : colors.edges);
    edges->SetLineWidth(selected ? 4.0F : 1.5F);
    edges->SetOpacity(object.ghost && !selected ? 0.5 : 1.0);
    labels.push_back(label_of(object, selected));
  }
  labels_.set(labels, colors);
  set_visible(visible_);
}

void ObjectActors::set_visible(bool visible) {
  visible_ = visible;
  for (Actors& actors : actors_) {
    actors.surface->SetVisibility(visible);
    actors.edges->SetVisibility(visible);
  }
}

std::optional<int64_t> ObjectActors::object_of(const vtkActor* actor) const {
  for (size_t i = 0; i < actors_.size(); ++i)
    if (actors_[i].surface.Get() == actor) return objects_[i].id;
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
  if (visible_)
    for (const Actors& item : actors_) actors.push_back(item.surface);
  return actors;
}

}  // namespace loci
