#include "gui/scene3d/map_scene.h"

#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellPicker.h>
#include <vtkCullerCollection.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "gui/scene3d/object_actors.h"
#include "gui/scene3d/overlay_actors.h"
#include "gui/scene3d/world_actors.h"
#include "mapping/base/math/math.h"

namespace loci::gui {
namespace {

// The pyramid of the camera, by the size of the view: longer ones hide the objects.
constexpr double kFrustumPart = 0.08;
constexpr double kLongestFrustum = 0.35;  // metres
constexpr double kFieldOfViewDeg = 35;    // little perspective: sizes stay comparable
constexpr double kMargin = 1.06;
constexpr int kPickReach = 4;             // pixels around a click
constexpr double kMeasuredBehind = 0.03;  // metres
constexpr double kNearPart = 0.03;        // of the farthest distance that is drawn …
constexpr double kNearPartOfFocus = 0.1;  // … and of that to what is looked at
constexpr double kAroundObjects = 0.5;    // metres of room shown around the objects

Eigen::AlignedBox3d inflated(const Eigen::AlignedBox3d& box, double by) {
  return {box.min() - Vector3d::Constant(by), box.max() + Vector3d::Constant(by)};
}

/// Puts the camera on the line through the box's centre so that all corners are just in view, z up.
void fit(vtkRenderer& renderer, const Eigen::AlignedBox3d& box, const Vector3d& towards_eye) {
  const Vector3d forward = -towards_eye.normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  const Vector3d above = right.cross(forward);
  const double tan_v = std::tan(kFieldOfViewDeg * kPi / 360);
  const int* size = renderer.GetRenderWindow()->GetSize();  // the renderer's own is that of the last image
  const double aspect = size[1] > 0 && size[0] > 0 ? static_cast<double>(size[0]) / size[1] : 4.0 / 3;
  double distance = 0.1;
  for (int i = 0; i < 8; ++i) {
    const Vector3d d = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)) - box.center();
    const double needed = std::max(std::abs(d.dot(right)) / (tan_v * aspect), std::abs(d.dot(above)) / tan_v);
    distance = std::max(distance, kMargin * needed - d.dot(forward));
  }
  vtkCamera* camera = renderer.GetActiveCamera();
  const Vector3d eye = box.center() - distance * forward;
  camera->SetViewAngle(kFieldOfViewDeg);
  const Vector3d middle = box.center();
  camera->SetFocalPoint(middle.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(above.data());
}

void add_light(vtkRenderer& renderer, double x, double y, double strength) {
  vtkNew<vtkLight> light;
  light->SetLightTypeToCameraLight();
  light->SetPosition(x, y, 1);
  light->SetFocalPoint(0, 0, 0);
  light->SetIntensity(strength);
  renderer.AddLight(light);
}

}  // namespace

struct MapScene::Impl {
  vtkNew<vtkRenderer> renderer;
  WorldActors world{renderer.Get()};
  RoomActor mesh{renderer.Get()};  ///< of the room
  vtkNew<vtkRenderer> overlay;     ///< labels: before everything, and not blurred by anti-aliasing
  ObjectActors objects{renderer.Get(), overlay.Get()};
  FrameActors frame{renderer.Get()};
  FrameActors chosen{renderer.Get()};  ///< the selected object's points
  GuideActors guides{renderer.Get()};
  SceneColors colors;
  JointState joints;
  std::vector<std::string> joint_names;
  std::optional<int64_t> object;
  std::string link;
  Vector3d side = Vector3d(-0.5, -1, 0);
  std::map<MapLayer, bool> layers = {{MapLayer::map, true},     {MapLayer::room, true},
                                     {MapLayer::objects, true}, {MapLayer::labels, true},
                                     {MapLayer::cloud, true},   {MapLayer::camera, true},
                                     {MapLayer::trace, true},   {MapLayer::cameras, false}};

  static void before_render(vtkObject*, unsigned long, void* client, void*) {
    auto* self = static_cast<Impl*>(client);
    const double* eye = self->renderer->GetActiveCamera()->GetPosition();
    self->reset_clipping_range();
    self->world.arrange({eye[0], eye[1], eye[2]}, self->view_planes());
    self->objects.arrange({eye[0], eye[1], eye[2]});
  }

