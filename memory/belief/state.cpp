#include "memory/belief/state.h"

#include <cmath>

namespace loci::belief {
namespace {

constexpr int kVersion = 1;

Json numbers(const Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Vector3d vector_from(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// All twelve numbers: a detour over a quaternion would not come back bit by bit.
Json pose_numbers(const Isometry3d& pose) {
  Json json = Json::array();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) json.push_back(pose.matrix()(row, column));
  return json;
}

Isometry3d pose_from(const Json& json) {
  Isometry3d pose = Isometry3d::Identity();
  for (size_t i = 0; i < 12; ++i)
    pose.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) =
        json.at(i).get<double>();
  return pose;
}

Json look_json(const Look& look) {
  Json descriptors = Json::object();
  for (const Descriptor& d : look.descriptors) {
    if (d.names.empty())
      descriptors[d.kind] = d.values;
    else
      descriptors[d.kind] = {{"names", d.names}, {"values", d.values}};
  }
  return {
      {"time", look.time}, {"weight", look.weight}, {"partial", look.partial}, {"descriptors", descriptors}};
}

Look look_from(const Json& json) {
  Look look;
  look.time = json.at("time").get<TimeNs>();
  look.weight = json.at("weight").get<double>();
  look.partial = json.at("partial").get<bool>();
  for (const auto& [kind, values] : json.at("descriptors").items()) {
    if (values.is_array())
      look.descriptors.push_back({kind, values.get<std::vector<float>>()});
    else
      look.descriptors.push_back({kind, values.at("values").get<std::vector<float>>(),
                                  values.at("names").get<std::vector<std::string>>()});
  }
  return look;
}

Json object_json(const ProtoObject& o) {
  Json looks = Json::array();
  for (const Look& look : o.looks) looks.push_back(look_json(look));
  Json pending = Json::array();
  for (const PendingSighting& p : o.pending)
    pending.push_back({p.observation, p.time, p.first, p.probability});
  return {{"key", o.key},
          {"id", o.id},
          {"status", static_cast<int>(o.status)},
          {"first_seen", o.first_seen},
          {"last_seen", o.last_seen},
          {"last_update", o.last_update},
          {"attention", o.attention_s},
          {"sightings", o.sightings},
          {"exists_log_odds", o.exists_log_odds},
          {"probability_here", o.probability_here},
          {"hidden_looks", o.hidden_looks},
          {"told_hidden", o.told_hidden},
          {"place", o.place},
          {"centre", numbers(o.box.centre)},
          {"size", numbers(o.box.size)},
          {"variance", o.variance},
          {"partial", o.partial},
          {"sized", o.sized},
          {"map_from_camera", pose_numbers(o.map_from_camera)},
          {"looks", looks},
          {"last_observation", o.last_observation},
          {"pending", pending}};
}

ProtoObject object_from(const Json& json) {
  ProtoObject o;
  o.key = json.at("key").get<int64_t>();
  o.id = json.at("id").get<int64_t>();
  o.status = static_cast<Status>(json.at("status").get<int>());
  o.first_seen = json.at("first_seen").get<TimeNs>();
  o.last_seen = json.at("last_seen").get<TimeNs>();
  o.last_update = json.at("last_update").get<TimeNs>();
  o.attention_s = json.value("attention", 0.0);  // earlier beliefs were moved on with every scene
  o.sightings = json.at("sightings").get<int>();
  o.exists_log_odds = json.at("exists_log_odds").get<double>();
  o.probability_here = json.at("probability_here").get<double>();
  o.hidden_looks = json.at("hidden_looks").get<int>();
  o.told_hidden = json.at("told_hidden").get<bool>();
  o.place = json.at("place").get<std::string>();
  o.box = {vector_from(json.at("centre")), vector_from(json.at("size"))};
  o.variance = json.at("variance").get<double>();
  o.partial = json.at("partial").get<bool>();
  o.sized = json.value("sized", true);  // beliefs from before sizes could be missing
  o.map_from_camera = pose_from(json.at("map_from_camera"));
  for (const Json& look : json.at("looks")) o.looks.push_back(look_from(look));
  o.last_observation = json.at("last_observation").get<int64_t>();
  for (const Json& p : json.at("pending"))
    o.pending.push_back(
        {p.at(0).get<int64_t>(), p.at(1).get<TimeNs>(), p.at(2).get<bool>(), p.at(3).get<double>()});
  return o;
}

}  // namespace

const ProtoObject* BeliefState::find(int64_t id) const {
  for (const ProtoObject& object : objects)
    if (object.id == id && id != 0) return &object;
  return nullptr;
}

double handled_in(double seconds, const BeliefOptions& options) {
  return options.move_cap * (1 - std::exp(-seconds / options.move_time_s));
}

double probability_here(const ProtoObject& object, const BeliefState& state, const BeliefOptions& options) {
  return object.probability_here * (1 - handled_in(state.attention_s - object.attention_s, options));
}

Json to_json(const BeliefState& state) {
  Json objects = Json::array();
  for (const ProtoObject& object : state.objects) objects.push_back(object_json(object));
  return {{"version", kVersion},
          {"last_scene", state.last_scene ? Json(*state.last_scene) : Json()},
          {"attention", state.attention_s},
          {"next_key", state.next_key},
          {"next_id", state.next_id},
          {"objects", objects}};
}

BeliefState belief_state_from_json(const Json& json) {
  try {
    if (json.at("version").get<int>() != kVersion)
      throw Error("this belief was written by another version of loci", {}, "use the version that wrote it");
    BeliefState state;
    if (!json.at("last_scene").is_null()) state.last_scene = json.at("last_scene").get<TimeNs>();
    state.attention_s = json.value("attention", 0.0);
    state.next_key = json.at("next_key").get<int64_t>();
    state.next_id = json.at("next_id").get<int64_t>();
    for (const Json& object : json.at("objects")) state.objects.push_back(object_from(object));
    return state;
  } catch (const nlohmann::json::exception& e) {
    throw Error(std::string("the stored belief cannot be read: ") + e.what());
  }
}

std::string to_bytes(const BeliefState& state) {
  std::string bytes;
  Json::to_cbor(to_json(state), nlohmann::detail::output_adapter<char>(bytes));
  return bytes;
}

BeliefState belief_state_from_bytes(const std::string& bytes) {
  try {
    return belief_state_from_json(Json::from_cbor(bytes));
  } catch (const nlohmann::json::exception& e) {
    throw Error(std::string("the stored belief cannot be read: ") + e.what());
  }
}

}  // namespace loci::belief
