#include "gui/data/image_notes.h"

#include <map>

#include "mapping/base/json.h"
#include "memory/store/store.h"

namespace loci::gui {
namespace {

/// A feature that refers to another structure: written in it, or by its id ("#2").
Json referred(const Json& value, const std::map<std::string, Json>& by_id) {
  if (value.is_object()) return value.value("features", Json::object());
  const auto found = value.is_string() ? by_id.find(value.get<std::string>()) : by_id.end();
  return found == by_id.end() ? Json::object() : found->second.value("features", Json::object());
}

/// What people read of it, whatever its type calls that.
std::string text_of(const Json& features) {
  std::string text;
  for (const char* name : {"title", "name", "text", "code", "brand", "result_text"})
    if (features.contains(name) && features[name].is_string()) {
      const auto part = features[name].get<std::string>();
      if (!part.empty() && text.find(part) == std::string::npos) text += (text.empty() ? "" : ", ") + part;
    }
  return text;
}

}  // namespace

std::vector<ImageNote> notes_in(const std::string& text) {
  std::vector<ImageNote> notes;
  if (text.find("\"roi\"") == std::string::npos) return notes;
  const Json structures = parse_json(text, "feature_structure").value("structures", Json::array());
  std::map<std::string, Json> by_id;
  for (const Json& structure : structures)
    if (structure.contains("id") && structure["id"].is_string())
      by_id[structure["id"].get<std::string>()] = structure;
  for (const Json& structure : structures) {
    const std::string type = structure.value("type", std::string());
    const Json features = structure.value("features", Json::object());
    if (!type.ends_with("Annotation") || !features.contains("roi")) continue;
    const Json rect = referred(features["roi"], by_id);
    const auto number = [&](const char* name) {
      return rect.contains(name) && rect[name].is_number() ? rect[name].get<double>() : 0;
    };
    ImageNote note{type.substr(type.rfind('.') + 1),
                   text_of(features),
                   features.value("source", std::string()),
                   -1,
                   {number("x"), number("y"), number("width"), number("height")}};
    if (!note.region.empty()) notes.push_back(std::move(note));
  }
  return notes;
}

std::vector<ImageNote> image_notes(const memory::Store& store, memory::Id scene) {
  std::vector<ImageNote> all;
  std::map<memory::Id, int64_t> numbers;
  for (const memory::ObservationRow& row : store.observations(scene)) numbers[row.id] = row.number;
  for (const memory::FeatureStructureRow& row : store.feature_structures(scene))
    for (ImageNote& note : notes_in(row.json)) {
      if (row.observation) note.observation = numbers[*row.observation];
      all.push_back(std::move(note));
    }
  return all;
}

}  // namespace loci::gui
