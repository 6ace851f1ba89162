#include "memory/edits/edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/world/urdf.h"
#include "memory/catalogue/catalogue.h"
#include "memory/edits/edit_run.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/facts.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/names/names.h"
#include "memory/questions/snapshot.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/facts.h"
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

/// The rows of associations that a run superseded and that say what an observation is of.
std::vector<AssociationRow> decisions_before(const Store& store, Id run) {
  std::vector<AssociationRow> before;
  for (const AssociationRow& row : store.rows_of_run<AssociationRow>(run))
    if (row.clock.supersedes) before.push_back(store.row<AssociationRow>(*row.clock.supersedes));
  std::erase_if(before, [](const AssociationRow& row) {
    return !row.chosen || !row.observation || !row.object || row.probability <= 0 || row.clock.known_to;
  });
  return before;
}

/// Undoes a correction of identities by reasoning with those from before it.
void reason_without(const Store& store, SceneTransaction& rows, Id run, KnownIdentities known,
                    Progress& progress) {
  std::set<Id> concerned;
  for (const AssociationRow& row : decisions_before(store, run)) {
    known.emplace(*row.observation, *row.object);
    concerned.insert(row.scene);
  }
  for (const AssociationRow& row : store.rows_of_run<AssociationRow>(run)) concerned.insert(row.scene);
  const std::vector<SceneRow> scenes = store.scenes();
  const auto first =
      std::ranges::find_if(scenes, [&](const SceneRow& scene) { return concerned.contains(scene.id); });
  if (first == scenes.end()) return;  // nothing of it is left
  revise(store, rows, {.from = first->id, .known = std::move(known)}, progress);
}

/// Reverses what a run did to the history of objects, row by row.
void reverse_history(const Store& store, SceneTransaction& rows, Id run) {
  const TimeNs now = rows.known();
  for (const auto& one : reversed_rows(store, store.rows_of_run<AssociationRow>(run), now))
    rows.add_association(one);
  for (const auto& one : reversed_rows(store, store.rows_of_run<EventRow>(run), now)) rows.add_event(one);
  for (const auto& one : reversed_rows(store, store.rows_of_run<BeliefRow>(run), now)) rows.add_belief(one);
  for (const VisibilityRow& one : reversed_visibility(store, run)) rows.add_visibility(one);
}

/// Reverses a correction of identities that was reasoned about, as part of the run `reversal`: the belief is
/// what it was before, and scenes that were added since are reasoned about anew with the identities that are
/// `known` now. Where the belief was not kept, for something was forgotten or a memory was merged since, rows
/// of others may be missing: then all is reasoned about anew from the first scene on that it concerns.
void reverse_reasoning(Store& store, SceneTransaction& rows, Id run, Id reversal, KnownIdentities known,
                       Progress& progress) {
  const bool with_evidence = store.scenes_without_reasoning() == 0;
  keep_belief(rows, store, reversal);
  const std::optional<Id> kept = restore_belief(rows, store, run);
  if (!kept && with_evidence) return reason_without(store, rows, run, std::move(known), progress);
  reverse_history(store, rows, run);
  const Id later = kept ? scene_after(store, *kept) : 0;
  if (later != 0 && with_evidence) revise(store, rows, {later, *kept, std::move(known)}, progress);
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
  for (const auto& one : reversed_rows(store, store.rows_of_run<FactRow>(row.id), added.known()))
    added.add_fact(one);
  if (configuration.contains("last_scene"))
    reverse_reasoning(store, added, row.id, run.id(), known, progress);
  else
    reverse_history(store, added, row.id);
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
        if (place.id == fact.place) text = name_in_words(place.name) + ": " + what;
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
  std::string of;  ///< place, link or joint
  std::string in_map, now;
  bool is_called(const std::string& name) const { return name == in_map || name == now; }
  bool operator==(const Named&) const = default;
};
constexpr const char* kPlace = "place";

/// Places before links and joints: who names a place means what is there.
std::vector<Named> all_named(const Store& store) {
  std::vector<Named> all;
  const std::vector<PlaceRow> before = store.places(), now = named_places(store);
  for (size_t i = 0; i < before.size(); ++i) all.push_back({kPlace, before[i].name, now[i].name});
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

/// The place of a piece of furniture, whether a scene has added it yet or not; unset without one.
std::optional<Named> place_of(const EnvironmentPart& piece, const std::vector<Named>& all) {
  if (piece.unseen_place) return Named{kPlace, piece.unseen_place->name, piece.unseen_place->name};
  const auto place = std::ranges::find_if(
      all, [&](const Named& one) { return piece.place && one.of == kPlace && one.now == piece.place->name; });
  return place == all.end() ? std::nullopt : std::optional(*place);
}

/// What a name means: the place, link or joint that is called so, else the piece of furniture ("drawer_2").
/// A piece is named by its place, where objects are, if it has one, else by its link.
Named named(const Store& store, const std::vector<Named>& all, const std::string& part) {
  const auto exact = std::ranges::find_if(all, [&](const Named& one) { return one.is_called(part); });
  const bool is_link = exact != all.end() && exact->of == "link" && exact->now == exact->in_map;
  if (exact != all.end() && !is_link) return *exact;
  const Snapshot snapshot(store, {});
  const std::vector<EnvironmentPart> pieces = parts_named(snapshot, part);
  if (pieces.size() == 1) {
    const EnvironmentPart& piece = pieces.front();
    const std::optional<Named> place = place_of(piece, all);
    const bool is_it =
        !is_link || piece.map_name == exact->in_map || (place && place->in_map == exact->in_map);
    if (is_it && place) return *place;
    if (is_it) return *std::ranges::find(all, piece.map_name, &Named::in_map);
  }
  if (is_link) return *exact;
  std::vector<std::string> known;
  for (const Named& one : all) known.push_back(one.now);
  if (pieces.size() > 1)
    refuse(store, fmt::format("'{}' may be any of {} parts", part, pieces.size()),
           "loci-memory room lists them");
  refuse(store, fmt::format("neither place, link nor joint is called '{}'", part), did_you_mean(part, known));
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
    // It was about something that was forgotten, or about a scene of which another memory's decisions hold.
    if (configuration.contains("forgotten") || configuration.contains(kLeftBehind)) continue;
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
  std::vector<PlaceRow> meant = snapshot.places_called(place);
  if (const auto pieces = parts_named(snapshot, place);
      meant.empty() && pieces.size() == 1 && pieces[0].unseen_place)
    meant.push_back(*pieces[0].unseen_place);
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
  if (const auto pieces = parts_named(Snapshot(store, {}), joint);
      found == nullptr && pieces.size() == 1 && pieces[0].motion)
    found = &*std::ranges::find(world.joints, pieces[0].motion->map_joint, &mapping::Joint::name);
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
  const Named meant = named(store, all, part);
  for (const Named& other : all)
    if (!(other == meant) && other.is_called(name))
      refuse(store, fmt::format("another {} is called '{}'", other.of, name), "give it another name");
  if (meant.of == kPlace) return name_place(store, meant.in_map, name);
  const std::string after = name == meant.in_map ? "" : name;
  const std::string before = meant.now == meant.in_map ? "" : meant.now;
  if (after == before)
    refuse(store, fmt::format("the {} is called {} already", meant.of, meant.now), "give it another name");
  const std::string text = after.empty() ? fmt::format("{} is called so again", meant.in_map)
                                         : fmt::format("{} is called {}", meant.in_map, after);
  EditRun run(store,
              {{"text", text},
               {"part", {{"of", meant.of}, {"name", meant.in_map}, {"before", before}, {"after", after}}}});
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
