#include "memory/questions/names/structure_features.h"

#include "mapping/base/text/json.h"

namespace loci::memory {

std::vector<Json> features_of(const Store& store, const AnnotationRow& annotation, const std::string& type) {
  std::vector<Json> found;
  if (!annotation.feature_structure) return found;
  const Json json =
      parse_json(store.feature_structure(*annotation.feature_structure).json, "feature_structure");
  const auto structures = json.find("structures");
  if (structures == json.end() || !structures->is_array()) return found;
  for (const Json& structure : *structures) {
    if (!structure.is_object() || text_feature(structure, "type") != type) continue;
    const auto features = structure.find("features");
    if (features != structure.end() && features->is_object()) found.push_back(*features);
  }
  return found;
}

std::string text_feature(const Json& features, const char* name) {
  const auto feature = features.find(name);
  return feature != features.end() && feature->is_string() ? feature->get<std::string>() : "";
}

}  // namespace loci::memory
