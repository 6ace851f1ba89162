#include "memory/catalogue/said_class.h"

#include <algorithm>

namespace loci::memory {
namespace {

constexpr const char* kClassType = "loci.annotation.ClassificationAnnotation";

std::string class_by_annotators(const Store& store, Id object) {
  std::map<std::string, double> said;
  for (const ObjectObservation& sighting : store.observations_of(object))
    for (const AnnotationRow& row : store.annotations(sighting.observation.scene))
      if (row.observation == sighting.observation.id && row.type == kClassType)
        said[row.value] += row.confidence.value_or(0.5);
  const auto most = std::ranges::max_element(said, {}, &std::pair<const std::string, double>::second);
  return most == said.end() ? std::string() : most->first;
}

}  // namespace

SaidClass class_of(const Store& store, Id object) {
  for (const FactRow& fact : store.facts())
    if (fact.object == object && fact.key == "class" && fact.value)
      return {*fact.value, fact.clock.source == "catalogue" ? "catalogue" : "fact"};
  const std::string name = class_by_annotators(store, object);
  return {name, name.empty() ? "" : "annotators"};
}

}  // namespace loci::memory
