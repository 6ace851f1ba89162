#include "gui/views/map/map_view.h"

#include <vtkNew.h>
#include <QEvent>
#include <QVBoxLayout>

#include "gui/core/theme.h"
#include "gui/scene3d/object_actors.h"
#include "gui/scene3d/orbit_style.h"
#include "gui/scene3d/overlay_actors.h"
#include "gui/scene3d/world_actors.h"

namespace loci::gui {
namespace {

/// After this the time is no longer being scrubbed and the image may take longer.
constexpr int kStillMs = 300;
/// More of them are a thicket.
constexpr size_t kMaxCameras = 400;
/// Of the selected object; with those of a scene's thumbnail they stay below what is drawn fluently.
constexpr size_t kMaxObjectPoints = 25000;

/// An image of one colour is what a context without drawing gives; even an empty scene has a gradient.
bool is_blank(const QImage& image) {
  const QRgb first = image.pixel(0, 0);
  for (int y = 0; y < image.height(); y += 4)
    for (int x = 0; x < image.width(); x += 4)
      if (image.pixel(x, y) != first) return false;
  return true;
}

/// The mean viewing direction, reversed: from there the scene is open.
Vector3d usual_side(const OpenMemory& memory) {
  Vector3d sum = Vector3d::Zero();
  for (const memory::SceneRow& scene : memory.scenes())
    if (scene.map_from_camera) sum -= scene.map_from_camera->linear().col(2);
  return sum;
}

MapObject map_object_of(const Belief& belief, const BelievedObject& object) {
  MapObject result;
  result.id = object.object;
  result.label = belief.name_of(object);
  result.map_from_object = *object.map_from_object;
  result.size = object.box_size.value_or(Vector3d::Zero());
  result.rgb = rgb_of(object);
  result.ghost = object.status != memory::ObjectStatus::seen;
  result.probability = object.probability;
  return result;
}

SceneColors scene_colors(const Theme& theme) {
  SceneColors colors = theme.dark ? SceneColors::dark() : SceneColors::light();
  colors.accent = {theme.accent.redF(), theme.accent.greenF(), theme.accent.blueF()};
  return colors;
}

/// At most so many points, evenly spaced in the list.
ColoredCloud thinned(ColoredCloud cloud, size_t limit) {
  const size_t step = cloud.points.size() / limit + 1;
  if (step == 1) return cloud;
  ColoredCloud some;
  for (size_t i = 0; i < cloud.points.size(); i += step) {
    some.points.push_back(cloud.points[i]);
    some.colors.push_back(cloud.colors[i]);
  }
  return some;
}

}  // namespace

MapView::MapView(Browser& browser, MapBackend backend, QWidget* parent)
    : QWidget(parent), browser_(browser), canvas_(MapCanvas::make(backend, this)) {
  setMinimumSize(240, 180);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(canvas_);
  connect(canvas_, &MapCanvas::drawn, this, [this] {
    drawn_eye_ = scene_->eye();
    Q_EMIT drawn();
  });
  scene_ = std::make_unique<MapScene>(canvas_->window());
  take_mouse();
  take_colors();
  connect(&browser_, &Browser::opened, this, &MapView::show_memory);
  connect(&browser_, &Browser::belief_changed, this, &MapView::show_belief);
  connect(&browser_, &Browser::selected, this, &MapView::show_selection);
  connect(&browser_, &Browser::opened, this, &MapView::show_cameras);
  still_.setSingleShot(true);
  still_.setInterval(kStillMs);
  connect(&still_, &QTimer::timeout, this, [this] {
    scene_->set_moving(false);
    redraw();
  });
  show_memory();
  show_cameras();
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
  const OpenMemory* memory = browser_.data();
  const std::string path = memory == nullptr ? "" : memory->info().path;
  const bool same = path == memory_;
  traced_.reset();     // it may have been seen again
  clouded_ = {-1, 0};  // nor is it known whose points are shown
  scene_->set_overview_side(memory == nullptr ? Vector3d(-0.5, -1, 0) : usual_side(*memory));
  const mapping::World* world = world_now();
  if (same && world == world_ && !waits_for_world_ && world != nullptr)
    return;  // it has grown: the eye stays
  if (!same) {
    first_view_ = true;
    joints_by_hand_.clear();
  }
  memory_ = path;
  if (!same || world == nullptr) scene_->clear_world();
  show_world(world);
}

/// The map at the time that is shown: furniture may have been moved since.
const mapping::World* MapView::world_now() const {
  const OpenMemory* memory = browser_.data();
  return memory == nullptr ? nullptr : memory->world(shown_time());
}

std::optional<TimeNs> MapView::shown_time() const {
  const TimeNs time = browser_.belief().time;
  return time == 0 ? std::nullopt : std::optional(time);
}

void MapView::show_world(const mapping::World* world) {
  world_ = world;
  waits_for_world_ = browser_.data() != nullptr;
  browser_.reader().read<PreparedWorld>(
      this, "map", Urgency::moment,
      [time = shown_time(), colors = scene_->colors()](const OpenMemory& source) {
        const mapping::World* shown = source.world(time);
        return shown == nullptr ? PreparedWorld() : prepare_world(*shown, source.mesh_search(), colors);
      },
      [this](const PreparedWorld& prepared) { take_world(prepared); });
}

void MapView::take_world(const PreparedWorld& world) {
  waits_for_world_ = false;
  scene_->clear_world();
  if (world_ != nullptr) scene_->set_world(*world_, world);
  for (const memory::PlaceRow& place : browser_.data()->loose_places())
    scene_->add_place(place.name, place.outline, *place.height);
  for (const std::string& text : world.warnings) Q_EMIT warned(QString::fromStdString(text));
  Warnings early;  // the belief may still be of the map before: reported when the new one has been read
  if (world_ != nullptr) scene_->set_joints(joints(), early);
  show_frame();
  show_selection();
  place_eye();
}

void MapView::show_objects() {
  std::vector<MapObject> objects;
  for (const BelievedObject& object : browser_.belief().objects) {
    if (!object.map_from_object || object.status == memory::ObjectStatus::gone) continue;
    objects.push_back(map_object_of(browser_.belief(), object));
    if (const auto mark = marks_.find(object.object); mark != marks_.end())
      objects.back().mark = mark->second;
  }
  scene_->set_objects(std::move(objects));
}

void MapView::set_marks(std::map<int64_t, std::array<uint8_t, 3>> marks) {
  if (marks == marks_) return;
  marks_ = std::move(marks);
  show_objects();
  show_selection();
}

void MapView::share_eye_of(MapView& other) {
  scene_->share_eye_of(*other.scene_);
  own_eye_ = false;
  redraw();
}

void MapView::show_belief() {
  if (const mapping::World* world = world_now(); world != world_) show_world(world);
  show_objects();
  scene_->set_moving(true);
  still_.start();
  if (joints_time_ != browser_.belief().time) joints_by_hand_.clear();
  show_joints();
  show_frame();
  show_selection();
  place_eye();
}

void MapView::show_joints() {
  if (world_ == nullptr || waits_for_world_) return;  // the old map may have other joints
  Warnings warnings;
  scene_->set_joints(joints(), warnings);
  for (const std::string& text : warnings.texts()) Q_EMIT warned(QString::fromStdString(text));
}

/// The first viewpoint waits for map and belief.
void MapView::place_eye() {
  if (!own_eye_ || !first_view_ || browser_.data() == nullptr || waits_for_world_ ||
      browser_.belief().time == 0)
    return;
  scene_->look_from(viewpoint_);
  first_view_ = false;
}

void MapView::show_frame() {
  const Moment& moment = browser_.moment();
  if (!moment.cloud) return scene_->clear_frame();
  scene_->set_cloud(*moment.cloud);
  scene_->set_camera(moment.content->camera.depth, *moment.content->map_from_camera);
}

/// Camera poses of the scenes; every n-th where there are very many.
void MapView::show_cameras() {
  std::vector<Isometry3d> cameras;
  const size_t count = browser_.data() == nullptr ? 0 : browser_.data()->scenes().size();
  for (size_t i = 0; i < count; i += count / kMaxCameras + 1)
    if (const auto& pose = browser_.data()->scenes()[i].map_from_camera) cameras.push_back(*pose);
  scene_->set_cameras(cameras);
}

void MapView::read_trace() {
  const auto object = browser_.selection().object();
  if (object == traced_) return;
  traced_ = object;
  trace_.clear();
  if (!object) return;
  browser_.reader().read<std::vector<TrajectoryPoint>>(
      this, "trace", Urgency::selection,
      [id = *object](const OpenMemory& memory) { return memory.trajectory(id); },
      [this](std::vector<TrajectoryPoint>& trace) {
        trace_ = std::move(trace);
        show_trace();
        redraw();
      });
}

/// The trajectory until the selected time.
void MapView::show_trace() {
  std::vector<Vector3d> points;
  for (const TrajectoryPoint& point : trace_)
    if (point.time <= browser_.selection().time()) points.push_back(point.position);
  if (points != scene_->trace()) scene_->set_trace(std::move(points));
}

/// As it was seen last, while it is believed to be there.
void MapView::read_object_cloud() {
  const BelievedObject* object = browser_.selected_object();
  const bool there = object != nullptr && object->status != memory::ObjectStatus::gone && object->last_seen;
  const auto sight = there ? std::pair(object->object, *object->last_seen) : std::pair<int64_t, TimeNs>();
  if (sight == clouded_) return;
  if (sight.first != clouded_.first) scene_->set_object_cloud({});
  clouded_ = sight;
  if (!there) return browser_.reader().forget(this, "points");
  browser_.reader().read<ColoredCloud>(
      this, "points", Urgency::selection,
      [id = object->object, time = *object->last_seen,
       known_at = browser_.selection().known_at()](const OpenMemory& memory) {
        return thinned(memory.object_cloud(id, time, known_at), kMaxObjectPoints);
      },
      [this](const ColoredCloud& cloud) {
        scene_->set_object_cloud(cloud);
        redraw();
      });
}

JointState MapView::joints() const {
  JointState joints = browser_.belief().joints;
  for (const auto& [name, position] : joints_by_hand_) joints[name] = position;
  return joints;
}

void MapView::set_joints_by_hand(const JointState& joints) {
  joints_by_hand_ = joints;
  joints_time_ = browser_.belief().time;
  show_joints();
  redraw();
}

void MapView::set_section(const std::optional<MapSection>& section) {
  scene_->set_section(section);
  redraw();
}

void MapView::set_measuring(bool measuring) {
  measuring_ = measuring;
  canvas_->setCursor(measuring ? Qt::CrossCursor : Qt::ArrowCursor);
  ruler_.clear();
  scene_->set_ruler({});
  Q_EMIT measured({});
  redraw();
}

void MapView::measure_at(int x, int y) {
  const auto point = scene_->pick_point(x, y);
  if (!point) return;
  if (ruler_.size() == 2) ruler_.clear();
  ruler_.push_back(*point);
  scene_->set_ruler(ruler_);
  const auto place = [](const Vector3d& p) {
    return QString("%1, %2, %3 m").arg(p.x(), 0, 'f', 3).arg(p.y(), 0, 'f', 3).arg(p.z(), 0, 'f', 3);
  };
  if (ruler_.size() < 2) {
    Q_EMIT measured("from " + place(ruler_[0]));
  } else {
    const Vector3d way = ruler_[1] - ruler_[0];
    Q_EMIT measured(QString("%1 m apart; along x, y, z: %2").arg(way.norm(), 0, 'f', 3).arg(place(way)));
  }
  redraw();
}

void MapView::show_selection() {
  read_trace();
  show_trace();
  read_object_cloud();
  scene_->select_object(browser_.selection().object());
  scene_->select_link(browser_.selection().place());
  redraw();
}

void MapView::clicked(int x, int y) {
  if (measuring_) return measure_at(x, y);
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
  viewpoint_ = viewpoint;
  scene_->look_from(viewpoint);
  redraw();
}

void MapView::set_layer(MapLayer layer, bool visible) {
  scene_->set_layer(layer, visible);
  redraw();
}

void MapView::set_room(const mapping::ColoredMesh& mesh) {
  scene_->set_room(mesh);
  redraw();
}

void MapView::change_point_size(int steps) {
  scene_->set_point_size(scene_->point_size() + steps);
  redraw();
}

void MapView::redraw() {
  canvas_->redraw();
}

QImage MapView::image() {
  scene_->set_moving(false);
  QImage image = canvas_->image();
  if (image.isNull() || is_blank(image))
    throw Error("the 3D view stayed blank: OpenGL did not draw", {}, "check the graphics driver");
  return image;
}

void MapView::take_colors() {
  SceneColors colors = scene_colors(Theme::of(palette()));
  colors.pixels = devicePixelRatioF();
  scene_->set_colors(colors);
}

/// A window that comes to another screen is resized there.
void MapView::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  if (scene_ && scene_->colors().pixels != devicePixelRatioF()) take_colors();
}

void MapView::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() != QEvent::PaletteChange || !scene_) return;
  take_colors();
  redraw();
}

}  // namespace loci::gui
