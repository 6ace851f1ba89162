// The answer of `was` as text and JSON.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "memory/questions/answer_format.h"
#include "memory/questions/presence.h"

namespace loci::memory {

using namespace format;

namespace {

std::string verdict_text(const WasObject& object, const std::string& where, const std::string& period) {
  const std::string name = to_text(object.object);
  if (object.verdict == Verdict::yes)
    return fmt::format("Yes: {} was {} {}, seen in {}.", name, where, period, scenes_text(object.seen_there));
  if (object.verdict == Verdict::no)
    return fmt::format("No: {} was not {} {}: {}.", name, where, period, object.reason);
  return fmt::format("Not observed: whether {} was {} {} is not known: {}.", name, where, period,
                     object.reason);
}

void add_evidence(const WasObject& object, const TimeWriter& times, std::vector<std::string>& lines) {
  const auto seen_at = [&](const SceneRef& scene) {
    return fmt::format("{} ({})", times.text(scene.time), scene_text(scene));
  };
  if (!object.seen_elsewhere.empty()) {
    std::vector<std::string> places;
    for (const auto& [scene, place] : object.seen_elsewhere)
      places.push_back(fmt::format("{} at {}", place.empty() ? "off any place" : place, seen_at(scene)));
    if (places.size() > 4) places.resize(4);
    lines.push_back(fmt::format("  seen elsewhere: {}", fmt::join(places, "; ")));
  }
  if (object.verdict == Verdict::yes) return;
  if (!object.views.empty()) {
    std::vector<SceneRef> scenes;
    for (const PlaceView& view : object.views) scenes.push_back(view.scene);
    lines.push_back("  looked in " + scenes_text(scenes));
  }
  if (object.before) lines.push_back("  before that it was there at " + seen_at(*object.before));
  if (object.after) lines.push_back("  after that it was there at " + seen_at(*object.after));
}

Json was_json(const WasObject& object) {
  Json json = object_json(object.object);
  json["verdict"] = to_text(object.verdict);
  if (!object.reason.empty()) json["reason"] = object.reason;
  json["seen_there"] = list_json(object.seen_there, scene_json);
  json["seen_elsewhere"] = list_json(object.seen_elsewhere, [](const auto& seen) {
    Json entry = scene_json(seen.first);
    if (!seen.second.empty()) entry["place"] = seen.second;
    return entry;
  });
  json["looks"] = list_json(object.views, [](const PlaceView& view) {
    Json entry = scene_json(view.scene);
    entry["fraction"] = view.fraction;
    entry["spot"] = to_text(view.spot);
    return entry;
  });
  put(json, "before", object.before, scene_json);
  put(json, "after", object.after, scene_json);
  return json;
}

}  // namespace

std::string to_text(const WasAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  const std::string where =
      answer.place.empty() ? "seen anywhere" : (answer.container ? "in " : "on ") + answer.place;
  const std::string first = times.text(answer.from), last = times.text(answer.to);
  const std::string period = first == last ? "at " + first : fmt::format("between {} and {}", first, last);
  if (answer.objects.size() > 1)
    lines.emplace_back(answer.verdict == Verdict::yes  ? "Yes, one of them was."
                       : answer.verdict == Verdict::no ? "No, none of them was."
                                                       : "Not observed.");
  for (const WasObject& object : answer.objects) {
    lines.push_back(verdict_text(object, where, period));
    add_evidence(object, times, lines);
  }
  return lines_text(lines);
}

Json to_json(const WasAnswer& answer) {
  Json json = {{"asked", answer.asked}};
  if (!answer.place.empty()) json["place"] = answer.place;
  json["from"] = format_time(answer.from);
  json["to"] = format_time(answer.to);
  json["verdict"] = to_text(answer.verdict);
  json["objects"] = list_json(answer.objects, was_json);
  return json;
}

}  // namespace loci::memory