  /// By what is there now, not by what was there at the first image: the same scene gives the same image.
  /// VTK would ask every actor for its size.
  void reset_clipping_range() {
    const Eigen::AlignedBox3d all = bounds().merged(guides.bounds());
    if (all.isEmpty()) return;
    const std::array<double, 6> bounds = {all.min().x(), all.max().x(), all.min().y(),
                                          all.max().y(), all.min().z(), all.max().z()};
    renderer->ResetCameraClippingRange(bounds.data());
    // Within the room the nearest plane would come to the eye, and depths far from it would blur together.
    vtkCamera* camera = renderer->GetActiveCamera();
    const double* range = camera->GetClippingRange();
    const double near = std::min(kNearPart * range[1], kNearPartOfFocus * camera->GetDistance());
    if (near > range[0]) camera->SetClippingRange(near, range[1]);
  }

  Eigen::AlignedBox3d bounds() const {
    Eigen::AlignedBox3d all = frame.bounds().merged(chosen.bounds()).merged(mesh.bounds());
    if (const auto room = world.bounds()) all.extend(*room);
    if (const auto things = objects.bounds()) all.extend(*things);
    return all;
  }

  /// What bounds the view.
  std::vector<Eigen::Vector4d> view_planes() const {
    const int* size = renderer->GetRenderWindow()->GetSize();
    std::array<double, 24> numbers = {};
    renderer->GetActiveCamera()->GetFrustumPlanes(static_cast<double>(size[0]) / std::max(1, size[1]),
                                                  numbers.data());
    std::vector<Eigen::Vector4d> planes;
    for (size_t i = 0; i < numbers.size(); i += 4) planes.emplace_back(numbers.data() + i);
    return planes;
  }

  bool pick(vtkCellPicker& picker, int x, int y) {
    picker.SetTolerance(0.002);
    picker.PickFromListOn();
    for (vtkActor* actor : objects.pickable()) picker.AddPickList(actor);
    for (vtkActor* actor : world.pickable()) picker.AddPickList(actor);
    return picker.Pick(x, y, 0, renderer) != 0;
  }

  /// What is worth looking at first: the objects with some room around them, else the whole map.
  Eigen::AlignedBox3d interesting() const {
    const auto things = objects.bounds();
    const auto room = world.bounds();
    if (things && room) {
      Eigen::AlignedBox3d near = inflated(*things, kAroundObjects).intersection(*room);
      return near.extend(*things);
    }
    if (things) return inflated(*things, 0.2);
    if (room) return *room;
    return {Vector3d(-1, -1, 0), Vector3d(1, 1, 1)};
  }
};

MapScene::MapScene(vtkRenderWindow* window) : impl_(std::make_unique<Impl>()) {
  window->AddRenderer(impl_->renderer);
  window->SetNumberOfLayers(2);
  impl_->overlay->SetLayer(1);
  impl_->overlay->InteractiveOff();
  impl_->overlay->SetActiveCamera(impl_->renderer->GetActiveCamera());
  window->AddRenderer(impl_->overlay);
  for (vtkRenderer* renderer : {impl_->renderer.Get(), impl_->overlay.Get()})
    renderer->GetCullers()->RemoveAllItems();  // a few actors: to cull them costs more than to draw them
  impl_->renderer->UseFXAAOn();
  impl_->renderer->GradientBackgroundOn();
  impl_->renderer->AutomaticLightCreationOff();
  add_light(*impl_->renderer, 0.4, 0.8, 0.9);
  add_light(*impl_->renderer, -1.0, 0.2, 0.35);
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(impl_.get());
  command->SetCallback(&Impl::before_render);
  impl_->renderer->AddObserver(vtkCommand::StartEvent, command);
  set_colors({});
  look_from(MapViewpoint::overview);
}

MapScene::~MapScene() {
  impl_->renderer->RemoveObservers(vtkCommand::StartEvent);
  if (auto* window = impl_->renderer->GetRenderWindow()) {
    window->RemoveRenderer(impl_->overlay);
    window->RemoveRenderer(impl_->renderer);
  }
}

void MapScene::set_world(const mapping::World& world, const PreparedWorld& prepared) {
  impl_->world.set(world, prepared, impl_->colors);
  impl_->joint_names.clear();
  for (const mapping::Joint& joint : world.joints) impl_->joint_names.push_back(joint.name);
  impl_->world.set_visible(layer(MapLayer::map));
  impl_->objects.draw_last();
}

void MapScene::clear_world() {
  impl_->world.clear();
}

