#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mapping/base/json.h"
#include "mapping/base/math.h"
#include "memory/questions/word_parts.h"

namespace loci::memory {

using namespace words;

namespace {

/// "45 cm" or "90 degrees".
std::string travel_text(const PartMotion& motion, double position) {
  return motion.type == mapping::JointType::prismatic
             ? fmt::format("{:.0f} cm", 100 * std::abs(position))
             : fmt::format("{:.0f} degrees", std::abs(position) * 180 / kPi);
}

std::string motion_text(const PartMotion& motion, const TimeWriter& times) {
  const double way = std::max(std::abs(motion.lower), std::abs(motion.upper));
  std::string text =
      fmt::format("{} up to {}", motion.type == mapping::JointType::prismatic ? "slides" : "turns",
                  travel_text(motion, way));
  if (motion.position && motion.seen)
    text += fmt::format("; {} as of {} ({})",
                        motion.open() ? "open by " + travel_text(motion, *motion.position) : "closed",
                        times.text(motion.seen->time), words::scene_text(*motion.seen));
  if (motion.opened) text += fmt::format("; last opened by {}", times.text(motion.opened->time));
  if (motion.closed) text += fmt::format("; last closed by {}", times.text(motion.closed->time));
  if (!motion.opened && !motion.closed) text += "; never seen to move";
  return text;
}

std::string part_text(const RoomPart& part, const TimeWriter& times) {
  std::vector<std::string> said;
  if (part.motion) said.push_back(motion_text(*part.motion, times));
  if (part.place)
    said.push_back(fmt::format(
        "{}{}{}", part.height ? fmt::format("{:.2f} m high, ", *part.height) : "",
        part.objects == 0 ? "nothing" : words::plural(part.objects, "object"),
        part.last_look ? fmt::format(" {} it, last looked at {}", part.place->container ? "in" : "on",
                                     times.text(part.last_look->time))
                       : fmt::format(" known {} it, never looked at", part.place->container ? "in" : "on")));
  return fmt::format("  {} ({}{}{}){}{}", part.name, part.class_name, part.aliases.empty() ? "" : ", ",
                     fmt::join(part.aliases, ", "), said.empty() ? "" : ": ", fmt::join(said, "; "));
}

Json part_json(const RoomPart& part) {
  Json json = {{"name", part.name}, {"class", part.class_name}};
  if (part.map_name != part.name) json["name_in_map"] = part.map_name;
  if (!part.aliases.empty()) json["aliases"] = part.aliases;
  if (part.position) json["position"] = words::vector_json(*part.position);
  if (part.motion) {
    const PartMotion& motion = *part.motion;
    json["joint"] = {{"name", motion.joint},
                     {"type", joint_type_name(motion.type)},
                     {"lower", motion.lower},
                     {"upper", motion.upper}};
    if (motion.map_joint != motion.joint) json["joint"]["name_in_map"] = motion.map_joint;
    if (motion.position) json["joint"]["position"] = *motion.position;
    if (motion.position) json["joint"]["open"] = motion.open();
    if (motion.seen) json["joint"]["seen"] = words::scene_json(*motion.seen);
    if (motion.opened) json["joint"]["last_opened"] = format_time(motion.opened->time);
    if (motion.closed) json["joint"]["last_closed"] = format_time(motion.closed->time);
  }
  if (part.place) {
    json["place"] = part.place->name;
    json["objects"] = part.objects;
  }
  if (part.height) json["height"] = *part.height;
  if (part.last_look) json["last_look"] = words::scene_json(*part.last_look);
  return json;
}

Json parts_json(const std::vector<RoomPart>& parts) {
  Json json = Json::array();
  for (const RoomPart& part : parts) json.push_back(part_json(part));
  return json;
}

}  // namespace

std::string to_text(const RoomAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> counts;
  for (const auto& [name, count] : answer.classes) counts.push_back(words::plural(count, name.c_str()));
  std::vector<std::string> lines;
  lines.push_back(answer.parts.empty()
                      ? "No map, and no place was found yet."
                      : fmt::format("{}: {}",
                                    answer.map.empty() ? "No map; places that were found" : answer.map,
                                    fmt::join(counts, ", ")));
  for (const RoomPart& part : answer.parts) lines.push_back(part_text(part, times));
  return words::lines_text(lines);
}

std::string to_text(const OpensAnswer& answer, const TimeWriter& times) {
  if (answer.parts.empty())
    return answer.asked.empty() ? "Nothing is known to open: the map has no joints.\n"
                                : fmt::format("'{}' has no part that moves.\n", answer.asked);
  std::vector<std::string> lines;
  for (const RoomPart& part : answer.parts)
    lines.push_back(fmt::format("{} ({}{}{}) {}.", part.name, part.class_name,
                                part.aliases.empty() ? "" : ", ", fmt::join(part.aliases, ", "),
                                motion_text(*part.motion, times)));
  return words::lines_text(lines);
}

std::string to_text(const AboutAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const AboutObject& object : answer.objects) {
    lines.push_back(words::state_text(object.now, times));
    for (const Fact& fact : object.facts)
      lines.push_back(fmt::format("  {}: {} (said by {})", fact.key, fact.value, fact.source));
    for (const AnnotationSupport& one : object.evidence)
      lines.push_back(fmt::format(
          "  {}: {} ({} of {}, {} of those that say)", one.type.substr(one.type.rfind('.') + 1), one.value,
          one.observations, words::plural(object.sightings, "sighting"), words::percent(one.agreement)));
    if (object.now.first_seen)
      lines.push_back(fmt::format("  first seen at {} ({}), in {}", times.text(object.now.first_seen->time),
                                  words::scene_text(*object.now.first_seen),
                                  words::plural(object.now.sightings, "scene")));
  }
  return words::lines_text(lines);
}

Json to_json(const RoomAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"classes", answer.classes}, {"parts", parts_json(answer.parts)}};
  if (!answer.map.empty()) json["map"] = answer.map;
  return json;
}

Json to_json(const OpensAnswer& answer) {
  return {{"asked", answer.asked}, {"parts", parts_json(answer.parts)}};
}

Json to_json(const AnnotationSupport& evidence) {
  return {{"type", evidence.type},
          {"value", evidence.value},
          {"sightings", evidence.observations},
          {"agreement", evidence.agreement}};
}

Json to_json(const AboutAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"objects", Json::array()}};
  for (const AboutObject& object : answer.objects) {
    Json one = words::state_json(object.now);
    one["facts"] = to_json(FactsAnswer{object.facts})["facts"];
    one["evidence"] = Json::array();
    for (const AnnotationSupport& evidence : object.evidence) one["evidence"].push_back(to_json(evidence));
    json["objects"].push_back(std::move(one));
  }
  return json;
}

}  // namespace loci::memory
