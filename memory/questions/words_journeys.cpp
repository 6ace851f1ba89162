#include <fmt/format.h>

#include "mapping/base/json.h"
#include "memory/questions/word_parts.h"

namespace loci::memory {

using namespace words;

std::string to_text(const LifecycleAnswer& answer, const TimeWriter&) {
  std::string names;
  for (const ObjectRef& object : answer.objects) names += (names.empty() ? "" : ", ") + object_text(object);
  if (answer.places.empty()) return fmt::format("{}: never seen at a place.\n", names);
  std::string way;
  for (const PlaceRef& place : answer.usual) way += (way.empty() ? "" : " → ") + place.name;
  std::vector<std::string> lines = {fmt::format("{}: {}", names, way)};
  for (const LifecyclePlace& place : answer.places)
    lines.push_back(fmt::format(
        "  {}: {}{}", words::place_text(place.place), words::plural(place.stays, "stay"),
        place.hours ? fmt::format(", {:.1f} h until it is seen at the next place (median)", *place.hours)
                    : ""));
  for (const LifecycleStep& step : answer.steps)
    lines.push_back(fmt::format("  {} → {}: {} ({} of the ways from there)", step.from.name, step.to.name,
                                words::plural(step.count, "time"), words::percent(step.share)));
  return words::lines_text(lines);
}

std::string to_text(const NextLookAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const NextLook& look : answer.objects) {
    lines.push_back(words::state_text(look.now, times));
    size_t number = 0;
    for (const LookPlace& place : look.places)
      lines.push_back(fmt::format(
          "  {}. {}: {} ({}); a look shows {} of it, {:.0f} s{}{}", ++number, words::place_text(place.place),
          words::percent(place.probability), place.reason, words::percent(place.visibility), place.seconds,
          place.distance_m ? fmt::format(" with the way of {:.1f} m", *place.distance_m) : "",
          place.last_look ? fmt::format(", last looked at {}", times.text(place.last_look->time))
                          : ", never looked at"));
  }
  return words::lines_text(lines);
}

Json to_json(const LifecycleAnswer& answer) {
  Json json = {{"asked", answer.asked}};
  json["objects"] = json["places"] = json["steps"] = json["usual"] = Json::array();
  for (const ObjectRef& object : answer.objects) json["objects"].push_back(words::object_json(object));
  for (const LifecyclePlace& place : answer.places) {
    json["places"].push_back({{"place", place.place.name}, {"stays", place.stays}});
    if (place.hours) json["places"].back()["hours"] = *place.hours;
  }
  for (const LifecycleStep& step : answer.steps)
    json["steps"].push_back(
        {{"from", step.from.name}, {"to", step.to.name}, {"count", step.count}, {"share", step.share}});
  for (const PlaceRef& place : answer.usual) json["usual"].push_back(place.name);
  return json;
}

Json to_json(const NextLookAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"objects", Json::array()}};
  for (const NextLook& look : answer.objects) {
    Json entry = words::state_json(look.now);
    entry["look_at"] = Json::array();
    for (const LookPlace& place : look.places) {
      Json one = {{"place", place.place.name},      {"probability", place.probability},
                  {"visibility", place.visibility}, {"seconds", place.seconds},
                  {"reason", place.reason},         {"chance_per_minute", place.chance_per_minute}};
      if (place.distance_m) one["distance"] = *place.distance_m;
      if (place.last_look) one["last_look"] = words::scene_json(*place.last_look);
      entry["look_at"].push_back(one);
    }
    json["objects"].push_back(entry);
  }
  return json;
}

}  // namespace loci::memory
