#pragma once

#include <vtkActor.h>
#include <vtkPlane.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <optional>
#include <string>
#include <vector>

#include "gui/scene3d/scene_colors.h"
#include "mapping/base/math/pose.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::gui {

/// A world's surfaces as VTK takes them: made in any thread, which takes a while for large meshes.
struct PreparedWorld {
  struct Part {
    std::string link;
    vtkSmartPointer<vtkPolyData> surface, edges;
    Eigen::AlignedBox3d box;   ///< in the link's frame
    bool see_through = false;  ///< any of it
  };
  std::vector<Part> links;  ///< as in the world
  std::vector<std::string> warnings;
};
/// Links without a material take `colors.world`.
PreparedWorld prepare_world(const mapping::World& world, const mapping::MeshSearch& search,
                            const SceneColors& colors);

/// The map as actors, one surface and one set of edges per link, moved by the joints.
class WorldActors {
 public:
  explicit WorldActors(vtkRenderer* renderer) : renderer_(renderer) {}

  /// Replaces the world.
  void set(const mapping::World& world, const PreparedWorld& prepared, const SceneColors& colors);
  void clear();
  /// Adds a place that is no link: a translucent area with its edge. Does not move.
  void add_outline(const std::string& name, const std::vector<Vector2d>& outline, double height,
                   const SceneColors& colors);
  void set_joints(const JointState& state);
  void set_colors(const SceneColors& colors);
  void set_visible(bool visible);
  /// Emphasises a link and what hangs on it ("" = none).
  void select(const std::string& link, const SceneColors& colors);

  /// Cuts away what lies behind a plane; nullptr = nothing.
  void set_section(vtkPlane* plane);

  /// Shows what is worth drawing: neither what is out of view nor walls and ceilings that stand between the
  /// eye and the middle of the world. `planes` bound the view, inwards: normal and distance.
  void arrange(const Vector3d& eye, const std::vector<Eigen::Vector4d>& planes);

  /// The link an actor draws; nullptr for another actor.
  const std::string* link_of(const vtkActor* actor) const;
  /// Map-frame corners (minimum, maximum) of everything, or of one link; unset when there is nothing.
  std::optional<Eigen::AlignedBox3d> bounds() const;
  std::optional<Eigen::AlignedBox3d> bounds_of(const std::string& link) const;
  std::vector<vtkActor*> pickable() const;

 private:
  struct LinkActors {
    std::string name;
    vtkSmartPointer<vtkActor> surface, edges;
    Isometry3d map_from_link = Isometry3d::Identity();
    Eigen::AlignedBox3d box;      ///< in the link's frame
    Eigen::AlignedBox3d map_box;  ///< around that, in the map frame
    bool shell = false;           ///< wall or ceiling
  };

  void take_boxes();
  void cut(const LinkActors& link) const;
  bool hides_the_room(const LinkActors& link, const Vector3d& eye) const;

  vtkRenderer* renderer_;
  mapping::World world_;
  std::vector<LinkActors> links_;
  Eigen::AlignedBox3d all_;            ///< around all links
  vtkSmartPointer<vtkPlane> section_;  ///< null = none
  bool visible_ = true;
};

}  // namespace loci::gui
