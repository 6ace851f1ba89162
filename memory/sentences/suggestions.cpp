#include "memory/sentences/suggestions.h"

#include <fmt/format.h>

#include <set>

#include "memory/questions/environment.h"
#include "memory/questions/events.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/names/names.h"
#include "memory/questions/objects.h"
#include "memory/sentences/sentence_parser.h"

namespace loci::memory {

std::vector<std::string> suggested_questions(const Store& store) {
  std::vector<std::string> suggestions;
  const auto name = [](const ObjectRef& object) {
    return object.label ? with_article(*object.label) : object.name;
  };
  const std::vector<ObjectBelief> objects = ask(store, ObjectsQuestion{}).objects;
  if (!objects.empty()) suggestions.push_back(fmt::format("Where is {}?", name(objects.front().object)));
  const std::vector<Change> moves = ask(store, ChangesQuestion{.kind = "moved"}).changes;
  if (!moves.empty() && moves.back().object)
    suggestions.push_back(fmt::format("Where has {} been?", name(*moves.back().object)));
  if (!objects.empty() && objects.front().place)
    suggestions.push_back(fmt::format("What is {} {}?", objects.front().place->container ? "in" : "on",
                                      objects.front().place->name));
  for (std::string& example : all_examples()) suggestions.push_back(std::move(example));
  return suggestions;
}

std::vector<std::string> known_names(const Store& store) {
  std::set<std::string> words;
  for (const ObjectRow& object : store.objects()) words.insert(object_name(object.id));
  for (const PlaceRow& place : named_places(store)) words.insert(place.name);
  const PartNames names = part_names(store);
  for (const auto* parts : {&names.links, &names.joints})
    for (const auto& [in_map, name] : *parts) words.insert(name);
  for (const FactRow& fact : store.facts())
    if (fact.value && (fact.key == "alias" || fact.key == "class")) words.insert(*fact.value);
  return {words.begin(), words.end()};
}

}  // namespace loci::memory
