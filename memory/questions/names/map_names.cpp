#include "memory/questions/names/map_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/world/urdf.h"
#include "memory/store/run_configuration.h"

namespace loci::memory {
namespace {

const std::string& name_in(const std::map<std::string, std::string>& names, const std::string& name) {
  const auto found = names.find(name);
  return found == names.end() ? name : found->second;
}

void rename_parts(mapping::World& world, const PartNames& names) {
  for (mapping::Link& link : world.links) link.name = names.link(link.name);
  for (mapping::Joint& joint : world.joints) {
    joint.name = names.joint(joint.name);
    joint.parent = names.link(joint.parent);
    joint.child = names.link(joint.child);
    if (joint.mimic) joint.mimic->joint = names.joint(joint.mimic->joint);
  }
  world.root = names.link(world.root);
}

}  // namespace

void require_part_name(const std::string& name) {
  constexpr size_t kMaxBytes = 100;
  require_utf8(name);
  const auto refuse = [&](const char* why) {
    throw Error(fmt::format("'{}' cannot be a name: {}", name.substr(0, kMaxBytes), why), {},
                "use letters, digits, blanks, '_' and single '-'");
  };
  if (std::ranges::any_of(name, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }))
    throw Error("a name cannot have control characters", {},
                "use letters, digits, blanks, '_' and single '-'");
  if (name.empty() || trimmed(name) != name) refuse("it is empty, or begins or ends with a blank");
  if (name.size() > kMaxBytes) refuse("it is longer than 100 bytes");
  if (name.find_first_of("<>&\"") != std::string::npos) refuse("it has one of <, >, & and \"");
  if (name.find("--") != std::string::npos) refuse("it has '--'");
}

const std::string& PartNames::link(const std::string& name) const {
  return name_in(links, name);
}

const std::string& PartNames::joint(const std::string& name) const {
  return name_in(joints, name);
}

PartNames part_names(const Store& store, std::optional<TimeNs> known_at) {
  PartNames names;
  for (const RunRow& run : store.runs()) {
    if (run.program != kEditProgram || (known_at && run.started > *known_at)) continue;
    const Json configuration = configuration_of(run, store.path());
    if (!configuration.contains("part")) continue;
    const Json& part = configuration["part"];
    auto& of = part["of"].get<std::string>() == "link" ? names.links : names.joints;
    const auto after = part["after"].get<std::string>();
    if (after.empty())
      of.erase(part["name"].get<std::string>());
    else
      of[part["name"].get<std::string>()] = after;
  }
  return names;
}

void rename_places(std::vector<PlaceRow>& places, const std::vector<FactRow>& facts) {
  for (const FactRow& fact : facts) {
    if (!fact.place || !fact.value || fact.key != kPlaceNameKey) continue;
    for (PlaceRow& place : places)
      if (place.id == *fact.place) place.name = *fact.value;
  }
}

std::vector<PlaceRow> named_places(const Store& store) {
  std::vector<PlaceRow> places = store.places();
  rename_places(places, store.facts());
  return places;
}

std::optional<mapping::World> named_map(const Store& store, const AsOf& as_of) {
  const std::optional<MapRow> map = store.map_at(as_of);
  if (!map) return std::nullopt;
  mapping::World world = mapping::parse_urdf(store.blob(map->urdf).bytes, map->name);
  PartNames names = part_names(store);
  const std::vector<PlaceRow> before = store.places(), now = named_places(store);
  for (size_t i = 0; i < before.size(); ++i)
    if (before[i].name != now[i].name && world.find_link(now[i].name) == nullptr)
      names.links[before[i].name] = now[i].name;
  rename_parts(world, names);
  return world;
}

}  // namespace loci::memory
