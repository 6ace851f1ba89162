#include "memory/questions/environment_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <set>

#include "mapping/base/math/math.h"
#include "mapping/base/text/text.h"
#include "mapping/world/contacts.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/questions/names/names.h"
#include "memory/questions/names/related_words.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"
#include "memory/store/map_places.h"

namespace loci::memory {
namespace {

/// A map as it is stored: the texts, and what they say.
struct StoredMap {
  std::string name, urdf, sidecar;
  mapping::World world = {};
  mapping::SemanticMap semantic = {};
  std::map<std::string, Vector3d> sizes = {};  ///< by link
};

std::map<std::string, Vector3d> sizes_of(const mapping::World& world) {
  std::map<std::string, Eigen::AlignedBox3d> bounds;
  for (const mapping::SolidBox& box : mapping::solid_boxes(world))
    bounds[world.links[box.link].name].extend(bounds_of(box, Isometry3d::Identity()));
  std::map<std::string, Vector3d> sizes;
  for (const auto& [link, box] : bounds) sizes[link] = box.sizes();
  return sizes;
}

/// The map at the time asked about; nullptr = there is none. A sentence looks it up several times, and
/// parsing takes longer than all else that it needs: the last one is kept.
std::shared_ptr<const StoredMap> map_of(const Snapshot& snapshot) {
  static std::mutex mutex;
  static std::shared_ptr<const StoredMap> last;

  const Store& store = snapshot.store();
  const std::optional<MapRow> row = store.map_at(snapshot.as_of());
  if (!row) return nullptr;
  StoredMap map{row->name, store.blob(row->urdf).bytes,
                row->sidecar ? store.blob(*row->sidecar).bytes : std::string()};
  const std::lock_guard lock(mutex);
  if (last && last->name == map.name && last->urdf == map.urdf && last->sidecar == map.sidecar) return last;
  map.world = mapping::parse_urdf(map.urdf, map.name);
  if (row->sidecar)
    map.semantic = mapping::semantic_map_from_json(parse_json(map.sidecar, map.name), map.name);
  map.sizes = sizes_of(map.world);
  return last = std::make_shared<const StoredMap>(std::move(map));
}

/// By the sidecar, else by the beginning of its name: "drawer" of "drawer_3_front".
std::string class_of(const StoredMap& map, const std::string& link) {
  const auto found = map.semantic.links.find(link);
  return found != map.semantic.links.end() ? found->second.class_name : link.substr(0, link.find('_'));
}

/// Pieces of a drawer or door are not listed.
bool is_piece(const StoredMap& map, const mapping::Link& link) {
  static const std::set<std::string> pieces = {"drawer_bottom", "drawer_side", "handle", "knob"};
  if (link.visuals.empty() || pieces.contains(class_of(map, link.name))) return true;
  const mapping::Joint* joint = map.world.parent_joint(link.name);
  const bool fixed = joint == nullptr || joint->type == mapping::JointType::fixed;
  const mapping::Joint* above = joint == nullptr ? nullptr : map.world.parent_joint(joint->parent);
  return fixed && above != nullptr && above->type != mapping::JointType::fixed;
}

PartMotion motion_of(const Snapshot& snapshot, const mapping::Joint& joint) {
  constexpr double kHalfTurn = kPi;  // what turns without limits is at most that far from closed
  return {.joint = snapshot.part_names().joint(joint.name),
          .map_joint = joint.name,
          .type = joint.type,
          .lower = joint.limits ? joint.limits->lower : -kHalfTurn,
          .upper = joint.limits ? joint.limits->upper : kHalfTurn};
}

void set_place(const Snapshot& snapshot, const PlaceRow& place, EnvironmentPart& part) {
  part.place = PlaceRef{place.id, place.name, place.container};
  part.height = place.height;
  for (const FactRow& fact : snapshot.facts())
    if (fact.place == place.id && fact.key == "alias" && fact.value) part.aliases.push_back(*fact.value);
}

/// Gives a part the links that move along with it, and the place that the map has for it.
void add_pieces(const StoredMap& map, const std::vector<Isometry3d>& poses, EnvironmentPart& part) {
  for (size_t i = 0; i < map.world.links.size(); ++i) {
    const mapping::Link& link = map.world.links[i];
    const mapping::Joint* joint = moving_joint(map.world, link.name);
    const bool moves_along = part.motion && joint != nullptr && joint->name == part.motion->map_joint;
    if (moves_along && is_piece(map, link)) part.pieces.push_back(link.name);
    const auto known = map.semantic.links.find(link.name);
    if ((!moves_along && link.name != part.map_name) || known == map.semantic.links.end() || part.place ||
        part.unseen_place)
      continue;
    part.unseen_place = place_of_link(link.name, known->second, map.name);
    if (!part.unseen_place) continue;
    part.unseen_place->map_from_place = poses[i];
    if (joint != nullptr) part.unseen_place->joint = joint->name;
  }
}

std::vector<EnvironmentPart> parts_of_map(const Snapshot& snapshot, const StoredMap& map) {
  const std::vector<Isometry3d> poses = root_from_links(map.world, {});
  const std::vector<PlaceRow> map_places = snapshot.store().places();  // by the names of the map
  std::vector<EnvironmentPart> parts;
  std::set<std::string> joints;  // that have their part
  for (size_t i = 0; i < map.world.links.size(); ++i) {
    const mapping::Link& link = map.world.links[i];
    if (is_piece(map, link)) continue;
    EnvironmentPart part{.name = snapshot.part_names().link(link.name),
                         .map_name = link.name,
                         .class_name = class_of(map, link.name),
                         .position = poses[i].translation()};
    if (const auto size = map.sizes.find(link.name); size != map.sizes.end()) part.size = size->second;
    if (const auto known = map.semantic.links.find(link.name); known != map.semantic.links.end()) {
      part.aliases = known->second.aliases;
      if (!known->second.appliance.empty()) part.aliases.push_back(known->second.appliance);
    }
    const mapping::Joint* joint = moving_joint(map.world, link.name);
    if (joint != nullptr && joints.insert(joint->name).second) part.motion = motion_of(snapshot, *joint);
    for (size_t k = 0; k < map_places.size(); ++k) {
      const PlaceRow& place = snapshot.places()[k];
      const bool is_it = map_places[k].name == link.name;
      const bool is_in_it = !is_it && joint != nullptr && place.joint == joint->name;
      const bool lends_name =
          is_in_it && part.motion && part.name == link.name && place.name != map_places[k].name;
      if (is_it || lends_name) part.name = place.name;
      if (is_it || is_in_it) set_place(snapshot, place, part);
    }
    // Who names a drawer names what moves it, too.
    if (part.motion && part.name != link.name && part.motion->joint == part.motion->map_joint)
      part.motion->joint = part.name;
    add_pieces(map, poses, part);
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Where a word says at which height a part is among its like: 0 = lowest, 1 = highest.
std::optional<double> level_called(const std::string& word) {
  static const std::map<std::string, double> levels = {
      {"top", 1},       {"upper", 1},  {"uppermost", 1}, {"topmost", 1}, {"highest", 1},  {"middle", 0.5},
      {"central", 0.5}, {"bottom", 0}, {"lower", 0},     {"lowest", 0},  {"lowermost", 0}};
  const auto found = levels.find(word);
  return found == levels.end() ? std::nullopt : std::optional(found->second);
}

/// Keeps the parts at one level, all where they are at the same; none where there is none between the others,
/// or a height is not known.
void keep_level(double level, std::vector<EnvironmentPart>& parts) {
  constexpr double kSameLevel = 0.05;
  std::vector<double> heights;
  for (const EnvironmentPart& part : parts)
    heights.push_back(part.position ? part.position->z() : std::numeric_limits<double>::quiet_NaN());
  if (std::ranges::any_of(heights, [](double height) { return std::isnan(height); })) return parts.clear();
  std::vector<double> levels;
  std::ranges::sort(heights);
  for (const double height : heights)
    if (levels.empty() || height > levels.back() + kSameLevel) levels.push_back(height);
  const double index = level * static_cast<double>(levels.size() - 1);
  if (levels.empty() || index != std::floor(index)) return parts.clear();
  const double bottom = levels[static_cast<size_t>(index)];
  std::erase_if(parts, [&](const EnvironmentPart& part) {
    return part.position->z() < bottom || part.position->z() > bottom + kSameLevel;
  });
}

/// Keeps the one of which there is most; a surface is as high as it is above the floor.
void keep_most(SizeMeasure measure, std::vector<EnvironmentPart>& parts) {
  std::erase_if(parts, [](const EnvironmentPart& part) { return !part.size; });
  if (parts.empty()) return;
  parts = {*std::ranges::max_element(parts, {}, [&](const EnvironmentPart& part) {
    return measure({part.size->x(), part.size->y(), part.height.value_or(part.size->z())});
  })};
}

/// See parts_named().
std::vector<EnvironmentPart> named_exactly(const std::vector<EnvironmentPart>& parts,
                                           const std::string& asked) {
  std::vector<EnvironmentPart> found;
  const auto take = [&](auto matches) {
    if (found.empty()) std::copy_if(parts.begin(), parts.end(), std::back_inserter(found), matches);
  };
  const auto is_called = [key = name_key(asked)](const std::string& known) { return name_key(known) == key; };
  take([&](const EnvironmentPart& part) {
    return is_called(part.name) || (part.place && is_called(part.place->name));
  });
  take([&](const EnvironmentPart& part) { return is_called(part.map_name); });
  take([&](const EnvironmentPart& part) {
    return part.motion && (is_called(part.motion->joint) || is_called(part.motion->map_joint));
  });
  take([&](const EnvironmentPart& part) { return std::ranges::any_of(part.aliases, is_called); });
  take([&](const EnvironmentPart& part) {
    return is_called(piece_in_words(part.map_name)) || std::ranges::any_of(part.pieces, is_called);
  });
  return found;
}

/// "drawer" of a class drawer; "drawer 1" → the beginning of drawer_1_front.
std::vector<EnvironmentPart> by_all_words(const std::vector<EnvironmentPart>& parts,
                                          const std::string& asked) {
  const std::string name = lower_case(asked);
  std::string joined = name;
  std::replace(joined.begin(), joined.end(), ' ', '_');
  std::vector<EnvironmentPart> found = named_exactly(parts, asked);
  const auto take = [&](auto matches) {
    if (found.empty()) std::copy_if(parts.begin(), parts.end(), std::back_inserter(found), matches);
  };
  take([&](const EnvironmentPart& part) {
    return part.name.starts_with(joined + "_") || part.map_name.starts_with(joined + "_");
  });
  take([&](const EnvironmentPart& part) {
    return part.class_name == joined || part.class_name + "s" == joined;
  });
  // "north counter" is counter_north.
  const std::vector<std::string> asked_words = words_of(name);
  if (asked_words.size() > 1)
    take([&](const EnvironmentPart& part) {
      const std::vector<std::string> words = words_of(lower_case(part.name), "_");
      return std::ranges::all_of(
          asked_words, [&](const std::string& word) { return std::ranges::count(words, word) > 0; });
    });
  if (!found.empty()) return found;
  if (const std::string singular = singular_of(name); singular != name) return by_all_words(parts, singular);
  const std::string other = furniture_called(name);
  return other.empty() ? found : by_all_words(parts, other);
}

/// The first word of a name and the others: "widest drawer", "kitchen drawer"; not "mugs on counter". Unset
/// where it is one word, or another thing than its last words.
std::optional<std::pair<std::string, std::string>> first_and_rest(const std::string& name) {
  const bool of_place = std::ranges::any_of(
      words_of(name), [](const std::string& word) { return word == "on" || word == "in" || word == "at"; });
  const size_t space = name.find(' ');
  if (space == std::string::npos || of_place) return std::nullopt;
  std::pair words(name.substr(0, space), name.substr(space + 1));
  return is_other_thing(words.first, words.second) ? std::nullopt : std::optional(std::move(words));
}

/// "the kitchen drawers" → any drawer.
std::vector<EnvironmentPart> parts_called(const std::vector<EnvironmentPart>& parts,
                                          const std::string& asked) {
  std::vector<EnvironmentPart> found = by_all_words(parts, asked);
  const auto words = first_and_rest(lower_case(asked));
  if (!found.empty() || !words) return found;
  const auto& [first, rest] = *words;
  found = parts_called(parts, rest);
  if (const auto level = level_called(first)) keep_level(*level, found);
  if (const auto measure = superlatives().find(first); measure != superlatives().end())
    keep_most(measure->second, found);
  return found;
}

/// How joints stood when they were seen next, unless a look of that minute showed it.
void add_next_looks(const Snapshot& snapshot, TimeNs moment, std::map<std::string, PartMotion*> motions) {
  const Store& store = snapshot.store();
  const AsOf known{.at = {}, .known_at = snapshot.as_of().known_at};
  TimeNs end = moment;
  std::erase_if(motions, [&](const auto& one) {
    const std::optional<SceneRow> last = store.latest_scene_of_joint(one.first, known);
    if (last) end = std::max(end, last->time);
    const bool shown = one.second->seen && moment - one.second->seen->time < kMinute;
    return shown || !last || last->time <= moment;
  });
  // Few scenes are read where the next look is near.
  TimeNs span = kHour;
  for (TimeNs from = moment + 1; from <= end && !motions.empty(); from += span, span *= 4)
    for (const SceneRow& scene : store.scenes(known, from, from + span - 1))
      std::erase_if(motions, [&](const auto& one) {
        const auto position = scene.joints.find(one.first);
        if (position == scene.joints.end()) return false;
        one.second->next_position = position->second;
        one.second->next_seen = snapshot.scene_ref(scene);
        return true;
      });
}

/// How joints stood when they were seen last, and when they changed.
void add_motions(const Snapshot& snapshot, std::vector<EnvironmentPart>& parts) {
  std::map<std::string, PartMotion*> motions;
  for (EnvironmentPart& part : parts)
    if (part.motion) motions[part.motion->map_joint] = &*part.motion;
  if (motions.empty()) return;
  const Store& store = snapshot.store();
  for (const auto& [name, motion] : motions) {
    const std::optional<SceneRow> latest = store.latest_scene_of_joint(name, snapshot.as_of());
    if (!latest) continue;
    motion->position = latest->joints.at(name);
    motion->seen = snapshot.scene_ref(*latest);
  }
  if (const std::optional<TimeNs> moment = snapshot.as_of().at) add_next_looks(snapshot, *moment, motions);
  for (const EventRow& event : store.events(snapshot.as_of())) {
    const auto found =
        event.kind == EventKind::joint_changed && event.joint ? motions.find(*event.joint) : motions.end();
    if (found == motions.end()) continue;
    const Change change = snapshot.change(event);
    (is_opening(change) ? found->second->opened : found->second->closed) = change;
  }
}

void add_contents(const Snapshot& snapshot, std::vector<EnvironmentPart>& parts) {
  for (EnvironmentPart& part : parts) {
    if (!part.place) continue;
    for (const Id object : snapshot.store().objects_at(part.place->id, snapshot.as_of())) {
      const BeliefRow* row = snapshot.belief(object);
      if (row != nullptr && row->place == part.place->id && replies::is_there(snapshot.object_belief(*row)))
        ++part.objects;
    }
    if (const auto look = snapshot.store().last_visibility(part.place->id, snapshot.as_of()))
      part.last_view = snapshot.scene_ref(look->scene);
  }
}

}  // namespace

bool PartMotion::is_open(double at) const {
  const double range = std::max(std::abs(lower), std::abs(upper));
  return std::abs(at) > 0.05 * range;
}

std::optional<bool> PartMotion::open() const {
  if (!position) return std::nullopt;
  const bool before = is_open(*position);
  return next_position && is_open(*next_position) != before ? std::nullopt : std::optional(before);
}

std::vector<EnvironmentPart> all_parts(const Snapshot& snapshot) {
  const std::shared_ptr<const StoredMap> map = map_of(snapshot);
  std::vector<EnvironmentPart> parts;
  if (map) parts = parts_of_map(snapshot, *map);
  for (EnvironmentPart& part : parts)
    if (part.unseen_place) part.unseen_place->map = snapshot.store().map_at(snapshot.as_of())->id;
  for (const PlaceRow& place : snapshot.places()) {
    if (std::any_of(parts.begin(), parts.end(),
                    [&](const EnvironmentPart& part) { return part.place && part.place->id == place.id; }))
      continue;
    if (map && place.map) continue;  // it is in an earlier or later map only
    parts.push_back({.name = place.name,
                     .map_name = place.name,
                     .class_name = place.class_name,
                     .position = centre_of(place)});
    set_place(snapshot, place, parts.back());
  }
  std::sort(parts.begin(), parts.end(),
            [](const EnvironmentPart& a, const EnvironmentPart& b) { return a.name < b.name; });
  return parts;
}

std::vector<EnvironmentPart> parts_named(const Snapshot& snapshot, const std::string& name) {
  return named_exactly(snapshot.parts(), name);
}

std::vector<EnvironmentPart> find_parts(const Snapshot& snapshot, const std::string& asked) {
  static const std::set<std::string> everything = {"", "room", "kitchen", "everything", "all", "anything"};
  const std::vector<EnvironmentPart>& parts = snapshot.parts();
  if (everything.contains(asked)) return parts;
  std::vector<EnvironmentPart> found = parts_called(parts, asked);
  if (!found.empty()) return found;
  std::vector<std::string> names;
  for (const EnvironmentPart& part : parts) names.push_back(part.name);
  const std::string hint = did_you_mean(asked, names);
  throw UnknownName(UnknownName::Kind::place, fmt::format("no part of the room is called '{}'", asked),
                    {snapshot.store().name(), 0, {}},
                    !hint.empty() ? hint : fmt::format("known: {}", fmt::join(names, ", ")));
}

std::string kind_meant(const Snapshot& snapshot, const std::string& name) {
  const auto words = first_and_rest(lower_case(name));
  if (!words || !by_all_words(snapshot.parts(), name).empty()) return "";
  const auto& [first, rest] = *words;
  if (with_article(name) == name) return kind_meant(snapshot, rest);
  const bool picks = level_called(first) || is_superlative(first);
  if (picks || parts_called(snapshot.parts(), rest).empty()) return "";
  const std::string shorter = kind_meant(snapshot, rest);
  return shorter.empty() ? singular_of_furniture(rest) : shorter;
}

void add_states(const Snapshot& snapshot, std::vector<EnvironmentPart>& parts) {
  add_motions(snapshot, parts);
  add_contents(snapshot, parts);
}

std::string map_name(const Snapshot& snapshot) {
  const std::shared_ptr<const StoredMap> map = map_of(snapshot);
  return map ? map->name : "";
}

std::optional<mapping::World> world_of(const Snapshot& snapshot) {
  const std::shared_ptr<const StoredMap> map = map_of(snapshot);
  if (!map) return std::nullopt;
  return map->world;
}

std::optional<EnvironmentPart> find_part_without_place(const Snapshot& snapshot, const std::string& name) {
  const std::vector<EnvironmentPart> parts = parts_called(snapshot.parts(), name);
  const bool has_place =
      std::ranges::any_of(parts, [](const EnvironmentPart& part) { return part.place.has_value(); });
  return parts.empty() || has_place ? std::nullopt : std::optional(parts[0]);
}

std::vector<Id> find_places_by_level(const Snapshot& snapshot, const std::string& name) {
  std::vector<Id> places;
  if (!level_called(name.substr(0, name.find(' ')))) return places;
  for (const EnvironmentPart& part : parts_called(snapshot.parts(), name))
    if (part.place) places.push_back(part.place->id);
  return places;
}

std::set<std::string> joints_called(const Snapshot& snapshot, const std::string& name) {
  std::set<std::string> joints;
  for (const EnvironmentPart& part : parts_called(snapshot.parts(), name))
    if (part.motion) joints.insert(part.motion->map_joint);
  return joints;
}

bool is_joint_seen(const Store& store, const std::string& joint, AsOf as_of, std::optional<TimeNs> from,
                   std::optional<TimeNs> to) {
  if (to && (!as_of.at || *to < *as_of.at)) as_of.at = to;
  const std::optional<SceneRow> last = store.latest_scene_of_joint(joint, as_of);
  return last && (!from || last->time >= *from);
}

}  // namespace loci::memory
