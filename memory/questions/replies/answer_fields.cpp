#include "memory/questions/replies/answer_fields.h"

#include "memory/questions/replies/answer_format.h"

namespace loci::memory::format {

RecordSchema::RecordSchema(std::string name)
    : name_(std::move(name)),
      definition_({{"type", "object"},
                   {"properties", Json::object()},
                   {"required", Json::array()},
                   {"additionalProperties", false}}) {}

Json RecordSchema::definitions() const {
  Json all = others_;
  all[name_] = definition_;
  return all;
}

void RecordSchema::declare(const std::string& key, const Json& schema, bool required) {
  definition_["properties"][key] = schema;
  if (required) definition_["required"].push_back(key);
}

void RecordSchema::refer_to(const RecordSchema& part) {
  others_.update(part.definitions());
}

void RecordSchema::take_over(const RecordSchema& part, bool required) {
  others_.update(part.others_);
  definition_["properties"].update(part.definition_["properties"]);
  if (!required) return;
  for (const Json& key : part.definition_["required"]) definition_["required"].push_back(key);
}

const Record<SceneRef>& scene_record() {
  static const auto record = Record<SceneRef>("Scene")
                                 .value("scene", &SceneRef::scene)
                                 .time("time", &SceneRef::time)
                                 .value("recording", &SceneRef::recording)
                                 .value("frame", &SceneRef::frame);
  return record;
}

const Record<ObjectRef>& object_record() {
  static const auto record =
      Record<ObjectRef>("Object")
          .value("object", &ObjectRef::name)
          .value("label", &ObjectRef::label)
          .value("aliases", [](const ObjectRef& object) { return unless_empty(object.aliases); })
          .value("color", &ObjectRef::color)
          .value("size", &ObjectRef::size);
  return record;
}

namespace {

const Record<ObjectBelief>& views_record() {
  static const auto record = Record<ObjectBelief>("ScenesSince")
                                 .value("out_of_view", &ObjectBelief::scenes_out_of_view)
                                 .value("hidden", &ObjectBelief::scenes_hidden)
                                 .value("missed", &ObjectBelief::scenes_missed);
  return record;
}

}  // namespace

const Record<ObjectBelief>& belief_record() {
  static const auto record =
      Record<ObjectBelief>("ObjectBelief")
          .with(&ObjectBelief::object, object_record())
          .value("status", &ObjectBelief::status)
          .value("probability", &ObjectBelief::probability)
          .value("in_home", &ObjectBelief::in_home)
          .value("place", &ObjectBelief::place)
          .value("position", &ObjectBelief::position)
          .record("first_seen", &ObjectBelief::first_seen, scene_record())
          .record("last_seen", &ObjectBelief::last_seen, scene_record())
          .value("sightings", &ObjectBelief::sightings)
          .value("seen_once", [](const ObjectBelief& belief) { return if_true(seen_once(belief)); })
          .record("since_last_seen", std::identity(), views_record())
          .record("looked_for", &ObjectBelief::last_missed, scene_record());
  return record;
}

const Record<Change>& change_record() {
  static const auto record = Record<Change>("Change")
                                 .value("kind", &Change::kind)
                                 .time("time", &Change::time)
                                 .time("since", &Change::since)
                                 .with(&Change::object, object_record())
                                 .value("place", &Change::place)
                                 .value("from_place", &Change::from_place)
                                 .value("position", &Change::position)
                                 .value("from_position", &Change::from_position)
                                 .value("joint", &Change::joint)
                                 .value("joint_position", &Change::joint_position)
                                 .value("from_joint_position", &Change::from_joint_position)
                                 .value("probability", &Change::probability)
                                 .record("scene", &Change::scene, scene_record())
                                 .value("source", &Change::source);
  return record;
}

}  // namespace loci::memory::format
