#include "memory/questions/place_names.h"

#include "mapping/world/urdf.h"
#include "memory/questions/part_names.h"

namespace loci::memory {

void take_place_names(std::vector<PlaceRow>& places, const std::vector<FactRow>& facts) {
  for (const FactRow& fact : facts) {
    if (!fact.place || !fact.value || fact.key != kPlaceNameKey) continue;
    for (PlaceRow& place : places)
      if (place.id == *fact.place) place.name = *fact.value;
  }
}

std::vector<PlaceRow> named_places(const Store& store) {
  std::vector<PlaceRow> places = store.places();
  take_place_names(places, store.facts());
  return places;
}

std::optional<mapping::World> named_map(const Store& store) {
  const std::vector<MapRow> maps = store.maps();
  if (maps.empty()) return std::nullopt;
  mapping::World world = mapping::parse_urdf(store.blob(maps.back().urdf).bytes, maps.back().name);
  const std::vector<PlaceRow> before = store.places(), now = named_places(store);
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i].name == now[i].name || world.find_link(now[i].name) != nullptr) continue;
    const auto rename = [&](std::string& link) {
      if (link == before[i].name) link = now[i].name;
    };
    for (mapping::Link& link : world.links) rename(link.name);
    for (mapping::Joint& joint : world.joints) {
      rename(joint.parent);
      rename(joint.child);
    }
    rename(world.root);
  }
  take_part_names(world, part_names(store));
  return world;
}

}  // namespace loci::memory
