#include <fmt/format.h>

#include "mapping/base/html.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

std::string runs_table(const ReportData& data) {
  std::vector<std::vector<std::string>> rows;
  for (const RunRow& run : data.store.runs())
    rows.push_back({fmt::format("run {}", run.id), run.program, run.version, format_time(run.started),
                    run.finished ? fmt::format("{:.1f} s", static_cast<double>(*run.finished - run.started) /
                                                               static_cast<double>(kSecond))
                                 : "did not finish"});
  return html_table({"", "program", "version", "started", "took"}, rows);
}

std::string observation_text(const ObservationRow& observation) {
  std::string text = observation.color.value_or("");
  if (observation.size)
    text +=
        fmt::format("{}{:.0f} × {:.0f} × {:.0f} cm", text.empty() ? "" : ", ", 100 * observation.size->x(),
                    100 * observation.size->y(), 100 * observation.size->z());
  return text;
}

/// What annotators did and noted, with their times.
std::string annotators_table(const Store& store, Id scene) {
  std::vector<std::vector<std::string>> rows;
  for (const LogRow& line : store.log(scene)) {
    if (rows.empty() || rows.back()[0] != line.annotator) rows.push_back({line.annotator, "", ""});
    std::vector<std::string>& row = rows.back();
    if (line.milliseconds) row[1] = fmt::format("{:.1f}", *line.milliseconds);
    if (line.text.empty()) continue;
    row[2] +=
        (row[2].empty() ? "" : "; ") + (line.level == "info" ? line.text : line.level + ": " + line.text);
  }
  return rows.empty() ? "" : html_table({"annotator", "ms", "noted"}, rows);
}

std::string scene_log(const ReportData& data, const SceneRow& scene, const SceneSummary& summary) {
  std::map<Id, TakenFor> taken = taken_for(data.store, scene.id);
  std::map<Id, std::string> said;
  for (const AnnotationRow& row : data.store.annotations(scene.id))
    if (row.observation && !row.value.empty()) {
      std::string& text = said[*row.observation];
      const std::string type = row.type.substr(row.type.rfind('.') + 1);
      text += fmt::format("{}{} {}", text.empty() ? "" : "; ", type, row.value);
    }
  std::vector<std::vector<std::string>> rows;
  for (const ObservationRow& observation : data.store.observations(scene.id)) {
    const auto& [row, probability, instead] = taken[observation.id];
    rows.push_back({fmt::format("{}", observation.number), row.object ? object_name(*row.object) : "none",
                    fmt::format("{:.0f} %", 100 * probability), to_text(row.explanation),
                    observation_text(observation), observation.sentence.value_or(""), said[observation.id]});
  }
  std::string looked;
  for (const auto& [place, part] : summary.looked_at)
    looked += fmt::format("{}{:.0f} % of {}", looked.empty() ? "" : ", ", 100 * part, place);
  const std::string head = fmt::format(
      "scene {} at {}: {} observation{}{}{}", scene.id, data.times.text(scene.time), rows.size(),
      rows.size() == 1 ? "" : "s", summary.scene.frame ? fmt::format(", frame {}", *summary.scene.frame) : "",
      summary.has_pose ? "" : ", no pose");
  return fmt::format("<details><summary>{}</summary><p>{}</p>{}{}</details>\n", html_escape(head),
                     html_escape(looked.empty() ? "looked at no place" : "looked at " + looked),
                     html_table({"", "object", "sure", "because", "looks", "where", "annotators say"}, rows),
                     annotators_table(data.store, scene.id));
}

}  // namespace

std::string log_section(const ReportData& data) {
  std::string body = runs_table(data) + data.scenes_left_out();
  if (!data.scenes.empty()) {
    std::map<Id, SceneSummary> summaries;
    for (SceneSummary& summary : ask(data.store, ScenesQuestion{.from = data.scenes.front().time}).scenes)
      summaries[summary.scene.scene] = std::move(summary);
    for (const SceneRow& scene : data.scenes) body += scene_log(data, scene, summaries[scene.id]);
  }
  return html_section("log", "Log", body);
}

}  // namespace loci::memory
