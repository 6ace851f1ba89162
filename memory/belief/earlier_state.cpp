#include "memory/belief/earlier_state.h"

#include "mapping/base/json.h"

namespace loci::memory::belief {
namespace {

Vector3d vector_from(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Isometry3d pose_from(const Json& json) {
  Isometry3d pose = Isometry3d::Identity();
  for (size_t i = 0; i < 12; ++i)
    pose.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) =
        json.at(i).get<double>();
  return pose;
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

ProtoObject object_from(const Json& json) {
  ProtoObject o;
  o.key = json.at("key").get<int64_t>();
  o.id = json.at("id").get<int64_t>();
  o.status = static_cast<Status>(json.at("status").get<int>());
  o.first_seen = json.at("first_seen").get<TimeNs>();
  o.last_seen = json.at("last_seen").get<TimeNs>();
  o.last_update = json.at("last_update").get<TimeNs>();
  o.attention_s = json.value("attention", 0.0);  // earlier beliefs were moved on with every scene
  o.seen_attention_s = o.attention_s;
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

BeliefState belief_state_of_version_1(const std::string& bytes) {
  const Json json = Json::from_cbor(bytes);
  if (json.at("version").get<int>() != 1)
    throw Error("this belief was written by another version of loci", {}, "use the version that wrote it");
  BeliefState state;
  if (!json.at("last_scene").is_null()) state.last_scene = json.at("last_scene").get<TimeNs>();
  state.attention_s = json.value("attention", 0.0);
  state.next_key = json.at("next_key").get<int64_t>();
  state.next_id = json.at("next_id").get<int64_t>();
  for (const Json& object : json.at("objects")) state.objects.push_back(object_from(object));
  return state;
}

}  // namespace loci::memory::belief
