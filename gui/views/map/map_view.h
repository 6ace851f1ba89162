#pragma once

#include <QImage>
#include <QTimer>
#include <QWidget>
#include <array>
#include <map>
#include <memory>

#include "gui/data/browser.h"
#include "gui/scene3d/map_scene.h"
#include "gui/views/map/map_canvas.h"

namespace loci::gui {

struct PreparedWorld;

/// The 3D view: map, objects at their believed place, cloud and camera of the selected scene.
class MapView : public QWidget {
  Q_OBJECT

 public:
  /// Error when the backend cannot draw.
  MapView(Browser& browser, MapBackend backend, QWidget* parent = nullptr);
  ~MapView() override;

  MapScene& scene() { return *scene_; }
  MapCanvas& canvas() { return *canvas_; }
  /// What is on the screen. Error when the image is blank: nothing was drawn.
  QImage image();
  void frame_selection();
  void look_from(MapViewpoint viewpoint);
  void set_layer(MapLayer layer, bool visible);
  void set_room(const mapping::ColoredMesh& mesh);
  /// Shares the camera of another view from now on.
  void share_eye_of(MapView& other);
  /// The eye of the last image.
  const std::array<double, 9>& drawn_eye() const { return drawn_eye_; }
  /// Objects whose edges have a colour of their own.
  void set_marks(std::map<int64_t, std::array<uint8_t, 3>> marks);
  void change_point_size(int steps);
  /// Whether clicks measure between two points instead of choosing.
  void set_measuring(bool measuring);
  void set_section(const std::optional<MapSection>& section);
  /// Moves a joint to look behind it, until another time is selected. An empty state puts all back.
  void set_joints_by_hand(const JointState& joints);
  /// The joints as they are drawn.
  JointState joints() const;
  QSize sizeHint() const override { return {760, 560}; }

 Q_SIGNALS:
  void measured(const QString& text);  ///< empty = not yet
  void warned(const QString& text);
  void drawn();

 protected:
  void changeEvent(QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void take_mouse();
  /// Colours of the palette, and widths for the screen.
  void take_colors();
  void show_memory();
  const mapping::World* world_now() const;
  std::optional<TimeNs> shown_time() const;  ///< unset = the end
  void show_world(const mapping::World* world);
  void take_world(const PreparedWorld& world);
  void show_belief();
  void show_objects();
  void show_joints();
  void show_frame();
  void show_cameras();
  void read_trace();
  void show_trace();
  void read_object_cloud();
  void measure_at(int x, int y);
  void place_eye();
  void show_selection();
  void clicked(int x, int y);
  void redraw();

  Browser& browser_;
  MapCanvas* canvas_;
  std::unique_ptr<MapScene> scene_;
  std::string memory_;                     ///< path of the memory that is drawn
  const mapping::World* world_ = nullptr;  ///< its map, drawn or being prepared
  bool waits_for_world_ = false;
  bool first_view_ = true;                           ///< the eye has not been placed yet
  MapViewpoint viewpoint_ = MapViewpoint::overview;  ///< the last one chosen
  JointState joints_by_hand_;
  TimeNs joints_time_ = 0;  ///< at which they were moved by hand
  std::optional<int64_t> traced_;
  std::vector<TrajectoryPoint> trace_;  ///< of that object, at all times
  std::pair<int64_t, TimeNs> clouded_ =
      {};  ///< object and time of the observation whose points are shown; 0 = none
  std::vector<Vector3d> ruler_;
  bool measuring_ = false;
  bool own_eye_ = true;
  std::array<double, 9> drawn_eye_ = {};
  std::map<int64_t, std::array<uint8_t, 3>> marks_;
  QTimer still_;  ///< since the last change of time
};

}  // namespace loci::gui
