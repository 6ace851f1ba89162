#include "memory/store/object_evidence.h"

#include <algorithm>
#include <map>
#include <set>

namespace loci::memory {

std::vector<AnnotationSupport> annotation_support(const Store& store,
                                                  const std::vector<ObjectObservation>& sightings) {
  std::map<std::pair<std::string, std::string>, size_t> said;
  std::map<std::string, size_t> of_type;
  for (const ObjectObservation& sighting : sightings) {
    std::set<std::pair<std::string, std::string>> now;
    std::set<std::string> types;
    for (const AnnotationRow& row : store.annotations(sighting.observation.scene))
      // Where it is says nothing about what it is.
      if (row.observation == sighting.observation.id && !row.value.empty() &&
          row.type.find("Location") == std::string::npos && row.type.find("Geometry") == std::string::npos) {
        now.insert({row.type, row.value});
        types.insert(row.type);
      }
    for (const auto& one : now) ++said[one];
    for (const auto& type : types) ++of_type[type];
  }
  std::vector<AnnotationSupport> evidence;
  for (const auto& [what, count] : said)
    evidence.push_back({what.first, what.second, count,
                        static_cast<double>(count) / static_cast<double>(of_type[what.first])});
  std::ranges::stable_sort(evidence, [](const AnnotationSupport& a, const AnnotationSupport& b) {
    return a.type != b.type ? a.type < b.type : a.sightings > b.sightings;
  });
  return evidence;
}

}  // namespace loci::memory
