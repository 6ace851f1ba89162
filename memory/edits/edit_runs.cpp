#include "memory/edits/edit_runs.h"

#include <fmt/format.h>

#include <optional>

#include "mapping/world/urdf.h"
#include "memory/store/edit_rows.h"

namespace loci::memory {
namespace {

/// Of a row that superseded nothing: it is taken back.
AssociationRow taken_back(AssociationRow row) {
  row.probability = 0;
  row.chosen = false;
  return row;
}
EventRow taken_back(EventRow row) {
  row.probability = 0;
  return row;
}
BeliefRow taken_back(BeliefRow row) {
  return row;  // it has been given to another object
}
FactRow taken_back(FactRow row) {
  row.value.reset();
  return row;
}

/// What was before each row takes the place of what is known instead of it by now.
template <class Row, class Before, class Add>
void reverse_rows(const EditRows& all, const char* table, const std::vector<Row>& rows, Before before,
                  Add add) {
  for (const Row& row : rows) {
    Row reversed = row.clock.supersedes ? before(*row.clock.supersedes) : taken_back(row);
    reversed.clock.supersedes = all.known_instead(table, row.id);
    reversed.clock.source = "user";
    reversed.clock.known_to.reset();
    add(reversed);
  }
}

}  // namespace

EditRun::EditRun(Store& store, const Json& configuration)
    : store_(store), id_(store.begin_run(kEditProgram, configuration.dump())) {}

Edit edit_of(const Store& store, Id run) {
  for (const RunRow& row : store.runs())
    if (row.id == run) {
      const Json configuration = parse_json(row.configuration, "run.configuration");
      return {run, row.started, configuration.value("text", row.program)};
    }
  throw Error(fmt::format("no run {}", run), {store.path().string(), 0, {}});
}

Id reverse_run(Store& store, const RunRow& row, const std::string& text, const Json& more) {
  Json configuration = parse_json(row.configuration, "run.configuration");
  for (const char* key : {"undoes", "redoes"}) configuration.erase(key);
  configuration.update(more);
  configuration["text"] = text;
  for (const char* kind : {"label", "map", "part"})
    if (configuration.contains(kind)) {
      Json& change = configuration[kind];
      std::swap(change["before"], change["after"]);
    }
  const EditRows rows(store);
  const Id split = configuration.contains("split") ? configuration["split"]["object"].get<Id>() : 0;
  const EditRun run(store, configuration);
  {
    SceneTransaction added(store, run.id());
    reverse_rows(
        rows, "association", rows.associations_of(row.id), [&](Id id) { return rows.association(id); },
        [&](const AssociationRow& reversed) { added.add_association(reversed); });
    reverse_rows(
        rows, "event", rows.events_of(row.id), [&](Id id) { return rows.event(id); },
        [&](const EventRow& reversed) { added.add_event(reversed); });
    reverse_rows(
        rows, "fact", rows.facts_of(row.id), [&](Id id) { return rows.fact(id); },
        [&](const FactRow& reversed) { added.add_fact(reversed); });
    std::vector<BeliefRow> beliefs = rows.beliefs_of(row.id);
    // What a split added goes on as that of the object which was split.
    for (BeliefRow& belief : beliefs)
      if (!belief.clock.supersedes) belief.object = split;
    reverse_rows(
        rows, "belief", beliefs, [&](Id id) { return rows.belief(id); },
        [&](const BeliefRow& reversed) { added.add_belief(reversed); });
    added.commit();
  }
  if (configuration.contains("label")) {
    const Json& label = configuration["label"];
    add_label(store, run.id(), label["scene"].get<Id>(), label["observation"].get<Id>(),
              label["after"].get<std::string>());
  }
  if (configuration.contains("map")) {
    const Id like = configuration["map"]["after"].get<Id>();
    for (const MapRow& map : store.maps())
      if (map.id == like) {
        add_corrected_map(store, map, store.blob(map.urdf).bytes, text);
        break;
      }
  }
  return run.id();
}

void add_label(Store& store, Id run, Id scene, Id observation, const std::string& label) {
  SceneTransaction rows(store, run);
  rows.add_annotation(
      {.scene = scene, .observation = observation, .type = kLabelType, .value = label, .confidence = 1});
  rows.commit();
}

Id add_corrected_map(Store& store, const MapRow& like, const std::string& urdf, const std::string& remark) {
  const std::string sidecar = like.sidecar ? store.blob(*like.sidecar).bytes : std::string();
  return store.add_map(
      like.name, fmt::format("{}\n<!-- correction {}: {} -->\n", urdf, store.maps().size(), remark), sidecar);
}

Edit set_joint_type(Store& store, const std::string& joint, const std::string& type) {
  const std::vector<MapRow> maps = store.maps();
  if (maps.empty())
    throw Error("this memory was made without a map", {store.path().string(), 0, {}},
                "give --map when perceiving");
  const MapRow newest = maps.back();
  const std::string before = store.blob(newest.urdf).bytes;
  mapping::World world = mapping::parse_urdf(before, newest.name);
  std::optional<mapping::JointType> wanted;
  std::string names;
  for (const mapping::JointType known :
       {mapping::JointType::fixed, mapping::JointType::revolute, mapping::JointType::continuous,
        mapping::JointType::prismatic, mapping::JointType::floating, mapping::JointType::planar}) {
    if (type == joint_type_name(known)) wanted = known;
    names += std::string(names.empty() ? "" : ", ") + joint_type_name(known);
  }
  if (!wanted) throw Error(fmt::format("'{}' is no type of a joint", type), {}, "types are " + names);
  const PartNames called = part_names(store);
  std::vector<std::string> joints;
  mapping::Joint* found = nullptr;
  for (mapping::Joint& candidate : world.joints) {
    joints.push_back(called.joint(candidate.name));
    if (candidate.name == joint || joints.back() == joint) found = &candidate;
  }
  if (found == nullptr)
    throw Error(fmt::format("the map has no joint '{}'", joint), {newest.name, 0, {}},
                did_you_mean(joint, joints));
  const std::string text = fmt::format("{} is {}, not {}", joint, type, joint_type_name(found->type));
  found->type = *wanted;
  const bool needs_limits =
      *wanted == mapping::JointType::revolute || *wanted == mapping::JointType::prismatic;
  if (needs_limits && !found->limits) found->limits = mapping::JointLimits{};
  const Id corrected = add_corrected_map(store, newest, urdf_text(world), text);
  const EditRun run(store, {{"text", text}, {"map", {{"before", newest.id}, {"after", corrected}}}});
  return edit_of(store, run.id());
}

}  // namespace loci::memory
