#include "memory/questions/facts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/names/names.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/snapshot.h"
#include "memory/store/facts.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {
namespace {

struct FactOwner {
  std::optional<Id> object = {}, place = {};
  std::string name = {};
  std::optional<PlaceRow> unseen = {};  ///< a place of the map that no scene has added yet
  bool matches(const FactRow& fact) const {
    return object ? fact.object == object : place && fact.place == place;
  }
};

/// The one object or place that words mean. A place's name comes first.
FactOwner find_one(const Snapshot& snapshot, const std::string& words) {
  const auto places = snapshot.places_called(words);
  std::vector<std::string> names;
  for (const PlaceRow& place : places) names.push_back(place.name);
  if (places.size() == 1) return {.place = places[0].id, .name = places[0].name};
  if (places.empty())
    if (const auto parts = parts_named(snapshot, words); parts.size() == 1 && parts[0].unseen_place)
      return {.name = parts[0].unseen_place->name, .unseen = parts[0].unseen_place};
  std::vector<Id> objects;
  if (places.empty()) objects = snapshot.find_objects(words);
  for (const Id object : objects) names.push_back(object_name(object));
  if (objects.size() == 1) return {.object = objects[0], .name = names[0]};
  throw Error(fmt::format("'{}' may be any of {}", words, fmt::join(names, ", ")), {}, "name one of them");
}

FactsAnswer facts_of(const Snapshot& snapshot, const std::optional<FactOwner>& about,
                     const std::string& key) {
  FactsAnswer answer;
  for (const FactRow& row : snapshot.facts()) {
    if ((about && !about->matches(row)) || (!key.empty() && row.key != key)) continue;
    const auto place = snapshot.place_ref(row.place);
    answer.facts.push_back({row.id,
                            row.object ? object_name(*row.object)
                            : place    ? place->name
                                       : "",
                            row.key, row.value.value_or(""), row.clock.valid_from, row.clock.known_from,
                            row.clock.source, row.probability});
  }
  return answer;
}

FactRow row_for(const Snapshot& snapshot, const FactOwner& about, const std::string& key) {
  FactRow row{.object = about.object, .place = about.place, .key = key};
  // A state holds from now on; a name, a class or an owner hold for the whole memory unless somebody says
  // otherwise.
  const auto& scenes = snapshot.scenes();
  if (!scenes.empty()) row.clock.valid_from = key == "state" ? scenes.back().time : scenes.front().time;
  row.clock.source = "user";
  return row;
}

/// Error when a name could not be told from an object's number or a place of the map.
void require_name(const Snapshot& snapshot, const FactOwner& one, const std::string& name) {
  const auto is_other = [&](const EnvironmentPart& part) {
    const bool is_it = part.place          ? one.place == part.place->id
                       : part.unseen_place ? one.unseen && one.unseen->name == part.unseen_place->name
                                           : false;
    const auto is_alias = [&](const std::string& alias) { return name_key(alias) == name_key(name); };
    return !is_it && std::ranges::none_of(part.aliases, is_alias);
  };
  const bool is_place = std::ranges::any_of(snapshot.places(),
                                            [&](const PlaceRow& place) {
                                              return place.name == name && one.place != place.id;
                                            }) ||
                        std::ranges::any_of(parts_named(snapshot, name), is_other);
  if (is_place || object_id(name))
    throw Error(fmt::format("'{}' is {} already", name, is_place ? "a place" : "the number of an object"), {},
                "choose another name");
}

/// Adds to `rows` those that state a value; none where it is stated already.
void add_rows_of(const Snapshot& snapshot, const FactOwner& one, const std::string& key,
                 const std::string& value, std::vector<FactRow>& rows) {
  const std::vector<Fact> before = facts_of(snapshot, one, key).facts;
  if (std::ranges::any_of(before, [&](const Fact& fact) { return fact.value == value; })) return;
  const bool single = has_one_value(key);
  for (size_t i = 0; single && i + 1 < before.size(); ++i) {
    rows.push_back(row_for(snapshot, one, key));
    rows.back().clock.supersedes = before[i].id;
  }
  rows.push_back(row_for(snapshot, one, key));
  rows.back().value = value;
  if (single && !before.empty()) rows.back().clock.supersedes = before.back().id;
}

/// Whether a fact was stated together with an example: in a run that concerns this object only, so that facts
/// that were copied from another memory are none.
bool is_of_example(const Store& store, const FactRow& fact) {
  const std::vector<FactRow> change = store.rows_of_run<FactRow>(fact.clock.run);
  return std::ranges::all_of(change, [&](const FactRow& other) { return other.object == fact.object; }) &&
         std::ranges::any_of(change,
                             [](const FactRow& other) { return other.key == kTaughtKey && other.value; });
}

/// An example that is withdrawn takes the class along that was stated with it: what had been said before
/// holds again.
void take_class_back(const Snapshot& snapshot, const FactOwner& one, const Fact& taught,
                     std::vector<FactRow>& rows, std::vector<Fact>& retracted) {
  const Store& store = snapshot.store();
  for (const Fact& stated : facts_of(snapshot, one, "class").facts) {
    FactRow before = store.row<FactRow>(stated.id);
    if (stated.value != taught.value || !is_of_example(store, before)) continue;
    while (before.clock.supersedes && is_of_example(store, before))
      before = store.row<FactRow>(*before.clock.supersedes);
    if (is_of_example(store, before)) before.value.reset();
    before.clock.supersedes = stated.id;
    before.clock.known_to.reset();
    rows.push_back(before);
    retracted.push_back(stated);
  }
}

/// Adds the rows of one change as one run, all of them or none.
void add_rows(Store& store, const char* verb, std::vector<FactRow> rows, FactOwner& one) {
  if (rows.empty()) return;
  const Id run = store.begin_run(fmt::format("loci-memory fact {}", verb), "{}");
  SceneTransaction change(store, run);
  if (one.unseen) one.place = change.add_place(*one.unseen);
  for (FactRow& row : rows) {
    row.place = one.place;
    change.add_fact(row);
  }
  store.finish_run(run);
  change.commit();
}

}  // namespace

