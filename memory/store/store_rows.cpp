// Rows of the tables, and the parts of questions that many of them have.

#include "mapping/base/json.h"
#include "memory/store/reading.h"

namespace loci::memory {

std::string known_condition(const AsOf& as_of, std::vector<SqlValue>& values) {
  if (!as_of.known_at) return "known_to IS NULL";
  values.push_back(sql(*as_of.known_at));
  const size_t n = values.size();
  return fmt::format("known_from <= ?{0} AND (known_to IS NULL OR known_to > ?{0})", n);
}

std::string valid_condition(const AsOf& as_of, std::vector<SqlValue>& values, bool open) {
  if (!as_of.at) return open ? "valid_to IS NULL" : "1";
  values.push_back(sql(*as_of.at));
  const size_t n = values.size();
  return open ? fmt::format("valid_from <= ?{0} AND (valid_to IS NULL OR valid_to > ?{0})", n)
              : fmt::format("valid_from <= ?{}", n);
}

std::string range_condition(const char* column, std::optional<TimeNs> from, std::optional<TimeNs> to,
                            std::vector<SqlValue>& values) {
  std::string text;
  if (from) {
    values.push_back(sql(*from));
    text += fmt::format(" AND {} >= ?{}", column, values.size());
  }
  if (to) {
    values.push_back(sql(*to));
    text += fmt::format(" AND {} <= ?{}", column, values.size());
  }
  return text;
}

RecordingRow recording_row(const SqlRow& row) {
  RecordingRow result;
  result.id = row.integer("id");
  result.fingerprint = row.text("fingerprint");
  result.name = row.text("name");
  result.kind = row.text("kind");
  result.time_assumed = row.integer("time_assumed") != 0;
  result.frames = row.optional_integer("frames");
  return result;
}

PlaceRow place_row(const SqlRow& row) {
  PlaceRow result;
  result.id = row.integer("id");
  result.name = row.text("name");
  result.class_name = row.text("class");
  result.map = row.optional_integer("map");
  result.height = row.optional_real("height");
  if (const auto outline = row.optional_text("outline"))
    for (const Json& point : parse_json(*outline, "place.outline"))
      result.outline.emplace_back(point.at(0).get<double>(), point.at(1).get<double>());
  result.map_from_place = row.pose("");
  result.container = row.integer("container") != 0;
  result.joint = row.optional_text("joint");
  return result;
}

SceneRow scene_row(const SqlRow& row) {
  SceneRow result;
  result.id = row.integer("id");
  result.recording = row.optional_integer("recording");
  result.frame_index = row.optional_integer("frame_index");
  result.time = row.integer("time");
  result.map = row.optional_integer("map");
  // In the order of the columns, which finds them at once.
  SceneCamera camera;
  camera.width = static_cast<int>(row.optional_integer("camera_width").value_or(0));
  camera.height = static_cast<int>(row.optional_integer("camera_height").value_or(0));
  if (const std::optional<double> fx = row.optional_real("fx"); fx && camera.width > 0) {
    camera.fx = *fx;
    camera.fy = row.real("fy");
    camera.cx = row.real("cx");
    camera.cy = row.real("cy");
    camera.range_min = row.optional_real("range_min");
    camera.range_max = row.optional_real("range_max");
    result.camera = camera;
  }
  result.map_from_camera = row.pose("");
  result.depth = row.optional_integer("depth");
  result.depth_width = static_cast<int>(row.optional_integer("depth_width").value_or(0));
  result.depth_height = static_cast<int>(row.optional_integer("depth_height").value_or(0));
  result.image = row.optional_integer("image");
  if (const auto text = row.optional_text("joints")) {
    const Json joints = parse_json(*text, "scene.joints");
    for (const auto& [joint, position] : joints.items()) result.joints[joint] = position.get<double>();
  }
  result.known_from = row.integer("known_from");
  result.run = row.integer("run");
  result.kinds = row.optional_integer("kinds");
  return result;
}

ObservationRow observation_row(const SqlRow& row) {
  ObservationRow result;
  result.id = row.integer("id");
  result.scene = row.integer("scene");
  result.number = row.integer("number");
  result.place = row.optional_integer("place");
  result.position = row.vector("");
  result.map_from_box = row.pose("box_");
  result.size = row.vector("size_");
  result.hsv = row.color();
  result.color = row.optional_text("color");
  result.points = row.optional_integer("points");
  result.crop = row.optional_integer("crop");
  result.mask = row.optional_integer("mask");
  if (!row.is_null("roi_x"))
    result.roi = {static_cast<int>(row.integer("roi_x")), static_cast<int>(row.integer("roi_y")),
                  static_cast<int>(row.integer("roi_width")), static_cast<int>(row.integer("roi_height"))};
  result.sentence = row.optional_text("sentence");
  result.cloud = row.optional_integer("cloud");
  return result;
}

AssociationRow association_row(const SqlRow& row) {
  AssociationRow result;
  result.id = row.integer("id");
  result.scene = row.integer("scene");
  result.observation = row.optional_integer("observation");
  result.object = row.optional_integer("object");
  result.explanation = row.state<Explanation>("explanation");
  result.probability = row.real("probability");
  result.chosen = row.integer("chosen") != 0;
  result.clock = row.clock();
  return result;
}

FactRow fact_row(const SqlRow& row) {
  FactRow fact;
  fact.id = row.integer("id");
  fact.object = row.optional_integer("object");
  fact.place = row.optional_integer("place");
  fact.key = row.text("key");
  fact.value = row.optional_text("value");
  fact.probability = row.optional_real("probability");
  fact.clock = row.clock();
  return fact;
}

EventRow event_row(const SqlRow& row) {
  EventRow result;
  result.id = row.integer("id");
  result.scene = row.optional_integer("scene");
  result.kind = row.state<EventKind>("kind");
  result.object = row.optional_integer("object");
  result.observation = row.optional_integer("observation");
  result.place = row.optional_integer("place");
  result.from_place = row.optional_integer("from_place");
  result.position = row.vector("");
  result.from_position = row.vector("from_");
  result.joint = row.optional_text("joint");
  result.joint_position = row.optional_real("position");
  result.from_joint_position = row.optional_real("from_position");
  result.probability = row.real("probability");
  result.since = row.optional_integer("since");
  result.clock = row.clock();
  return result;
}

BeliefRow belief_row(const SqlRow& row) {
  BeliefRow result;
  result.id = row.integer("id");
  result.object = row.integer("object");
  result.scene = row.optional_integer("scene");
  result.status = row.state<ObjectStatus>("status");
  result.probability = row.real("probability");
  result.place = row.optional_integer("place");
  result.position = row.vector("");
  result.sigma = row.optional_real("sigma");
  result.last_scene = row.optional_integer("last_scene");
  result.last_observation = row.optional_integer("last_observation");
  result.hsv = row.color();
  result.color = row.optional_text("color");
  result.size = row.vector("size_");
  result.fade_s = row.optional_real("fade_s");
  result.fade_to = row.optional_real("fade_to");
  result.clock = row.clock();
  result.probability_then = result.probability;
  result.then = result.clock.valid_from;
  return result;
}

VisibilityRow visibility_row(const SqlRow& row) {
  VisibilityRow result;
  result.id = row.integer("id");
  result.scene = row.integer("scene");
  result.object = row.optional_integer("object");
  result.place = row.optional_integer("place");
  result.status = row.state<ObjectStatus>("status");
  result.probability = row.optional_real("probability");
  result.fraction = row.optional_real("fraction");
  result.time = row.integer("valid_from");
  return result;
}

}  // namespace loci::memory
