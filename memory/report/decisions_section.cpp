#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/html.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

constexpr size_t kMinSure = 30;

struct Decision {
  const SceneRow* scene = nullptr;
  TakenFor taken = {};
};

}  // namespace

std::string decisions_section(const ReportData& data) {
  std::vector<Decision> all;
  for (const SceneRow& scene : data.scenes)
    for (auto& [observation, taken] : taken_for(data.store, scene.id))
      all.push_back({&scene, std::move(taken)});
  const size_t count = all.size();
  const auto sure = static_cast<size_t>(std::count_if(
      all.begin(), all.end(), [](const Decision& decision) { return decision.taken.probability >= 0.95; }));
  std::stable_sort(all.begin(), all.end(), [](const Decision& a, const Decision& b) {
    return a.taken.probability < b.taken.probability;
  });
  if (all.size() > kMinSure) all.resize(kMinSure);
  std::vector<std::vector<std::string>> rows;
  for (const Decision& decision : all)
    rows.push_back({data.times.text(decision.scene->time), fmt::format("scene {}", decision.scene->id),
                    explanation_name(decision.taken.chosen.object),
                    to_text(decision.taken.chosen.explanation),
                    fmt::format("{:.0f} %", 100 * decision.taken.probability), decision.taken.instead});
  const std::string text = fmt::format(
      "<p>{} of {} observations were taken for something with 95 % or more. The least sure{}:</p>\n", sure,
      count, count > all.size() ? fmt::format(" {} of them", all.size()) : "");
  return html_section(
      "decisions", "Who is who",
      data.scenes_left_out() + text +
          html_table({"time", "scene", "taken for", "because", "sure", "or else it may be"}, rows));
}

}  // namespace loci::memory