FactsAnswer ask(const Store& store, const FactsQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  std::optional<FactOwner> about;
  if (!question.about.empty()) about = find_one(snapshot, question.about);
  return facts_of(snapshot, about, question.key);
}

FactsAnswer set_fact(Store& store, const std::string& about, const std::string& key,
                     const std::string& value) {
  return set_facts(store, about, {{key, value}});
}

FactsAnswer set_facts(Store& store, const std::string& about,
                      std::vector<std::pair<std::string, std::string>> values) {
  for (auto& [key, value] : values) {
    if (key == kPlaceNameKey) require_part_name(value);
    value = fact_value(key, value);
  }
  const Snapshot snapshot(store, {});
  FactOwner one = find_one(snapshot, about);
  for (const auto& [key, value] : values)
    if (key == "alias") require_name(snapshot, one, value);
  std::vector<FactRow> rows;
  for (const auto& [key, value] : values) add_rows_of(snapshot, one, key, value, rows);
  add_rows(store, "set", rows, one);
  FactsAnswer answer;
  const Snapshot now(store, {});
  for (const auto& [key, value] : values)
    for (Fact& fact : facts_of(now, one, key).facts) answer.facts.push_back(std::move(fact));
  return answer;
}

FactsAnswer remove_fact(Store& store, const std::string& about, const std::string& key,
                        const std::string& value) {
  const Snapshot snapshot(store, {});
  FactOwner one = find_one(snapshot, about);
  std::vector<FactRow> rows;
  std::vector<Fact> retracted;
  for (const Fact& fact : facts_of(snapshot, one, key).facts) {
    if (!value.empty() && fact.value != value) continue;
    rows.push_back(row_for(snapshot, one, key));
    rows.back().clock.supersedes = fact.id;
    retracted.push_back(fact);
    if (key == kTaughtKey) take_class_back(snapshot, one, fact, rows, retracted);
  }
  if (rows.empty())
    throw Error(
        fmt::format("{} has no {}{}", one.name, key, value.empty() ? "" : fmt::format(" '{}'", value)), {},
        "see loci-memory fact list");
  add_rows(store, "remove", rows, one);
  const Snapshot now(store, {});
  FactsAnswer answer = facts_of(now, one, key);
  if (retracted.back().key != key)
    for (Fact& fact : facts_of(now, one, retracted.back().key).facts) answer.facts.push_back(std::move(fact));
  answer.retracted = std::move(retracted);
  return answer;
}

std::string to_text(const FactsAnswer& answer) {
  if (answer.facts.empty() && answer.retracted.empty()) return "No such fact is known.\n";
  std::string text;
  for (const Fact& fact : answer.retracted)
    text += fmt::format("Removed: {} {} {}\n", fact.about, fact.key, fact.value);
  for (const Fact& fact : answer.facts)
    text += fmt::format("{} {} {} (says {}{})\n", fact.about, fact.key, fact.value, fact.source,
                        fact.probability ? fmt::format(", {:.0f} %", 100 * *fact.probability) : "");
  return text;
}

namespace format {

const Record<Fact>& fact_record() {
  static const auto record = Record<Fact>("Fact")
                                 .value("about", &Fact::about)
                                 .value("key", &Fact::key)
                                 .value("value", &Fact::value)
                                 .time("valid_from", &Fact::valid_from)
                                 .time("known_from", &Fact::known_from)
                                 .value("source", &Fact::source)
                                 .value("probability", &Fact::probability);
  return record;
}

}  // namespace format

Json to_json(const FactsAnswer& answer) {
  const auto list = [](const std::vector<Fact>& facts) {
    Json json = Json::array();
    for (const Fact& fact : facts) json.push_back(format::fact_record().json(fact));
    return json;
  };
  Json json = {{"facts", list(answer.facts)}};
  if (!answer.retracted.empty()) json["retracted"] = list(answer.retracted);
  return json;
}

}  // namespace loci::memory
