#include "mapping/base/json.h"
#include "memory/questions/word_parts.h"

namespace loci::memory {
namespace words {

Json vector_json(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json scene_json(const SceneRef& scene) {
  Json json = {{"scene", scene.scene}, {"time", format_time(scene.time)}};
  if (scene.recording) json["recording"] = *scene.recording;
  if (scene.frame) json["frame"] = *scene.frame;
  return json;
}

Json scenes_json(const std::vector<SceneRef>& scenes) {
  Json json = Json::array();
  for (const SceneRef& scene : scenes) json.push_back(scene_json(scene));
  return json;
}

namespace {

template <class T, class Write>
void put(Json& json, const char* key, const std::optional<T>& value, Write write) {
  if (value) json[key] = write(*value);
}

std::string place_json(const PlaceRef& place) {
  return place.name;
}

}  // namespace

Json object_json(const ObjectRef& object) {
  Json json = {{"object", object.name}};
  if (!object.aliases.empty()) json["aliases"] = object.aliases;
  if (object.color) json["color"] = *object.color;
  put(json, "size", object.size, vector_json);
  return json;
}

Json state_json(const ObjectState& state) {
  Json json = object_json(state.object);
  json["status"] = state.status;
  json["probability"] = state.probability;
  put(json, "place", state.place, place_json);
  put(json, "position", state.position, vector_json);
  put(json, "first_seen", state.first_seen, scene_json);
  put(json, "last_seen", state.last_seen, scene_json);
  json["sightings"] = state.sightings;
  if (seen_once(state)) json["seen_once"] = true;
  json["since_last_seen"] = {{"out_of_view", state.looks_out_of_view},
                             {"hidden", state.looks_hidden},
                             {"missed", state.looks_missed}};
  put(json, "looked_for", state.looked_for, scene_json);
  return json;
}

Json states_json(const std::vector<ObjectState>& states) {
  Json json = Json::array();
  for (const ObjectState& state : states) json.push_back(state_json(state));
  return json;
}

}  // namespace words

using namespace words;

namespace {

Json change_json(const Change& change) {
  Json json = {{"kind", change.kind}, {"time", format_time(change.time)}};
  if (change.since) json["since"] = format_time(*change.since);
  if (change.object) json.update(words::object_json(*change.object));
  words::put(json, "place", change.place, words::place_json);
  words::put(json, "from_place", change.from_place, words::place_json);
  words::put(json, "position", change.position, words::vector_json);
  words::put(json, "from_position", change.from_position, words::vector_json);
  if (change.joint) json["joint"] = *change.joint;
  if (change.joint_position) json["joint_position"] = *change.joint_position;
  if (change.from_joint_position) json["from_joint_position"] = *change.from_joint_position;
  json["probability"] = change.probability;
  words::put(json, "scene", change.scene, words::scene_json);
  json["source"] = change.source;
  return json;
}

Json changes_json(const std::vector<Change>& changes) {
  Json json = Json::array();
  for (const Change& change : changes) json.push_back(change_json(change));
  return json;
}

Json summary_json(const SceneSummary& summary) {
  Json json = words::scene_json(summary.scene);
  json["observations"] = summary.observations;
  json["has_pose"] = summary.has_pose;
  json["looked_at"] = Json::object();
  for (const auto& [place, fraction] : summary.looked_at) json["looked_at"][place] = fraction;
  json["known_from"] = format_time(summary.known_from);
  return json;
}

Json was_json(const WasObject& object) {
  Json json = words::object_json(object.object);
  json["verdict"] = verdict_name(object.verdict);
  if (!object.reason.empty()) json["reason"] = object.reason;
  json["seen_there"] = words::scenes_json(object.seen_there);
  json["seen_elsewhere"] = Json::array();
  for (const auto& [scene, place] : object.seen_elsewhere) {
    Json entry = words::scene_json(scene);
    if (!place.empty()) entry["place"] = place;
    json["seen_elsewhere"].push_back(entry);
  }
  json["looks"] = Json::array();
  for (const PlaceLook& look : object.looks) {
    Json entry = words::scene_json(look.scene);
    entry["fraction"] = look.fraction;
    entry["spot"] = look.spot;
    json["looks"].push_back(entry);
  }
  words::put(json, "before", object.before, words::scene_json);
  words::put(json, "after", object.after, words::scene_json);
  return json;
}

}  // namespace

Json to_json(const WhereAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"objects", Json::array()}};
  for (const ObjectState& state : answer.objects) {
    Json entry = words::state_json(state);
    entry["alternatives"] = Json::array();
    for (const Alternative& other : state.alternatives) {
      Json one = {{"probability", other.probability}, {"scene", words::scene_json(other.scene)}};
      words::put(one, "place", other.place, words::place_json);
      words::put(one, "position", other.position, words::vector_json);
      words::put(one, "taken_for", other.taken_for, words::object_json);
      entry["alternatives"].push_back(one);
    }
    json["objects"].push_back(entry);
  }
  return json;
}

