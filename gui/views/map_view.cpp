#include "gui/views/map_view.h"

#include <vtkNew.h>
#include <QEvent>
#include <QVBoxLayout>

#include "gui/scene3d/frame_actors.h"
#include "gui/scene3d/object_actors.h"
#include "gui/scene3d/orbit_style.h"
#include "gui/scene3d/world_actors.h"
#include "gui/theme.h"

namespace loci {
namespace {

/// After this the time is no longer being scrubbed and the picture may take longer.
constexpr int kStillMs = 300;

/// A picture of one colour is what a context without drawing gives; even an empty scene has a gradient.
bool is_blank(const QImage& image) {
  const QRgb first = image.pixel(0, 0);
  for (int y = 0; y < image.height(); y += 4)
    for (int x = 0; x < image.width(); x += 4)
      if (image.pixel(x, y) != first) return false;
  return true;
}

/// Where the cameras looked from, by and large: from there the room is open.
Vector3d usual_side(const BrowserData& memory) {
  Vector3d sum = Vector3d::Zero();
  for (const SceneEntry& scene : memory.scenes())
    if (scene.map_from_camera) sum -= scene.map_from_camera->linear().col(2);
  return sum;
}

MapObject map_object_of(const BelievedObject& object) {
  MapObject result;
  result.id = object.id;
  result.label = object.name;
  result.map_from_object = *object.map_from_object;
  result.size = object.size;
  result.rgb = object.rgb;
  result.ghost = object.presence != Presence::seen;
  result.probability = object.probability;
  return result;
}

}  // namespace

MapView::MapView(Browser& browser, MapBackend backend, QWidget* parent)
    : QWidget(parent), browser_(browser), canvas_(MapCanvas::make(backend, this)) {
  setMinimumSize(240, 180);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(canvas_);
  connect(canvas_, &MapCanvas::drawn, this, &MapView::drawn);
  scene_ = std::make_unique<MapScene>(canvas_->window());
  take_mouse();
  scene_->set_colors(Theme::of(palette()).scene());
  connect(&browser_, &Browser::opened, this, &MapView::show_memory);
  connect(&browser_, &Browser::belief_changed, this, &MapView::show_belief);
  connect(&browser_, &Browser::selected, this, &MapView::show_selection);
  still_.setSingleShot(true);
  still_.setInterval(kStillMs);
  connect(&still_, &QTimer::timeout, this, [this] {
    scene_->set_moving(false);
    redraw();
  });
  show_memory();
  show_belief();
}

MapView::~MapView() = default;

void MapView::take_mouse() {
  vtkNew<OrbitStyle> style;
  style->on_click = [this](int x, int y) { clicked(x, y); };
  style->on_motion = [this](bool moving) {
    scene_->set_moving(moving);
    if (!moving) redraw();
  };
  style->on_ctrl_wheel = [this](int steps) { change_point_size(steps); };
  canvas_->set_style(style);
}

void MapView::show_memory() {
  const BrowserData* memory = browser_.data();
  const std::string path = memory == nullptr ? "" : memory->info().path;
  const World* world = memory == nullptr ? nullptr : memory->world();
  const bool same = path == memory_;
  scene_->set_overview_side(memory == nullptr ? Vector3d(-0.5, -1, 0) : usual_side(*memory));
  if (same && world == world_ && !waits_for_world_ && world != nullptr)
    return;  // it has grown: the eye stays
  if (!same) first_look_ = true;
  memory_ = path;
  world_ = world;
  waits_for_world_ = memory != nullptr;
  if (!same || world == nullptr) scene_->clear_world();
  browser_.reader().read<PreparedWorld>(
      this, "map", Urgency::moment,
      [colors = scene_->colors()](const BrowserData& source) {
        PreparedWorld prepared;
        if (source.world() != nullptr)
          prepared = prepare_world(*source.world(), source.mesh_search(), colors);
        return prepared;
      },
      [this](const PreparedWorld& prepared) { take_world(prepared); });
}

void MapView::take_world(const PreparedWorld& world) {
  waits_for_world_ = false;
  scene_->clear_world();
  if (world_ != nullptr) scene_->set_world(*world_, world);
  for (const PlaceOutline& place : browser_.data()->loose_places())
    scene_->add_place(place.name, place.outline, place.height);
  for (const std::string& text : world.warnings) Q_EMIT warned(QString::fromStdString(text));
  show_joints();
  show_frame();
  show_selection();
  place_eye();
}

void MapView::show_belief() {
  std::vector<MapObject> objects;
  for (const BelievedObject& object : browser_.belief().objects)
    if (object.map_from_object && object.presence != Presence::gone) objects.push_back(map_object_of(object));
  scene_->set_objects(std::move(objects));
  scene_->set_moving(true);
  still_.start();
  show_joints();
  show_frame();
  show_selection();
  place_eye();
}

void MapView::show_joints() {
  if (world_ == nullptr) return;
  Warnings warnings;
  scene_->set_joints(browser_.belief().joints, warnings);
  for (const std::string& text : warnings.texts()) Q_EMIT warned(QString::fromStdString(text));
}

/// The first look waits for everything that is to be seen.
void MapView::place_eye() {
  if (!first_look_ || browser_.data() == nullptr || waits_for_world_ || browser_.belief().time == 0) return;
  scene_->look_from(MapViewpoint::overview);
  first_look_ = false;
}

void MapView::show_frame() {
  const Moment& moment = browser_.moment();
  if (!moment.cloud) return scene_->clear_frame();
  scene_->set_cloud(*moment.cloud);
  scene_->set_camera(moment.content->camera.depth, *moment.content->map_from_camera);
}

void MapView::show_selection() {
  scene_->select_object(browser_.selection().object());
  scene_->select_link(browser_.selection().place());
  redraw();
}

void MapView::clicked(int x, int y) {
  const MapPick pick = scene_->pick(x, y);
  if (pick.object)
    browser_.selection().select_object(pick.object);
  else if (!pick.link.empty())
    browser_.selection().select_place(pick.link);
  else
    browser_.selection().clear();
}

void MapView::frame_selection() {
  scene_->frame_selection();
  redraw();
}

void MapView::look_from(MapViewpoint viewpoint) {
  scene_->look_from(viewpoint);
  redraw();
}

void MapView::set_layer(MapLayer layer, bool visible) {
  scene_->set_layer(layer, visible);
  redraw();
}

void MapView::change_point_size(int steps) {
  scene_->set_point_size(scene_->point_size() + steps);
  redraw();
}

void MapView::redraw() {
  canvas_->redraw();
}

QImage MapView::picture() {
  scene_->set_moving(false);
  const QImage image = canvas_->picture();
  if (image.isNull() || is_blank(image))
    throw Error("the 3D view stayed blank: OpenGL did not draw", {}, "check the graphics driver");
  return image;
}

void MapView::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() != QEvent::PaletteChange || !scene_) return;
  scene_->set_colors(Theme::of(palette()).scene());
  redraw();
}

}  // namespace loci
