#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gui/scene3d/scene_colors.h"
#include "mapping/base/math/pose.h"
#include "mapping/sensor/camera.h"
#include "mapping/sensor/colored_mesh.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

class vtkRenderer;
class vtkRenderWindow;

namespace loci::gui {

struct MapObject;
struct ColoredCloud;
struct PreparedWorld;

/// What can be shown and hidden.
enum class MapLayer { map, room, objects, labels, cloud, camera, trace, cameras };

/// Where to look from.
enum class MapViewpoint { overview, top, front, left };

/// What of the map and the cloud is shown: all on one side of a plane across an axis of the map.
struct MapSection {
  int axis = 2;       ///< 0 = x, 1 = y, 2 = z
  double at = 0;      ///< metres along it
  bool below = true;  ///< the lower side is shown, else the upper one
};

/// What lies under a pixel.
struct MapPick {
  std::optional<int64_t> object;
  std::string link;  ///< empty = none
};

/// The 3D scene: map, objects, the frame of the selected time. Knows VTK but no Qt, so that it can be drawn
/// into any render window, with or without a screen.
class MapScene {
 public:
  explicit MapScene(vtkRenderWindow* window);
  ~MapScene();
  MapScene(const MapScene&) = delete;
  MapScene& operator=(const MapScene&) = delete;

  void set_world(const mapping::World& world, const PreparedWorld& prepared);
  void clear_world();
  /// The room as it was seen, map frame.
  void set_room(const mapping::ColoredMesh& mesh);
  /// A place that is no link of a map: a flat outline (map frame) at a height.
  void add_place(const std::string& name, const std::vector<Vector2d>& outline, double height);
  /// A joint that the map does not have is left out and added to the warnings.
  void set_joints(const JointState& state, Warnings& warnings);
  void set_objects(std::vector<MapObject> objects);
  void set_cloud(const ColoredCloud& cloud);
  /// What is known of the selected object's surface.
  void set_object_cloud(const ColoredCloud& cloud);
  size_t object_point_count() const;
  void set_camera(const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera);
  void clear_frame();
  /// The trajectory of the selected object, in order of time.
  void set_trace(std::vector<Vector3d> points);
  const std::vector<Vector3d>& trace() const;
  /// Camera poses of all scenes (map_from_camera).
  void set_cameras(const std::vector<Isometry3d>& cameras);
  /// Up to two points that are measured between.
  void set_ruler(const std::vector<Vector3d>& points);
  void set_section(const std::optional<MapSection>& section);
  void set_colors(const SceneColors& colors);
  const SceneColors& colors() const;

  void select_object(std::optional<int64_t> id);
  void select_link(const std::string& link);
  void set_layer(MapLayer layer, bool visible);
  bool layer(MapLayer layer) const;
  /// Pixels, 1 to 10.
  void set_point_size(double size);
  double point_size() const;

  /// The side from which an overview looks: horizontal direction from the objects towards the eye.
  void set_overview_side(const Vector3d& towards_eye);
  void look_from(MapViewpoint viewpoint);
  /// Shares the camera of another scene from now on.
  void share_eye_of(MapScene& other);
  /// Position, focal point and up vector of the camera: nine numbers.
  std::array<double, 9> eye() const;
  /// Moves the eye along its line of sight so that the selection (or all, when nothing is selected) fills the
  /// view.
  void frame_selection();

  /// While the view moves, speed counts for more than smooth edges.
  void set_moving(bool moving);

  /// `x`, `y` in pixels from the lower left corner.
  MapPick pick(int x, int y);
  /// The place in the map that is seen at a pixel; unset = nothing is.
  std::optional<Vector3d> pick_point(int x, int y);
  /// Around map, objects and frame; empty when nothing is shown.
  Eigen::AlignedBox3d bounds() const;
  const std::vector<MapObject>& objects() const;
  size_t point_count() const;
  std::vector<std::string> shown_labels() const;
  std::optional<int64_t> selected_object() const;
  vtkRenderer* renderer() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::gui
