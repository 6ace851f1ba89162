#include "memory/catalogue/catalogue.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/files.h"
#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "memory/recorder/checkpoint.h"

namespace loci::memory {
namespace {

constexpr const char* kFormat = "loci-catalogue";
constexpr int kVersion = 1;

float rounded(float value) {
  return std::round(value * 1e4F) / 1e4F;
}

Json view_json(const std::vector<belief::Descriptor>& view) {
  Json json = Json::array();
  for (const belief::Descriptor& d : view) {
    std::vector<float> values = d.values;
    for (float& value : values) value = rounded(value);
    json.push_back({{"kind", d.kind}, {"values", values}});
    if (!d.names.empty()) json.back()["names"] = d.names;
  }
  return json;
}

std::vector<belief::Descriptor> view_from(const Json& json) {
  std::vector<belief::Descriptor> view;
  for (const Json& one : json) {
    belief::Descriptor d{one.at("kind"), one.at("values"), {}};
    if (one.contains("names")) d.names = one.at("names").get<std::vector<std::string>>();
    if (!d.names.empty() && d.names.size() != d.values.size())
      throw Error("a view has not as many names as values");
    if (!std::ranges::all_of(d.values, [](float value) { return std::isfinite(value); }))
      throw Error("a value of a view is not a finite number");
    view.push_back(std::move(d));
  }
  return view;
}

Json entry_json(const CatalogueEntry& entry) {
  Json json = {{"name", entry.name}, {"observations", entry.observations}};
  if (!entry.class_name.empty()) json["class"] = entry.class_name;
  Json facts = Json::array();
  for (const auto& [key, value] : entry.facts) facts.push_back({{"key", key}, {"value", value}});
  if (!facts.empty()) json["facts"] = facts;
  if (!entry.color.empty()) json["color"] = entry.color;
  if (entry.size) json["size_m"] = {entry.size->x(), entry.size->y(), entry.size->z()};
  for (const auto& [kind, values] : entry.terms) json["terms"][kind] = values;
  json["views"] = Json::array();
  for (const auto& view : entry.views) json["views"].push_back(view_json(view));
  return json;
}

CatalogueEntry entry_from(const Json& json) {
  CatalogueEntry entry;
  entry.name = json.at("name");
  entry.class_name = json.value("class", "");
  const Json observations = json.value("observations", Json(0U));
  if (!observations.is_number_unsigned()) throw Error("the observations of an object are no count");
  entry.observations = observations;
  for (const Json& fact : json.value("facts", Json::array()))
    entry.facts.emplace_back(fact.at("key"), fact_value(fact.at("key"), fact.at("value")));
  entry.color = json.value("color", "");
  if (json.contains("size_m")) {
    const auto size = json.at("size_m").get<std::array<double, 3>>();
    entry.size = Vector3d(size[0], size[1], size[2]);
  }
  entry.terms = json.value("terms", ObjectTerms());
  for (const Json& view : json.value("views", Json::array())) entry.views.push_back(view_from(view));
  remove_terms(entry.views);
  return entry;
}

}  // namespace

std::string home_of(const Store& store) {
  const std::vector<RecordingRow> recordings = store.recordings();
  if (!recordings.empty()) return content_hash("recording " + recordings.front().fingerprint).substr(0, 16);
  const std::vector<SceneRow> scenes = store.scenes();
  if (scenes.empty()) return {};
  return content_hash("scene " + std::to_string(scenes.front().time)).substr(0, 16);
}

Catalogue catalogue_of(const Store& store) {
  Catalogue catalogue;
  catalogue.home = home_of(store);
  catalogue.handling = load_belief(store).interaction.statistics().by_class;
  ViewReader views(store);
  std::map<Id, std::string> place_class;
  for (const PlaceRow& place : store.places()) place_class[place.id] = place.class_name;
  for (const BeliefRow& belief : store.beliefs()) {
    CatalogueEntry entry;
    entry.name = object_name(belief.object);
    const ObjectClass stated = class_of(store, belief.object);
    // Facts from another home belong to its own catalogue.
    if (stated.by != kCatalogueSource) entry.class_name = stated.name;
    for (const FactRow& fact : store.facts())
      if (fact.object == belief.object && fact.value && fact.key != "class" && fact.key != "state" &&
          fact.clock.source != kCatalogueSource)
        entry.facts.emplace_back(fact.key, *fact.value);
    entry.color = belief.color.value_or("");
    entry.size = belief.size;
    entry.terms = terms_of(store, belief.object);
    for (auto& [kind, values] : entry.terms)
      for (auto& [value, agreement] : values) agreement = std::round(agreement * 1e3) / 1e3;
    entry.views = views.views_of(belief.object);
    for (const ObjectObservation& observed : store.observations_of(belief.object)) {
      ++entry.observations;
      if (!entry.class_name.empty() && observed.observation.place)
        catalogue.kept_on[entry.class_name][place_class[*observed.observation.place]] += 1;
    }
    catalogue.entries.push_back(std::move(entry));
  }
  for (auto& [name, places] : catalogue.kept_on) {
    double all = 0;
    for (const auto& [place, count] : places) all += count;
    for (auto& [place, count] : places) count = std::round(1000 * count / all) / 1000;
  }
  return catalogue;
}

Json to_json(const Catalogue& catalogue) {
  Json json = {
      {"format", kFormat}, {"version", kVersion}, {"home", catalogue.home}, {"objects", Json::array()}};
  for (const CatalogueEntry& entry : catalogue.entries) json["objects"].push_back(entry_json(entry));
  json["habits"] = Json::object();
  for (const auto& [name, factor] : catalogue.handling)
    json["habits"][name]["handled"] = {{"found", factor.found}, {"expected", factor.expected}};
  for (const auto& [name, places] : catalogue.kept_on) json["habits"][name]["kept_on"] = places;
  return json;
}

Catalogue catalogue_from(const Json& json, const std::string& file) {
  if (!json.is_object() || !json.contains("format") || json.at("format") != kFormat)
    throw Error("is not a catalogue", {file, 0, {}}, "loci-memory catalogue export writes one");
  if (!json.contains("version") || json.at("version") != kVersion)
    throw Error("this catalogue was written by another version of loci", {file, 0, {}});
  try {
    Catalogue catalogue;
    catalogue.home = json.at("home");
    for (const Json& entry : json.at("objects")) catalogue.entries.push_back(entry_from(entry));
    const Json of_classes = json.value("habits", Json::object());
    for (const auto& [name, habits] : of_classes.items()) {
      if (habits.contains("handled"))
        catalogue.handling[name] = {habits.at("handled").at("found"), habits.at("handled").at("expected")};
      if (habits.contains("kept_on"))
        for (const auto& [place, share] : habits.at("kept_on").items())
          catalogue.kept_on[name][place] = share;
    }
    return catalogue;
  } catch (const nlohmann::json::exception& e) {
    throw Error(std::string("this catalogue cannot be read: ") + e.what(), {file, 0, {}});
  } catch (const Error& e) {
    throw Error(e.message(), {file, 0, {}});
  }
}

Catalogue read_home_catalogue(const std::filesystem::path& file) {
  return catalogue_from(parse_json(read_file(file), file.string()), file.string());
}

}  // namespace loci::memory
