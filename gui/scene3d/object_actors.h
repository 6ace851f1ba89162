#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gui/scene3d/label_layer.h"
#include "gui/scene3d/scene_colors.h"
#include "mapping/base/math/pose.h"

namespace loci::gui {

/// An object as the 3D view draws it.
struct MapObject {
  int64_t id = 0;
  std::string label;
  Isometry3d map_from_object = Isometry3d::Identity();
  Vector3d size = Vector3d::Zero();  ///< full extents, metres
  std::array<uint8_t, 3> rgb = {160, 160, 160};
  bool ghost = false;                               ///< not seen at this time: drawn translucent
  double probability = 1;                           ///< a ghost is the paler the less is believed
  std::optional<std::array<uint8_t, 3>> mark = {};  ///< colour of its edges; unset = as others
};

/// Objects as oriented boxes with names. All boxes are a handful of actors: hundreds of them would cost more
/// than what they draw.
class ObjectActors {
 public:
  /// Names go to `overlay`, which is drawn over everything.
  ObjectActors(vtkRenderer* renderer, vtkRenderer* overlay);

  void set(std::vector<MapObject> objects, const SceneColors& colors);
  void select(std::optional<int64_t> id, const SceneColors& colors);
  void set_colors(const SceneColors& colors);
  /// Ghosts are blended with what was drawn before them: again the last after other actors were added.
  void draw_last();
  void set_visible(bool visible);
  void set_labels_visible(bool visible) { labels_.set_visible(visible && visible_); }
  /// For the next image: what has changed since the last one, translucent boxes from the farthest to the
  /// nearest, labels where there is room for them.
  void arrange(const Vector3d& eye);
  const LabelLayer& labels() const { return labels_; }

  const std::vector<MapObject>& objects() const { return objects_; }
  /// The object that a face (cell) of an actor belongs to.
  std::optional<int64_t> object_of(const vtkActor* actor, int64_t cell) const;
  std::optional<Eigen::AlignedBox3d> bounds() const;
  std::optional<Eigen::AlignedBox3d> bounds_of(int64_t id) const;
  std::vector<vtkActor*> pickable() const;

 private:
  /// Boxes that are drawn alike.
  struct Layer {
    vtkSmartPointer<vtkActor> actor;
    std::vector<size_t> objects;  ///< index of each box
  };
  void rebuild();

  vtkRenderer* renderer_;
  LabelLayer labels_;
  std::vector<MapObject> objects_;
  Vector3d eye_ = Vector3d::Zero();  ///< that the ghosts are sorted for
  SceneColors colors_;
  bool due_ = false, ghosts_due_ = false;
  Layer solid_, ghosts_, edges_, selected_edges_;  ///< of the last: chosen or marked
  std::optional<int64_t> selected_;
  bool visible_ = true;
};

}  // namespace loci::gui
