#include "mapping/render/scene_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace loci::mapping::render_detail {
namespace {

constexpr float kDefaultGrey = 0.7f;

std::array<uint8_t, 3> rgb_from(const Rgba& color) {
  const auto byte = [](float value) {
    return static_cast<uint8_t>(std::lround(std::clamp(value, 0.f, 1.f) * 255.f));
  };
  return {byte(color[0]), byte(color[1]), byte(color[2])};
}

}  // namespace

size_t SceneParts::add(World world, const Isometry3d& map_from_part) {
  return add(std::make_shared<const World>(std::move(world)), map_from_part);
}

size_t SceneParts::add_copy(size_t number, const Isometry3d& map_from_part) {
  return add(part(number).world, map_from_part);
}

size_t SceneParts::add(std::shared_ptr<const World> world, const Isometry3d& map_from_part) {
  ScenePart added{std::move(world), map_from_part};
  added.first_link = part_of_link_.size();
  added.part_from_links = root_from_links(*added.world, {});
  part_of_link_.insert(part_of_link_.end(), added.world->links.size(), parts_.size());
  parts_.push_back(std::move(added));
  for (size_t link = names_.size(); link < part_of_link_.size(); ++link) name_link(link);
  return parts_.size() - 1;
}

size_t SceneParts::add(const std::string& name, const Isometry3d& map_from_part) {
  World world;
  world.name = world.root = name;
  world.links.emplace_back().name = name;
  return add(std::move(world), map_from_part);
}

ScenePart& SceneParts::part(size_t number) {
  if (number >= parts_.size()) throw Error("the scene has no part " + std::to_string(number));
  return parts_[number];
}

void SceneParts::set_joints(size_t number, const JointState& state) {
  ScenePart& changed = part(number);
  changed.part_from_links = root_from_links(*changed.world, state);
}

void SceneParts::set_world(size_t number, World world) {
  ScenePart& changed = part(number);
  if (world.links.size() != changed.world->links.size())
    throw Error("a part of a scene keeps its links: it has " + std::to_string(changed.world->links.size()) +
                ", not " + std::to_string(world.links.size()));
  changed.world = std::make_shared<const World>(std::move(world));
  changed.part_from_links = root_from_links(*changed.world, {});
}

Isometry3d SceneParts::map_from_link(size_t link) const {
  if (link >= part_of_link_.size()) throw Error("the scene has no link " + std::to_string(link));
  const ScenePart& owner = part_of_link(link);
  return owner.map_from_part * owner.part_from_links[link - owner.first_link];
}

/// Names the last link: its own name; where that repeats the world's name in front; where that repeats, too,
/// the part's number. A link that had a name alone until now is named again.
void SceneParts::name_link(size_t link) {
  const auto bare_name = [&](size_t id) {
    const ScenePart& owner = part_of_link(id);
    return owner.world->links[id - owner.first_link].name;
  };
  const auto full_name = [&](size_t id) { return part_of_link(id).world->name + "/" + bare_name(id); };
  const auto name = [&](size_t id) {
    if (bare_uses_[bare_name(id)].count == 1) return bare_name(id);
    if (full_uses_[full_name(id)].count == 1) return full_name(id);
    return part_of_link(id).world->name + "#" + std::to_string(part_of_link_[id]) + "/" + bare_name(id);
  };
  Uses& bare = bare_uses_.try_emplace(bare_name(link), Uses{link, 0}).first->second;
  Uses& full = full_uses_.try_emplace(full_name(link), Uses{link, 0}).first->second;
  ++bare.count;
  ++full.count;
  names_.push_back(name(link));
  if (bare.count == 2) names_[bare.first] = name(bare.first);
  if (full.count == 2) names_[full.first] = name(full.first);
}

void for_each_visual(
    const World& world, const MeshSearch& search, Warnings& warnings,
    const std::function<void(size_t link, const Visual& visual, const TriangleMesh& mesh)>& use) {
  std::map<std::string, TriangleMesh> loaded;  // A mesh is often used many times.
  for (size_t link = 0; link < world.links.size(); ++link)
    for (const Visual& visual : world.links[link].visuals) {
      const Mesh* mesh = std::get_if<Mesh>(&visual.geometry);
      if (mesh == nullptr) {
        use(link, visual, triangulate(visual.geometry, search, warnings));
        continue;
      }
      const Vector3d& s = mesh->scale;
      const std::string key =
          mesh->uri + " " + std::to_string(s.x()) + " " + std::to_string(s.y()) + " " + std::to_string(s.z());
      if (!loaded.contains(key)) loaded[key] = load_mesh(*mesh, search, warnings);
      use(link, visual, loaded[key]);
    }
}

std::vector<std::array<uint8_t, 3>> triangle_colors(const TriangleMesh& mesh,
                                                    const std::optional<Rgba>& color) {
  if (color || mesh.colors.size() != mesh.triangles.size())
    return {rgb_from(color.value_or(Rgba(kDefaultGrey, kDefaultGrey, kDefaultGrey, 1)))};
  std::vector<std::array<uint8_t, 3>> colors;
  colors.reserve(mesh.colors.size());
  for (const Rgba& own : mesh.colors) colors.push_back(rgb_from(own));
  return colors;
}

}  // namespace loci::mapping::render_detail