void MapScene::set_room(const mapping::ColoredMesh& mesh) {
  impl_->mesh.set_mesh(mesh);
  impl_->mesh.set_visible(layer(MapLayer::room));
  impl_->objects.draw_last();
}

void MapScene::add_place(const std::string& name, const std::vector<Vector2d>& outline, double height) {
  impl_->world.add_outline(name, outline, height, impl_->colors);
  impl_->objects.draw_last();
}

void MapScene::set_joints(const JointState& state, Warnings& warnings) {
  JointState known;
  for (const auto& [name, position] : state) {
    const auto& names = impl_->joint_names;
    if (std::find(names.begin(), names.end(), name) != names.end())
      known[name] = position;
    else
      warnings.add("the map has no joint '" + name + "'");
  }
  impl_->world.set_joints(known);
}

void MapScene::set_objects(std::vector<MapObject> objects) {
  impl_->objects.set(std::move(objects), impl_->colors);
}

void MapScene::set_cloud(const ColoredCloud& cloud) {
  impl_->frame.set_cloud(cloud);
}

void MapScene::set_object_cloud(const ColoredCloud& cloud) {
  impl_->chosen.set_cloud(cloud);
}

size_t MapScene::object_point_count() const {
  return impl_->chosen.point_count();
}

void MapScene::set_camera(const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera) {
  const double range = std::min(kLongestFrustum, kFrustumPart * impl_->interesting().diagonal().norm());
  impl_->frame.set_camera(camera, map_from_camera, range, impl_->colors);
}

void MapScene::clear_frame() {
  impl_->frame.clear();
}

void MapScene::set_colors(const SceneColors& colors) {
  impl_->colors = colors;
  impl_->guides.set_colors(colors);
  for (FrameActors* points : {&impl_->frame, &impl_->chosen}) points->set_pixels(colors.pixels);
  impl_->renderer->SetBackground(colors.background_bottom[0], colors.background_bottom[1],
                                 colors.background_bottom[2]);
  impl_->renderer->SetBackground2(colors.background_top[0], colors.background_top[1],
                                  colors.background_top[2]);
  impl_->world.set_colors(colors);
  impl_->world.select(impl_->link, colors);
  impl_->objects.set_colors(colors);
}

const SceneColors& MapScene::colors() const {
  return impl_->colors;
}

void MapScene::set_trace(std::vector<Vector3d> points) {
  impl_->guides.set_trace(std::move(points));
}

const std::vector<Vector3d>& MapScene::trace() const {
  return impl_->guides.trace();
}

void MapScene::set_cameras(const std::vector<Isometry3d>& cameras) {
  impl_->guides.set_cameras(cameras, kLongestFrustum / 2);
}

void MapScene::set_ruler(const std::vector<Vector3d>& points) {
  impl_->guides.set_ruler(points);
}

void MapScene::set_section(const std::optional<MapSection>& section) {
  vtkSmartPointer<vtkPlane> plane;
  if (section) {
    plane = vtkSmartPointer<vtkPlane>::New();
    Vector3d normal = Vector3d::Unit(section->axis);
    const Vector3d origin = section->at * normal;
    if (section->below) normal = -normal;
    plane->SetOrigin(origin.data());
    plane->SetNormal(normal.data());
  }
  impl_->world.set_section(plane);
  impl_->mesh.set_section(plane);
  for (FrameActors* points : {&impl_->frame, &impl_->chosen}) points->set_section(plane);
}

void MapScene::select_object(std::optional<int64_t> id) {
  impl_->object = id;
  impl_->objects.select(id, impl_->colors);
}

void MapScene::select_link(const std::string& link) {
  impl_->link = link;
  impl_->world.select(link, impl_->colors);
}

void MapScene::set_layer(MapLayer layer, bool visible) {
  impl_->layers[layer] = visible;
  switch (layer) {
    case MapLayer::map:
      return impl_->world.set_visible(visible);
    case MapLayer::room:
      return impl_->mesh.set_visible(visible);
    case MapLayer::objects:
      impl_->objects.set_visible(visible);
      return impl_->objects.set_labels_visible(impl_->layers[MapLayer::labels]);
    case MapLayer::labels:
      return impl_->objects.set_labels_visible(visible);
    case MapLayer::cloud:
      impl_->chosen.set_cloud_visible(visible);
      return impl_->frame.set_cloud_visible(visible);
    case MapLayer::camera:
      return impl_->frame.set_camera_visible(visible);
    case MapLayer::trace:
      return impl_->guides.set_trace_visible(visible);
    case MapLayer::cameras:
      return impl_->guides.set_cameras_visible(visible);
  }
}

