#include "memory/report/annotator_times.h"

#include <algorithm>

#include "mapping/base/json.h"

namespace loci::memory {

std::vector<AnnotatorTimes> annotator_times(const std::filesystem::path& memory) {
  std::filesystem::path path = memory;
  path.replace_extension(".statistics.json");
  std::vector<AnnotatorTimes> all;
  if (!std::filesystem::exists(path)) return all;
  const Json annotators = read_json(path).value("annotators", Json::object());
  for (const auto& [name, row] : annotators.items()) {
    const auto count = [&row = row](const char* key) { return row.value(key, int64_t{0}); };
    all.push_back({name, count("scenes"), row.value("seconds", 0.0), count("failures"), count("timeouts"),
                   count("retries")});
  }
  std::stable_sort(all.begin(), all.end(), [](const AnnotatorTimes& a, const AnnotatorTimes& b) {
    return a.ms_per_scene() > b.ms_per_scene();
  });
  return all;
}

}  // namespace loci::memory
