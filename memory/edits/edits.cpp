#include "memory/edits/edits.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/world/urdf.h"
#include "memory/catalogue/catalogue.h"
#include "memory/edits/edit_run.h"
#include "memory/questions/facts.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/snapshot.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/run_configuration.h"

namespace loci::memory {
namespace {

/// For each row a new one that supersedes what is known instead of it by now: the row that it superseded
/// itself, or its retraction. As a whole it says what was said before, in the words of who said it.
template <class Row>
std::vector<Row> reversed_rows(const Store& store, const std::vector<Row>& rows, TimeNs known) {
  std::vector<Row> reversed;
  for (const Row& row : rows) {
    const bool restores = row.clock.supersedes.has_value();
    Row& one = reversed.emplace_back(restores ? store.row<Row>(*row.clock.supersedes) : row);
    if (!restores || one.clock.known_to) one.clock.known_to = known;  // a retraction is never known
    one.clock.supersedes = store.current_row<Row>(row.id);
  }
  return reversed;
}

/// For each object and scene the row of visibility from before a run; one with out_of_view where there was
/// none.
std::vector<VisibilityRow> reversed_visibility(const Store& store, Id run) {
  std::vector<VisibilityRow> reversed = store.rows_of_run<VisibilityRow>(run);
  for (VisibilityRow& row : reversed) {
    if (const auto before = store.visibility_before(row)) {
      row.status = before->status;
      row.probability = before->probability;
    } else {
      row.status = ObjectStatus::out_of_view;
      row.probability.reset();
    }
  }
  return reversed;
}

/// Adds an annotation with the label of an observation.
void add_label(SceneTransaction& rows, Id scene, Id observation, const std::string& label) {
  rows.add_annotation(
      {.scene = scene, .observation = observation, .type = kLabelType, .value = label, .confidence = 1});
}

/// The scene after another in order of time; 0 = none.
Id scene_after(const Store& store, Id scene) {
  const std::vector<SceneRow> scenes = store.scenes();
  const auto found = std::ranges::find(scenes, scene, &SceneRow::id);
  return found == scenes.end() || found + 1 == scenes.end() ? 0 : (found + 1)->id;
}

/// Makes the belief what it was before a correction of identities; scenes that were added since are reasoned
/// about anew with the identities that are `known` now.
void return_to_belief_before(Store& store, SceneTransaction& rows, const RunRow& row, Id reversal,
                             const Json& configuration, KnownIdentities known, Progress& progress) {
  keep_belief(rows, store, reversal);
  const std::optional<Id> kept = restore_belief(rows, store, row.id);
  const Id last = kept.value_or(configuration["last_scene"].get<Id>());
  const Revision revision{scene_after(store, last), kept.value_or(0), std::move(known)};
  if (kept && revision.from == 0) return;
  if (store.scenes_without_reasoning() == 0) revise(store, rows, revision, progress);
}

/// Reverses what a run did, as a new run: rows that superseded others are superseded by them, others are
/// retracted. `known`: what is known of identities without it.
Edit reverse_run(Store& store, const RunRow& row, const std::string& text, const Json& more,
                 const KnownIdentities& known, Progress& progress) {
  Json configuration = configuration_of(row, store.path());
  for (const char* key : {"undoes", "redoes"}) configuration.erase(key);
  configuration.update(more);
  configuration["text"] = text;
  for (const char* kind : {"label", "map", "part"})
    if (configuration.contains(kind)) {
      Json& change = configuration[kind];
      std::swap(change["before"], change["after"]);
    }
  EditRun run(store, configuration);
  SceneTransaction added(store, run.id());
  added.postpone_derived();
  const TimeNs now = added.known();
  for (const auto& one : reversed_rows(store, store.rows_of_run<AssociationRow>(row.id), now))
    added.add_association(one);
  for (const auto& one : reversed_rows(store, store.rows_of_run<EventRow>(row.id), now)) added.add_event(one);
  for (const auto& one : reversed_rows(store, store.rows_of_run<FactRow>(row.id), now)) added.add_fact(one);
  for (const auto& one : reversed_rows(store, store.rows_of_run<BeliefRow>(row.id), now))
    added.add_belief(one);
  for (const VisibilityRow& one : reversed_visibility(store, row.id)) added.add_visibility(one);
  if (configuration.contains("last_scene"))
    return_to_belief_before(store, added, row, run.id(), configuration, known, progress);
  if (configuration.contains("label")) {
    const Json& label = configuration["label"];
    add_label(added, label["scene"].get<Id>(), label["observation"].get<Id>(),
              label["after"].get<std::string>());
  }
  if (configuration.contains("map")) {
    const Id like = configuration["map"]["after"].get<Id>();
    for (const MapRow& map : store.maps())
      if (map.id == like) {
        store.add_correction(map, store.blob(map.urdf).bytes);
        break;
      }
  }
  added.commit();
  apply_catalogues(store);
  return run.finish();
}

bool is_edit(const RunRow& run) {
  return run.program.starts_with(kEditProgram) || run.program.starts_with("loci-memory fact ");
}

std::string text_of(const Store& store, const RunRow& run, const Json& configuration) {
  if (configuration.contains("text")) return configuration["text"].get<std::string>();
  std::string text;  // of `fact set` and `fact remove`
  for (const FactRow& fact : store.rows_of_run<FactRow>(run.id)) {
    const std::string what = fact.key + (fact.value ? " is " + *fact.value : " is retracted");
    if (!text.empty()) {
      text += ", " + what;
    } else if (fact.object) {
      text = object_name(*fact.object) + ": " + what;
    } else {
      for (const PlaceRow& place : store.places())
        if (place.id == fact.place) text = place.name + ": " + what;
    }
  }
  if (!text.empty()) return text;
  return run.program;
}

/// Reverses an edit; `others` are those that hold then.
Edit toggle(Store& store, const Edit& edit, const char* what, const std::vector<Edit>& others,
            Progress& progress) {
  RunRow row;
  for (const RunRow& run : store.runs())
    if (run.id == edit.run) row = run;
  return reverse_run(store, row, edit.text, {{what, edit.run}}, known_identities(store, others), progress);
}

/// Something that has a name: what the map (or who found it) calls it, and what it is called now.
struct Named {
  const char* of;  ///< place, link or joint
  std::string in_map, now;
  bool is_called(const std::string& name) const { return name == in_map || name == now; }
};

/// Places before links and joints: who names a place means what is there.
std::vector<Named> all_named(const Store& store) {
  std::vector<Named> all;
  const std::vector<PlaceRow> before = store.places(), now = named_places(store);
  for (size_t i = 0; i < before.size(); ++i) all.push_back({"place", before[i].name, now[i].name});
  const std::optional<MapRow> map = store.map_at();
  if (!map) return all;
  const mapping::World world = mapping::parse_urdf(store.blob(map->urdf).bytes, map->name);
  const PartNames names = part_names(store);
  for (const mapping::Link& link : world.links)
    if (std::none_of(before.begin(), before.end(),
                     [&](const PlaceRow& place) { return place.name == link.name; }))
      all.push_back({"link", link.name, names.link(link.name)});
  for (const mapping::Joint& joint : world.joints)
    all.push_back({"joint", joint.name, names.joint(joint.name)});
  return all;
}

}  // namespace

Progress& no_progress() {
  static NoProgress silent;
  return silent;
}

std::string summary(const Edit& edit) {
  return (edit.undone ? "Undone: " : "Done: ") + edit.text + (edit.note.empty() ? "" : "; " + edit.note) +
         "\n";
}

KnownIdentities known_identities(const Store& store) {
  return known_identities(store, edits(store).done);
}

EditList edits(const Store& store) {
  EditList list;
  const auto move_to = [](std::vector<Edit>& from, std::vector<Edit>& to, const Edit& now, Id turned) {
    const auto found =
        std::find_if(from.begin(), from.end(), [&](const Edit& edit) { return edit.run == turned; });
    if (found != from.end()) from.erase(found);
    to.push_back(now);
  };
  for (const RunRow& run : store.runs()) {
    if (!is_edit(run) || !run.finished) continue;
    const Json configuration = configuration_of(run, store.path());
    if (configuration.contains("forgotten")) continue;  // it was about something that was forgotten
    const Edit edit = {run.id, run.started, text_of(store, run, configuration), {}};
    if (configuration.contains("undoes")) {
      move_to(list.done, list.undone, edit, configuration["undoes"].get<Id>());
    } else if (configuration.contains("redoes")) {
      move_to(list.undone, list.done, edit, configuration["redoes"].get<Id>());
    } else {
      list.done.push_back(edit);
      list.undone.clear();  // a new edit ends what could be redone
    }
  }
  return list;
}

std::string label_of(const Store& store, Id scene, Id observation) {
  std::string label;
  for (const AnnotationRow& row : store.annotations(scene))
    if (row.type == kLabelType && row.observation == observation) label = row.value;
  return label;
}

Edit label_observation(Store& store, Id scene, int64_t number, const std::string& class_name) {
  require_utf8(class_name);
  for (const ObservationRow& row : store.observations(scene)) {
    if (row.number != number) continue;
    const std::string before = label_of(store, scene, row.id);
    const std::string what = fmt::format("observation {} of scene {}", number, scene);
    EditRun run(
        store,
        {{"text",
          class_name.empty() ? what + " has no label any more" : fmt::format("{} is a {}", what, class_name)},
         {"label", {{"scene", scene}, {"observation", row.id}, {"before", before}, {"after", class_name}}}});
    SceneTransaction rows(store, run.id());
    add_label(rows, scene, row.id, class_name);
    rows.commit();
    return run.finish();
  }
  refuse(store, fmt::format("scene {} has no observation {}", scene, number), "they are counted from 0");
}

Edit say(Store& store, const std::string& about, const std::string& key, const std::string& value) {
  ChangeTransaction all(store);
  if (value.empty())
    remove_fact(store, about, key, "");
  else
    set_fact(store, about, key, value);
  const EditList list = edits(store);
  if (list.done.empty()) refuse(store, "nothing was changed", "the memory has this fact already");
  apply_catalogues(store);
  all.commit();
  return list.done.back();
}

CatalogueResult teach(Store& store, const std::string& object, const std::string& class_name) {
  ChangeTransaction all(store);
  set_facts(store, object, {{"class", class_name}, {kTaughtKey, class_name}});
  CatalogueResult result = apply_catalogues(store);
  all.commit();
  return result;
}

Edit name_place(Store& store, const std::string& place, const std::string& name) {
  const Snapshot snapshot(store, {});
  const std::vector<PlaceRow> meant = snapshot.places_called(place);
  if (meant.size() != 1)
    refuse(store,
           meant.empty() ? fmt::format("no place is called '{}'", place)
                         : fmt::format("'{}' may be any of {} places", place, meant.size()),
           "loci-memory room lists them");
  for (const PlaceRow& other : snapshot.places_called(name))
    if (other.id != meant[0].id && other.name == name)
      refuse(store, fmt::format("another place is called '{}'", name), "give it another name");
  if (name.starts_with("object_"))
    refuse(store, fmt::format("'{}' is the name of an object", name), "give it another name");
  return say(store, meant[0].name, kPlaceNameKey, name);
}

Edit set_joint_type(Store& store, const std::string& joint, const std::string& type) {
  const std::optional<MapRow> newest = store.map_at();
  if (!newest) refuse(store, "this memory was made without a map", "give --map when perceiving");
  mapping::World world = mapping::parse_urdf(store.blob(newest->urdf).bytes, newest->name);
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
    throw Error(fmt::format("the map has no joint '{}'", joint), {newest->name, 0, {}},
                did_you_mean(joint, joints));
  if (found->type == *wanted)
    refuse(store, fmt::format("{} is {} already", joint, type), "give another type");
  const std::string text = fmt::format("{} is {}, not {}", joint, type, joint_type_name(found->type));
  found->type = *wanted;
  const bool needs_limits =
      *wanted == mapping::JointType::revolute || *wanted == mapping::JointType::prismatic;
  if (needs_limits && !found->limits) found->limits = mapping::JointLimits{};
  ChangeTransaction all(store);
  const Id corrected = store.add_correction(*newest, urdf_text(world));
  EditRun run(store, {{"text", text}, {"map", {{"before", newest->id}, {"after", corrected}}}});
  Edit made = run.finish();
  all.commit();
  return made;
}

Edit name_part(Store& store, const std::string& part, const std::string& name) {
  if (!name.empty()) require_part_name(name);
  const std::vector<Named> all = all_named(store);
  const auto meant =
      std::find_if(all.begin(), all.end(), [&](const Named& named) { return named.is_called(part); });
  if (meant == all.end()) {
    std::vector<std::string> known;
    for (const Named& named : all) known.push_back(named.now);
    refuse(store, fmt::format("neither place, link nor joint is called '{}'", part),
           did_you_mean(part, known));
  }
  for (const Named& other : all)
    if (&other != &*meant && other.is_called(name))
      refuse(store, fmt::format("another {} is called '{}'", other.of, name), "give it another name");
  if (meant->of == std::string("place")) return name_place(store, meant->in_map, name);
  const std::string after = name == meant->in_map ? "" : name;
  const std::string before = meant->now == meant->in_map ? "" : meant->now;
  if (after == before)
    refuse(store, fmt::format("the {} is called {} already", meant->of, meant->now), "give it another name");
  const std::string text = after.empty() ? fmt::format("{} is called so again", meant->in_map)
                                         : fmt::format("{} is called {}", meant->in_map, after);
  EditRun run(store,
              {{"text", text},
               {"part", {{"of", meant->of}, {"name", meant->in_map}, {"before", before}, {"after", after}}}});
  return run.finish();
}

Edit undo(Store& store, Progress& progress) {
  EditList list = edits(store);
  if (list.done.empty())
    refuse(store, "there is nothing to undo", "loci-memory edit list shows what was done");
  const Edit last = list.done.back();
  list.done.pop_back();
  Edit undone = toggle(store, last, "undoes", list.done, progress);
  undone.undone = true;
  return undone;
}

Edit redo(Store& store, Progress& progress) {
  EditList list = edits(store);
  if (list.undone.empty())
    refuse(store, "there is nothing to redo", "loci-memory edit list shows what was undone");
  list.done.push_back(list.undone.back());
  return toggle(store, list.undone.back(), "redoes", list.done, progress);
}

}  // namespace loci::memory
