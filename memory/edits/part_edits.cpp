// Names of links and joints of the map.

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/json.h"
#include "mapping/base/text.h"
#include "mapping/world/urdf.h"
#include "memory/edits/edit_runs.h"
#include "memory/questions/place_names.h"

namespace loci::memory {
namespace {

/// Something that has a name: what the map (or who found it) calls it, and what it is called now.
struct Named {
  const char* of;  ///< place, link or joint
  std::string in_map, now;
  bool is_called(const std::string& name) const { return name == in_map || name == now; }
};

/// Places before links and joints: who names a place means what is there.
std::vector<Named> all_named(const Store& store) {
  std::vector<Named> all;
  const std::vector<PlaceRow> before = store.places(), now = named_places(store);
  for (size_t i = 0; i < before.size(); ++i) all.push_back({"place", before[i].name, now[i].name});
  const std::vector<MapRow> maps = store.maps();
  if (maps.empty()) return all;
  const mapping::World world = mapping::parse_urdf(store.blob(maps.back().urdf).bytes, maps.back().name);
  const PartNames names = part_names(store);
  for (const mapping::Link& link : world.links)
    if (std::none_of(before.begin(), before.end(),
                     [&](const PlaceRow& place) { return place.name == link.name; }))
      all.push_back({"link", link.name, names.link(link.name)});
  for (const mapping::Joint& joint : world.joints)
    all.push_back({"joint", joint.name, names.joint(joint.name)});
  return all;
}

[[noreturn]] void refuse(const Store& store, const std::string& what, const std::string& hint) {
  throw Error(what, {store.path().string(), 0, {}}, hint);
}

}  // namespace

Edit name_part(Store& store, const std::string& part, const std::string& name) {
  require_utf8(name);
  const std::vector<Named> all = all_named(store);
  const auto meant =
      std::find_if(all.begin(), all.end(), [&](const Named& named) { return named.is_called(part); });
  if (meant == all.end()) {
    std::vector<std::string> known;
    for (const Named& named : all) known.push_back(named.now);
    refuse(store, fmt::format("neither place, link nor joint is called '{}'", part),
           did_you_mean(part, known));
  }
  for (const Named& other : all)
    if (&other != &*meant && other.is_called(name))
      refuse(store, fmt::format("another {} is called '{}'", other.of, name), "give it another name");
  if (meant->of == std::string("place")) return name_place(store, meant->in_map, name);
  const std::string after = name == meant->in_map ? "" : name;
  const std::string before = meant->now == meant->in_map ? "" : meant->now;
  if (after == before)
    refuse(store, fmt::format("the {} is called {} already", meant->of, meant->now), "give it another name");
  const std::string text = after.empty() ? fmt::format("{} is called so again", meant->in_map)
                                         : fmt::format("{} is called {}", meant->in_map, after);
  const EditRun run(
      store, {{"text", text},
              {"part", {{"of", meant->of}, {"name", meant->in_map}, {"before", before}, {"after", after}}}});
  return edit_of(store, run.id());
}

}  // namespace loci::memory
