#pragma once

#include <QImage>
#include <QTimer>
#include <QWidget>
#include <memory>

#include "gui/browser.h"
#include "gui/scene3d/map_scene.h"
#include "gui/views/map_canvas.h"

namespace loci {

struct PreparedWorld;

/// The 3D view: map, objects at their believed place, cloud and camera of the chosen scene.
class MapView : public QWidget {
  Q_OBJECT

 public:
  /// Error when the backend cannot draw.
  MapView(Browser& browser, MapBackend backend, QWidget* parent = nullptr);
  ~MapView() override;

  MapScene& scene() { return *scene_; }
  MapCanvas& canvas() { return *canvas_; }
  /// What is on the screen. Error when the picture is blank: nothing was drawn.
  QImage picture();
  void frame_selection();
  void look_from(MapViewpoint viewpoint);
  void set_layer(MapLayer layer, bool visible);
  void change_point_size(int steps);
  QSize sizeHint() const override { return {760, 560}; }

 Q_SIGNALS:
  void warned(const QString& text);
  void drawn();

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void take_mouse();
  void show_memory();
  void take_world(const PreparedWorld& world);
  void show_belief();
  void show_joints();
  void show_frame();
  void place_eye();
  void show_selection();
  void clicked(int x, int y);
  void redraw();

  Browser& browser_;
  MapCanvas* canvas_;
  std::unique_ptr<MapScene> scene_;
  std::string memory_;            ///< path of the memory that is drawn
  const World* world_ = nullptr;  ///< its map, drawn or being prepared
  bool waits_for_world_ = false;
  bool first_look_ = true;  ///< the eye has not been placed yet
  QTimer still_;            ///< since the last change of time
};

}  // namespace loci
