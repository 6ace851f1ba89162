#include "memory/edits/edit_actions.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

/// The one object that words mean.
Id object_of(const Arguments& given, const char* name) {
  const std::string words = given.text(name);
  const std::vector<Id> objects = Snapshot(given.store(), {}).find_objects(words);
  if (objects.size() == 1) return objects.front();
  throw Error(fmt::format("'{}' may be any of {} objects", words, objects.size()), {},
              "name one, as object_3");
}

Parameter object(const char* name) {
  return {.name = name,
          .type = ParameterType::object,
          .help = "One object: object_12, or a name",
          .required = true};
}

Parameter number(const char* name, const char* help) {
  return {.name = name, .type = ParameterType::number, .help = help, .required = true};
}

Parameter words(const char* name, const char* help, bool required = true) {
  return {.name = name, .help = help, .required = required};
}

}  // namespace

const std::vector<EditAction>& edit_actions() {
  static const std::vector<EditAction> all = {
      {.name = "merge",
       .description = "Two objects are one; the older id stays",
       .parameters = {object("one"), object("other")},
       .run =
           [](Store& store, const Arguments& given, Progress& progress) {
             return merge_objects(store, object_of(given, "one"), object_of(given, "other"), progress);
           }},
      {.name = "split",
       .description = "From a time on the observations of an object are of another, new one",
       .parameters = {object("object"),
                      {.name = "time",
                       .type = ParameterType::time,
                       .help = "\"08:30\", \"yesterday 9:00\", ISO 8601",
                       .required = true}},
       .run =
           [](Store& store, const Arguments& given, Progress& progress) {
             return split_object(store, object_of(given, "object"), *given.time("time"), progress);
           }},
      {.name = "label",
       .description = "The class of an observation, for training",
       .parameters = {number("scene", "Number of the scene"),
                      number("observation", "Its number within the scene, from 0"),
                      words("class", "What it is; none = retracted", false)},
       .run =
           [](Store& store, const Arguments& given, Progress&) {
             return label_observation(store, *given.number("scene"), *given.number("observation"),
                                      given.text("class"));
           }},
      {.name = "joint",
       .description = "The type of a joint of the map",
       .parameters = {words("joint", "Its name"), words("type", "revolute, prismatic, fixed, …")},
       .run = [](Store& store, const Arguments& given,
                 Progress&) { return set_joint_type(store, given.text("joint"), given.text("type")); }},
      {.name = "part",
       .description = "The name of a place, link or joint",
       .parameters = {words("part", "The place, link or joint"),
                      words("name", "From now on; none = as before", false)},
       .run = [](Store& store, const Arguments& given,
                 Progress&) { return name_part(store, given.text("part"), given.text("name")); }},
      {.name = "say",
       .description = "A fact about an object or a place",
       .parameters = {words("about", "The object or place"), words("key", "alias, owner, class, state, …"),
                      words("value", "None = retracted", false)},
       .run =
           [](Store& store, const Arguments& given, Progress&) {
             return say(store, given.text("about"), given.text("key"), given.text("value"));
           }},
      {.name = "undo",
       .description = "Takes the last edit back",
       .run = [](Store& store, const Arguments&, Progress& progress) { return undo(store, progress); }},
      {.name = "redo",
       .description = "Makes the edit again that was undone last",
       .run = [](Store& store, const Arguments&, Progress& progress) { return redo(store, progress); }},
  };
  return all;
}

const EditAction* find_edit_action(const std::string& name) {
  const auto found = std::ranges::find(edit_actions(), name, &EditAction::name);
  return found == edit_actions().end() ? nullptr : &*found;
}

Edit make_edit(Store& store, const Query& query, Progress& progress) {
  const EditAction* action = find_edit_action(query.question);
  if (action == nullptr) throw Error(fmt::format("'{}' is no edit", query.question));
  check_arguments(action->name, action->parameters, query);
  return action->run(store, Arguments(store, query, {}), progress);
}

Json to_json(const Edit& edit) {
  Json json = {{"run", edit.run}, {"known", format_time(edit.known)}, {"edit", edit.text}};
  if (!edit.note.empty()) json["note"] = edit.note;
  return json;
}

Json result_json(const Edit& edit) {
  Json json = to_json(edit);
  json["reply"] = {{"text", trimmed(summary(edit))}};
  return json;
}

std::string to_text(const EditList& list) {
  std::string text = list.done.empty() && list.undone.empty() ? "Nothing was edited.\n" : "";
  for (const Edit& edit : list.done) text += edit.text + "\n";
  for (auto edit = list.undone.rbegin(); edit != list.undone.rend(); ++edit)
    text += edit->text + " (undone)\n";
  return text;
}

Json to_json(const EditList& list) {
  Json json = {{"done", Json::array()}, {"undone", Json::array()}};
  for (const Edit& edit : list.done) json["done"].push_back(to_json(edit));
  for (const Edit& edit : list.undone) json["undone"].push_back(to_json(edit));
  return json;
}

}  // namespace loci::memory
