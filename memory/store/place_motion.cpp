#include "memory/store/place_motion.h"

#include "mapping/world/free_standing.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/urdf.h"

namespace loci::memory {
const PlaceMotions::Poses& PlaceMotions::poses(Id map) {
  const auto [slot, is_new] = poses_.try_emplace(map);
  if (!is_new) return slot->second;
  for (const MapRow& row : store_.maps()) {
    if (row.id != map) continue;
    const mapping::World world = mapping::parse_urdf(store_.blob(row.urdf).bytes, row.name);
    const std::vector<Isometry3d> map_from_links = root_from_links(world, {});
    for (size_t i = 0; i < world.links.size(); ++i) slot->second[world.links[i].name] = map_from_links[i];
  }
  return slot->second;
}

Isometry3d PlaceMotions::motion(const PlaceRow& place, std::optional<Id> map) {
  return motion(place, place.map, map);
}

Isometry3d PlaceMotions::motion(const PlaceRow& place, std::optional<Id> from, std::optional<Id> to) {
  if (!from || !to || from == to || place.joint) return Isometry3d::Identity();
  const Poses &before = poses(*from), &now = poses(*to);
  const auto stood = before.find(place.name), stands = now.find(place.name);
  if (stood == before.end() || stands == now.end()) return Isometry3d::Identity();
  const Isometry3d relative = stood->second.inverse() * stands->second;
  return is_moved(relative) ? stands->second * stood->second.inverse() : Isometry3d::Identity();
}

std::optional<Vector3d> PlaceMotions::position(const PlaceRow& place, Id map) {
  const Poses& all = poses(map);
  const auto found = all.find(place.name);
  return found == all.end() ? std::nullopt : std::optional<Vector3d>(found->second.translation());
}

bool is_moved(const Isometry3d& motion) {
  return mapping::is_furniture_motion(motion, Vector3d::Zero());
}

}  // namespace loci::memory