Json to_json(const HistoryAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"objects", Json::array()}};
  for (const ObjectHistory& history : answer.objects) {
    Json entry = words::state_json(history.now);
    entry["stays"] = Json::array();
    for (const Stay& stay : history.stays) {
      Json one = {{"from", format_time(stay.scenes.front().time)},
                  {"to", format_time(stay.scenes.back().time)},
                  {"seconds", double(stay.scenes.back().time - stay.scenes.front().time) / kSecond}};
      words::put(one, "place", stay.place, words::place_json);
      words::put(one, "position", stay.position, words::vector_json);
      one["probability"] = stay.probability;
      one["scenes"] = words::scenes_json(stay.scenes);
      entry["stays"].push_back(one);
    }
    entry["changes"] = changes_json(history.changes);
    json["objects"].push_back(entry);
  }
  return json;
}

Json to_json(const ContentsAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"verdict", verdict_name(answer.verdict)}, {"places", Json::array()}};
  if (!answer.subject.empty()) json["subject"] = answer.subject;
  for (const PlaceContents& contents : answer.places) {
    Json entry = {{"place", contents.place.name},
                  {"container", contents.place.container},
                  {"objects", words::states_json(contents.there)},
                  {"gone", words::states_json(contents.gone)}};
    if (contents.gone_in_all > contents.gone.size()) entry["gone_in_all"] = contents.gone_in_all;
    words::put(entry, "last_look", contents.last_look, words::scene_json);
    if (contents.fraction) entry["fraction"] = *contents.fraction;
    json["places"].push_back(entry);
  }
  return json;
}

Json to_json(const WasAnswer& answer) {
  Json json = {{"asked", answer.asked}};
  if (!answer.place.empty()) json["place"] = answer.place;
  json["from"] = format_time(answer.from);
  json["to"] = format_time(answer.to);
  json["verdict"] = verdict_name(answer.verdict);
  json["objects"] = Json::array();
  for (const WasObject& object : answer.objects) json["objects"].push_back(was_json(object));
  return json;
}

Json to_json(const ChangesAnswer& answer) {
  Json json = Json::object();
  if (answer.from) json["from"] = format_time(*answer.from);
  if (answer.to) json["to"] = format_time(*answer.to);
  json["changes"] = changes_json(answer.changes);
  return json;
}

Json to_json(const ObjectsAnswer& answer) {
  return {{"objects", words::states_json(answer.objects)}};
}

Json to_json(const ScenesAnswer& answer) {
  Json json = {{"scenes", Json::array()}};
  for (const SceneSummary& summary : answer.scenes) json["scenes"].push_back(summary_json(summary));
  return json;
}

Json to_json(const TimelineAnswer& answer) {
  Json json = {{"timeline", Json::array()}};
  for (const TimelineEntry& entry : answer.entries) {
    Json one = summary_json(entry.scene);
    one["seen"] = Json::array();
    for (const ObjectRef& object : entry.seen) one["seen"].push_back(words::object_json(object));
    one["changes"] = changes_json(entry.changes);
    json["timeline"].push_back(one);
  }
  return json;
}

}  // namespace loci::memory
