#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/html.h"
#include "memory/report/report_data.h"

namespace loci {
namespace {

constexpr size_t kLeastSure = 30;

std::string name_of(const std::optional<Id>& object) {
  return object ? object_name(*object) : "a false cluster";
}

/// What an observation was taken for, and what else it may have been.
struct Decision {
  const SceneRow* scene = nullptr;
  AssociationRow chosen;
  std::string instead = {};
};

std::vector<Decision> decisions_of(const Store& store, const SceneRow& scene) {
  std::vector<Decision> decisions;
  const std::vector<AssociationRow> considered = store.associations(scene.id);
  for (const AssociationRow& chosen : considered) {
    if (!chosen.chosen || !chosen.observation) continue;
    Decision decision{&scene, chosen};
    for (const AssociationRow& other : considered)
      if (!other.chosen && other.observation == chosen.observation && other.probability >= 0.01)
        decision.instead += fmt::format("{}{} ({}) {:.0f} %", decision.instead.empty() ? "" : ", ",
                                        name_of(other.object), other.explanation, 100 * other.probability);
    decisions.push_back(std::move(decision));
  }
  return decisions;
}

}  // namespace

std::string decisions_section(const ReportData& data) {
  std::vector<Decision> all;
  for (const SceneRow& scene : data.scenes)
    for (Decision& decision : decisions_of(data.store, scene)) all.push_back(std::move(decision));
  const size_t count = all.size();
  const auto sure = static_cast<size_t>(std::count_if(
      all.begin(), all.end(), [](const Decision& decision) { return decision.chosen.probability >= 0.95; }));
  std::stable_sort(all.begin(), all.end(), [](const Decision& a, const Decision& b) {
    return a.chosen.probability < b.chosen.probability;
  });
  if (all.size() > kLeastSure) all.resize(kLeastSure);
  std::vector<std::vector<std::string>> rows;
  for (const Decision& decision : all)
    rows.push_back({data.times.text(decision.scene->time), fmt::format("scene {}", decision.scene->id),
                    name_of(decision.chosen.object), decision.chosen.explanation,
                    fmt::format("{:.0f} %", 100 * decision.chosen.probability), decision.instead});
  const std::string text = fmt::format(
      "<p>{} of {} observations were taken for something with 95 % or more. The least sure{}:</p>\n", sure,
      count, count > all.size() ? fmt::format(" {} of them", all.size()) : "");
  return html_section("decisions", "Who is who",
                      data.scenes_left_out() + text +
                          html_table({"time", "scene", "taken for", "because", "sure", "or else"}, rows));
}

}  // namespace loci
