#include "memory/exchange/marker_layers.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "mapping/image/hsv.h"
#include "mapping/world/kinematics.h"
#include "memory/questions/names/names.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

using mapping::Marker;
using mapping::MarkerLayer;

/// The visual geometry of a link as one marker in the link's frame; without points when it has none.
Marker marker_of(const mapping::Link& link, const mapping::MeshSearch& search, Warnings& warnings) {
  Marker marker{.group = link.name, .shape = Marker::Shape::triangles, .text = {}};
  for (const mapping::Visual& visual : link.visuals) {
    const mapping::TriangleMesh mesh = triangulate(visual.geometry, search, warnings);
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      Marker::Color color = marker.color;
      if (visual.material && visual.material->color)  // It says more than the mesh file, as in RViz.
        color = *visual.material->color;
      else if (!mesh.colors.empty())
        color = mesh.colors[t];
      for (const uint32_t corner : mesh.triangles[t]) {
        marker.points.emplace_back(visual.link_from_visual * mesh.vertices[corner].cast<double>());
        marker.point_colors.push_back(color);
      }
    }
  }
  return marker;
}

/// The links of a map that are drawn, and those that move with the joints.
class MapMarkers {
 public:
  MapMarkers(mapping::World map, const mapping::MeshSearch& search, Warnings& warnings)
      : map_(std::move(map)) {
    moving_ = moving_links(map_);
    for (size_t i = 0; i < map_.links.size(); ++i)
      if (Marker marker = marker_of(map_.links[i], search, warnings); !marker.points.empty())
        links_.emplace_back(i, std::move(marker));
  }

  std::vector<Marker> markers(bool moving, const JointState& joints) const {
    const std::vector<Isometry3d> map_from_links = root_from_links(map_, joints);
    std::vector<Marker> markers;
    for (const auto& [link, marker] : links_) {
      if (moving_[link] != moving) continue;
      markers.push_back(marker);
      markers.back().map_from_marker = map_from_links[link];
    }
    return markers;
  }
  /// Those of a recording's joints that the map has.
  JointState known(JointState joints) const { return joints_of_world(map_, std::move(joints)); }

 private:
  mapping::World map_;
  std::vector<bool> moving_;
  std::vector<std::pair<size_t, Marker>> links_;
};

/// Box and name of an object; nothing without a position.
void add_object(const Store& store, const Snapshot& snapshot, const BeliefRow& belief,
                std::vector<Marker>& markers) {
  constexpr double kCapital = 0.04;      // m
  constexpr double kUnknownSize = 0.05;  // m
  constexpr float kPalest = 0.25F;
  const std::optional<ObservationRow> seen =
      belief.last_observation ? std::optional(store.observation(*belief.last_observation)) : std::nullopt;
  const std::optional<BelievedBox> box = believed_box(belief, seen ? &*seen : nullptr);
  if (!box) return;
  Marker marker{.group = "object", .id = static_cast<int>(belief.object), .text = {}};
  marker.map_from_marker = box->map_from_box;
  marker.size = box->size.value_or(Vector3d::Constant(kUnknownSize));
  if (belief.hsv) {
    const auto rgb = mapping::rgb_from_hsv(belief.hsv->hue, belief.hsv->saturation, belief.hsv->value);
    marker.color = {rgb[0], rgb[1], rgb[2], 1};
  }
  marker.color.w() = std::max(kPalest, static_cast<float>(belief.probability));
  Marker name{.group = "name", .id = marker.id, .shape = Marker::Shape::text, .text = {}};
  name.map_from_marker.translation() =
      box->map_from_box.translation() + Vector3d(0, 0, marker.size.norm() / 2 + kCapital);
  name.size = {0, 0, kCapital};
  name.color = {1, 1, 1, 1};
  name.text = Names(snapshot).of(snapshot.object_ref(belief.object));
  markers.push_back(std::move(marker));
  markers.push_back(std::move(name));
}

}  // namespace

std::vector<MarkerLayer> map_layers(const mapping::World& map, const mapping::MeshSearch& search,
                                    Warnings& warnings) {
  const auto markers = std::make_shared<MapMarkers>(map, search, warnings);
  const auto still = [markers, drawn = false](const mapping::RgbdFrame&) mutable {
    std::optional<std::vector<Marker>> changed;
    if (!std::exchange(drawn, true)) changed = markers->markers(false, {});
    return changed;
  };
  const auto moving = [markers,
                       drawn = std::optional<JointState>()](const mapping::RgbdFrame& frame) mutable {
    std::optional<std::vector<Marker>> changed;
    const JointState joints = markers->known(frame.joints);
    if (drawn != joints) changed = markers->markers(true, joints);
    drawn = joints;
    return changed;
  };
  return {{"/map", still}, {"/map/moving", moving}};
}

MarkerLayer object_layer(const Store& store) {
  std::vector<TimeNs> scenes;
  for (const SceneRow& scene : store.scenes()) scenes.push_back(scene.time);
  std::ranges::sort(scenes);
  const auto at = [&store, scenes, drawn = std::optional<size_t>()](const mapping::RgbdFrame& frame) mutable {
    std::optional<std::vector<Marker>> markers;
    const auto scenes_so_far =
        static_cast<size_t>(std::ranges::upper_bound(scenes, frame.time_ns) - scenes.begin());
    if (drawn == scenes_so_far) return markers;
    drawn = scenes_so_far;
    markers.emplace();
    if (scenes_so_far == 0) return markers;
    const Snapshot snapshot(store, {.at = frame.time_ns});
    for (const BeliefRow& belief : snapshot.beliefs())
      if (belief.status != ObjectStatus::gone) add_object(store, snapshot, belief, *markers);
    return markers;
  };
  return {"/objects", at};
}

}  // namespace loci::memory
