#include "memory/store/map_places.h"

namespace loci::memory {

std::optional<PlaceRow> place_of_link(const std::string& name, const mapping::SemanticLink& link,
                                      const std::string& sidecar) {
  const Json& geometry = link.geometry;
  if (!geometry.contains("height") || !geometry.contains("outline")) return std::nullopt;
  PlaceRow place{.name = name, .class_name = link.class_name};
  place.container = link.class_name.starts_with("drawer") || link.class_name == "cabinet";
  try {
    place.height = geometry.at("height").get<double>();
    for (const Json& corner : geometry.at("outline"))
      place.outline.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  } catch (const Json::exception&) {
    throw Error("must be {\"height\": m, \"outline\": [[x, y], ...]}", {sidecar, 0, name});
  }
  return place;
}

}  // namespace loci::memory