bool MapScene::layer(MapLayer layer) const {
  return impl_->layers.at(layer);
}

void MapScene::set_point_size(double size) {
  for (FrameActors* points : {&impl_->frame, &impl_->chosen})
    points->set_point_size(std::clamp(size, 1.0, 10.0));
}
double MapScene::point_size() const {
  return impl_->frame.point_size();
}

void MapScene::set_overview_side(const Vector3d& towards_eye) {
  const Vector3d flat(towards_eye.x(), towards_eye.y(), 0);
  if (flat.norm() > 1e-6) impl_->side = flat.normalized();
}

void MapScene::look_from(MapViewpoint viewpoint) {
  const Vector3d z = Vector3d::UnitZ();
  const Eigen::AlignedBox3d box = impl_->interesting();
  switch (viewpoint) {
    case MapViewpoint::overview:
      return fit(*impl_->renderer, box, impl_->side.normalized() + 0.75 * z);
    case MapViewpoint::top:
      return fit(*impl_->renderer, impl_->world.bounds().value_or(box), z + 0.03 * impl_->side);
    case MapViewpoint::front:
      return fit(*impl_->renderer, box, impl_->side);
    case MapViewpoint::left:
      return fit(*impl_->renderer, box, z.cross(impl_->side));
  }
}

void MapScene::share_eye_of(MapScene& other) {
  vtkCamera* camera = other.impl_->renderer->GetActiveCamera();
  impl_->renderer->SetActiveCamera(camera);
  impl_->overlay->SetActiveCamera(camera);
}

std::array<double, 9> MapScene::eye() const {
  std::array<double, 9> eye = {};
  vtkCamera* camera = impl_->renderer->GetActiveCamera();
  camera->GetPosition(eye.data());
  camera->GetFocalPoint(eye.data() + 3);
  camera->GetViewUp(eye.data() + 6);
  return eye;
}

void MapScene::frame_selection() {
  auto box = impl_->object ? impl_->objects.bounds_of(*impl_->object) : std::nullopt;
  if (!box && !impl_->link.empty()) box = impl_->world.bounds_of(impl_->link);
  const double* forward = impl_->renderer->GetActiveCamera()->GetDirectionOfProjection();
  const Vector3d towards_eye(-forward[0], -forward[1], -forward[2]);
  fit(*impl_->renderer, box ? inflated(*box, 0.25) : impl_->interesting(), towards_eye);
}

void MapScene::set_moving(bool moving) {
  impl_->renderer->SetUseFXAA(!moving);
}

MapPick MapScene::pick(int x, int y) {
  vtkNew<vtkCellPicker> picker;
  MapPick result;
  if (!impl_->pick(*picker, x, y)) return result;
  result.object = impl_->objects.object_of(picker->GetActor(), picker->GetCellId());
  if (const std::string* link = impl_->world.link_of(picker->GetActor())) result.link = *link;
  return result;
}

std::optional<Vector3d> MapScene::pick_point(int x, int y) {
  // The selected object's points are of the same surface, but finer.
  auto measured = impl_->chosen.point_near(*impl_->renderer, x, y, kPickReach);
  if (!measured) measured = impl_->frame.point_near(*impl_->renderer, x, y, kPickReach);
  vtkNew<vtkCellPicker> picker;
  if (!impl_->pick(*picker, x, y)) return measured;
  const Vector3d modelled(picker->GetPickPosition());
  if (!measured) return modelled;
  const Vector3d eye(impl_->renderer->GetActiveCamera()->GetPosition());
  // What was measured of a surface counts for more than how that is modelled.
  return (*measured - eye).norm() < (modelled - eye).norm() + kMeasuredBehind ? *measured : modelled;
}

Eigen::AlignedBox3d MapScene::bounds() const {
  return impl_->bounds();
}

const std::vector<MapObject>& MapScene::objects() const {
  return impl_->objects.objects();
}
size_t MapScene::point_count() const {
  return impl_->frame.point_count();
}
std::vector<std::string> MapScene::shown_labels() const {
  return impl_->objects.labels().shown();
}
std::optional<int64_t> MapScene::selected_object() const {
  return impl_->object;
}
vtkRenderer* MapScene::renderer() const {
  return impl_->renderer;
}

}  // namespace loci::gui
