#include "memory/questions/room.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/json.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

/// The map that held at the asked time, as it is stored.
struct StoredMap {
  std::string name;
  mapping::World world;
  mapping::SemanticMap semantic;
};

std::optional<StoredMap> map_of(const Snapshot& snapshot) {
  const Store& store = snapshot.store();
  const std::vector<MapRow> maps = store.maps();
  if (maps.empty()) return std::nullopt;
  const std::optional<SceneRow> latest = store.latest_scene(snapshot.as_of());
  const auto used = std::find_if(maps.begin(), maps.end(),
                                 [&](const MapRow& row) { return latest && latest->map == row.id; });
  const MapRow& row = used == maps.end() ? maps.back() : *used;
  StoredMap map{row.name, mapping::parse_urdf(store.blob(row.urdf).bytes, row.name), {}};
  if (row.sidecar)
    map.semantic =
        mapping::semantic_map_from_json(parse_json(store.blob(*row.sidecar).bytes, row.name), row.name);
  return map;
}

/// By the sidecar, else by the beginning of its name: "drawer" of "drawer_3_front".
std::string class_of(const StoredMap& map, const std::string& link) {
  const auto found = map.semantic.links.find(link);
  return found != map.semantic.links.end() ? found->second.class_name : link.substr(0, link.find('_'));
}

/// Pieces of a drawer or door are not told one by one.
bool is_piece(const StoredMap& map, const mapping::Link& link) {
  static const std::set<std::string> pieces = {"drawer_bottom", "drawer_side", "handle", "knob"};
  if (link.visuals.empty() || pieces.contains(class_of(map, link.name))) return true;
  const mapping::Joint* joint = map.world.parent_joint(link.name);
  const bool fixed = joint == nullptr || joint->type == mapping::JointType::fixed;
  const mapping::Joint* above = joint == nullptr ? nullptr : map.world.parent_joint(joint->parent);
  return fixed && above != nullptr && above->type != mapping::JointType::fixed;
}

/// The joint that moves a link: its own or that of a link which carries it; nullptr = none does.
const mapping::Joint* moving_joint(const mapping::World& world, const std::string& link) {
  const mapping::Joint* joint = world.parent_joint(link);
  while (joint != nullptr && joint->type == mapping::JointType::fixed)
    joint = world.parent_joint(joint->parent);
  return joint;
}

PartMotion motion_of(const Snapshot& snapshot, const mapping::Joint& joint) {
  return {.joint = snapshot.part_names().joint(joint.name),
          .map_joint = joint.name,
          .type = joint.type,
          .lower = joint.limits ? joint.limits->lower : 0,
          .upper = joint.limits ? joint.limits->upper : 0};
}

void set_place(const Snapshot& snapshot, const PlaceRow& place, RoomPart& part) {
  part.place = PlaceRef{place.id, place.name, place.container};
  part.height = place.height;
  for (const FactRow& fact : snapshot.facts())
    if (fact.place == place.id && fact.key == "alias" && fact.value) part.aliases.push_back(*fact.value);
}

