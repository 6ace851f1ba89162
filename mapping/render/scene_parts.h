#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/math/pose.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh.h"

namespace loci::mapping::render_detail {

/// One world of a scene; free triangles are a world of one link.
struct ScenePart {
  std::shared_ptr<const World> world;  ///< kept for its joints; copies share it
  Isometry3d map_from_part = Isometry3d::Identity();
  std::vector<Isometry3d> part_from_links = {};
  size_t first_link = 0;
  bool visible = true;
};

/// The worlds of a scene and the numbers and names of their links: what RenderScene and RayScene share.
class SceneParts {
 public:
  size_t add(World world, const Isometry3d& map_from_part);
  /// A world of one link.
  size_t add(const std::string& name, const Isometry3d& map_from_part);

  /// The same world once more.
  size_t add_copy(size_t number, const Isometry3d& map_from_part);

  /// Error for a number that does not exist.
  ScenePart& part(size_t number);
  const ScenePart& part_of_link(size_t link) const { return parts_[part_of_link_[link]]; }
  void set_joints(size_t number, const JointState& state);
  /// A world of the same links. Error when their number differs.
  void set_world(size_t number, World world);

  /// Names by link id, see RenderScene::link_names().
  const std::vector<std::string>& names() const { return names_; }
  Isometry3d map_from_link(size_t link) const;

 private:
  struct Uses {
    size_t first = 0;  ///< link id
    size_t count = 0;
  };

  size_t add(std::shared_ptr<const World> world, const Isometry3d& map_from_part);
  void name_link(size_t link);

  std::vector<ScenePart> parts_;
  std::vector<size_t> part_of_link_;                 ///< by link id
  std::vector<std::string> names_;                   ///< by link id, as shown
  std::unordered_map<std::string, Uses> bare_uses_;  ///< by "LINK"
  std::unordered_map<std::string, Uses> full_uses_;  ///< by "WORLD/LINK"
};

/// Calls `use` with each visual of a world as triangles in the visual's frame; `link` counts within the
/// world. A mesh file is loaded once; a missing one is warned about by name.
void for_each_visual(
    const World& world, const MeshSearch& search, Warnings& warnings,
    const std::function<void(size_t link, const Visual& visual, const TriangleMesh& mesh)>& use);

/// Colour of each triangle of a mesh, red green blue: one for all, or one per triangle. `color` (of the URDF)
/// goes before the mesh's own; without any it is grey.
std::vector<std::array<uint8_t, 3>> triangle_colors(const TriangleMesh& mesh,
                                                    const std::optional<Rgba>& color);

}  // namespace loci::mapping::render_detail