std::vector<RoomPart> parts_of_map(const Snapshot& snapshot, const StoredMap& map) {
  const std::vector<Isometry3d> poses = root_from_links(map.world, {});
  const std::vector<PlaceRow> map_places = snapshot.store().places();  // by the names of the map
  std::vector<RoomPart> parts;
  std::set<std::string> joints;  // that have their part
  for (size_t i = 0; i < map.world.links.size(); ++i) {
    const mapping::Link& link = map.world.links[i];
    if (is_piece(map, link)) continue;
    RoomPart part{.name = snapshot.part_names().link(link.name),
                  .map_name = link.name,
                  .class_name = class_of(map, link.name),
                  .position = poses[i].translation()};
    if (const auto known = map.semantic.links.find(link.name); known != map.semantic.links.end()) {
      part.aliases = known->second.aliases;
      if (!known->second.appliance.empty()) part.aliases.push_back(known->second.appliance);
    }
    const mapping::Joint* joint = moving_joint(map.world, link.name);
    if (joint != nullptr && joints.insert(joint->name).second) part.motion = motion_of(snapshot, *joint);
    for (size_t k = 0; k < map_places.size(); ++k) {
      const PlaceRow& place = snapshot.places()[k];
      const bool is_it = map_places[k].name == link.name;
      if (is_it) part.name = place.name;
      if (is_it || (joint != nullptr && place.joint == joint->name)) set_place(snapshot, place, part);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// What they are, without what was seen of them.
std::vector<RoomPart> all_parts(const Snapshot& snapshot, const std::optional<StoredMap>& map) {
  std::vector<RoomPart> parts;
  if (map) parts = parts_of_map(snapshot, *map);
  for (const PlaceRow& place : snapshot.places()) {
    if (std::any_of(parts.begin(), parts.end(),
                    [&](const RoomPart& part) { return part.place && part.place->id == place.id; }))
      continue;
    parts.push_back({.name = place.name,
                     .map_name = place.name,
                     .class_name = place.class_name,
                     .position = centre_of(place)});
    set_place(snapshot, place, parts.back());
  }
  std::sort(parts.begin(), parts.end(), [](const RoomPart& a, const RoomPart& b) { return a.name < b.name; });
  return parts;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// "the kitchen drawers" → "drawer" of a class drawer; "drawer 1" → the beginning of drawer_1_front.
std::vector<RoomPart> parts_called(const std::vector<RoomPart>& parts, const std::string& asked) {
  const std::string name = lower(asked);
  std::string joined = name;
  std::replace(joined.begin(), joined.end(), ' ', '_');
  std::vector<RoomPart> found;
  const auto take = [&](auto matches) {
    if (found.empty()) std::copy_if(parts.begin(), parts.end(), std::back_inserter(found), matches);
  };
  const auto is_called = [&](const std::string& known) {
    return lower(known) == joined || lower(known) == name;
  };
  take([&](const RoomPart& part) {
    return is_called(part.name) || (part.place && is_called(part.place->name));
  });
  take([&](const RoomPart& part) { return is_called(part.map_name); });
  take([&](const RoomPart& part) {
    return part.motion && (is_called(part.motion->joint) || is_called(part.motion->map_joint));
  });
  take([&](const RoomPart& part) {
    return std::find(part.aliases.begin(), part.aliases.end(), name) != part.aliases.end();
  });
  take([&](const RoomPart& part) {
    return part.name.starts_with(joined + "_") || part.map_name.starts_with(joined + "_");
  });
  take([&](const RoomPart& part) { return part.class_name == joined || part.class_name + "s" == joined; });
  if (const size_t space = name.find(' '); found.empty() && space != std::string::npos)
    return parts_called(parts, name.substr(space + 1));
  return found;
}

/// How joints stood when they were seen last, and when they changed.
void add_motions(const Snapshot& snapshot, std::vector<RoomPart>& parts) {
  std::map<std::string, PartMotion*> motions;
  for (RoomPart& part : parts)
    if (part.motion) motions[part.motion->map_joint] = &*part.motion;
  if (motions.empty()) return;
  const Store& store = snapshot.store();
  if (const std::optional<SceneRow> latest = store.latest_scene(snapshot.as_of()))
    for (const auto& [name, position] : latest->joints)
      if (const auto found = motions.find(name); found != motions.end()) {
        found->second->position = position;
        found->second->seen = snapshot.scene_ref(*latest);
      }
  for (const EventRow& event : store.events(snapshot.as_of())) {
    const auto found =
        event.kind == EventKind::joint_changed && event.joint ? motions.find(*event.joint) : motions.end();
    if (found == motions.end()) continue;
    const bool opened =
        std::abs(event.joint_position.value_or(0)) > std::abs(event.from_joint_position.value_or(0));
    (opened ? found->second->opened : found->second->closed) = snapshot.change(event);
  }
}

/// What is there, and when somebody looked.
void add_contents(const Snapshot& snapshot, std::vector<RoomPart>& parts) {
  for (RoomPart& part : parts) {
    if (!part.place) continue;
    for (const Id object : snapshot.store().objects_at(part.place->id, snapshot.as_of())) {
      const BeliefRow* row = snapshot.belief(object);
      if (row != nullptr && row->place == part.place->id && row->status != ObjectStatus::gone &&
          row->probability >= 0.5)
        ++part.objects;
    }
    if (const auto look = snapshot.store().last_visibility(part.place->id, snapshot.as_of()))
      part.last_look = snapshot.scene_ref(look->scene);
  }
}

std::vector<RoomPart> asked_parts(const Snapshot& snapshot, std::vector<RoomPart> parts,
                                  const std::string& asked) {
  static const std::set<std::string> everything = {"", "room", "kitchen", "everything", "all", "anything"};
  if (everything.contains(asked)) return parts;
  std::vector<RoomPart> found = parts_called(parts, asked);
  if (!found.empty()) return found;
  std::vector<std::string> names;
  for (const RoomPart& part : parts) names.push_back(part.name);
  const std::string hint = did_you_mean(asked, names);
  throw UnknownName(UnknownName::Kind::place, fmt::format("no part of the room is called '{}'", asked),
                    {snapshot.store().path().string(), 0, {}},
                    !hint.empty() ? hint : fmt::format("known: {}", fmt::join(names, ", ")));
}

}  // namespace

bool PartMotion::open() const {
  const double way = std::max(std::abs(lower), std::abs(upper));
  return position && std::abs(*position) > 0.05 * way;
}

std::optional<mapping::World> world_of(const Snapshot& snapshot) {
  std::optional<StoredMap> map = map_of(snapshot);
  if (!map) return std::nullopt;
  return std::move(map->world);
}

std::string part_without_place(const Snapshot& snapshot, const std::string& name) {
  const std::vector<RoomPart> parts = parts_called(all_parts(snapshot, map_of(snapshot)), name);
  return parts.size() == 1 && !parts[0].place ? parts[0].name : "";
}

RoomAnswer ask(const Store& store, const RoomQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  const std::optional<StoredMap> map = map_of(snapshot);
  RoomAnswer answer{.asked = question.part, .map = map ? map->name : ""};
  answer.parts = asked_parts(snapshot, all_parts(snapshot, map), question.part);
  add_motions(snapshot, answer.parts);
  add_contents(snapshot, answer.parts);
  for (const RoomPart& part : answer.parts) ++answer.classes[part.class_name];
  return answer;
}

OpensAnswer ask(const Store& store, const OpensQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  OpensAnswer answer{.asked = question.part,
                     .parts = asked_parts(snapshot, all_parts(snapshot, map_of(snapshot)), question.part)};
  std::erase_if(answer.parts, [](const RoomPart& part) { return !part.motion; });
  add_motions(snapshot, answer.parts);
  add_contents(snapshot, answer.parts);
  return answer;
}

}  // namespace loci::memory
