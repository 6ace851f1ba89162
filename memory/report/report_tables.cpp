// Sections of a report that are tables and cards.

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/html.h"
#include "memory/questions/events.h"
#include "memory/questions/objects.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/report/memory_statistics.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

constexpr size_t kImages = 4;
constexpr size_t kStays = 20;

std::string when_text(const TimeWriter& times, const Stay& stay) {
  const std::string first = times.text(stay.scenes.front().time), last = times.text(stay.scenes.back().time);
  return first == last ? first : first + " – " + last;
}

std::string state_text(const ObjectBelief& now) {
  const std::string where = now.place ? (now.place->container ? " in " : " on ") + now.place->name : "";
  if (now.status == ObjectStatus::gone) return where.empty() ? "gone" : "gone, was" + where;
  return fmt::format("{}{}; still there: {}", status_text(now.status), where.empty() ? "" : "," + where,
                     format::percent(now.probability));
}

/// Crops from stays at different times, the last first.
std::string images_of(const ReportData& data, const ObjectHistory& history) {
  std::string images;
  size_t count = 0;
  for (auto stay = history.stays.rbegin(); stay != history.stays.rend() && count < kImages; ++stay) {
    const Id scene = stay->scenes.back().scene;
    const TimeNs time = stay->scenes.back().time;
    for (const ObjectObservation& observed :
         data.store.observations_of(history.now.object.id, {}, time, time)) {
      if (observed.observation.scene != scene || !observed.observation.crop) continue;
      const BlobRow blob = data.store.blob(*observed.observation.crop);
      const auto* bytes = reinterpret_cast<const unsigned char*>(blob.bytes.data());
      images += html_image({bytes, blob.bytes.size()}, blob.media,
                           history.now.object.name + " at " + data.times.text(time));
      ++count;
      break;
    }
  }
  return images.empty() ? "<p class=\"faint\">no image is stored</p>" : images;
}

std::string stays_of(const ReportData& data, const ObjectHistory& history) {
  std::vector<std::vector<std::string>> rows;
  const size_t first = history.stays.size() > kStays ? history.stays.size() - kStays : 0;
  for (size_t i = first; i < history.stays.size(); ++i) {
    const Stay& stay = history.stays[i];
    rows.push_back({when_text(data.times, stay), stay.place ? stay.place->name : "",
                    fmt::format("{}", stay.scenes.size()), format::percent(stay.probability)});
  }
  const std::string before =
      first > 0 ? fmt::format("<p class=\"faint\">{} earlier stays are left out.</p>", first) : "";
  return before + html_table({"when", "where", "scenes", "identity, at least"}, rows);
}

std::string statements_about(const ReportData& data, const ObjectHistory& history) {
  std::string body;
  const AboutAnswer about =
      ask(data.store, AboutQuestion{.subject = history.now.object.name, .max_sightings = 50});
  for (const AboutObject& object : about.objects) {
    std::vector<std::vector<std::string>> rows;
    for (const Fact& fact : object.facts) rows.push_back({fact.key, fact.value, fact.source, ""});
    for (const AnnotationSupport& evidence : object.evidence)
      rows.push_back({evidence.type, evidence.value, fmt::format("{} observations", evidence.observations),
                      fmt::format("{:.0f} %", 100 * evidence.agreement)});
    if (!rows.empty()) body += html_table({"what", "value", "source", "agreement"}, rows);
  }
  return body.empty() ? body : "<details><summary>facts and annotations</summary>" + body + "</details>";
}

std::string card(const ReportData& data, const ObjectHistory& history) {
  const ObjectBelief& now = history.now;
  return fmt::format(
      "<article class=\"card\" id=\"{}\"><h3><span style=\"display:inline-block;width:.8em;"
      "height:.8em;border-radius:50%;border:1px solid;background:{}\"></span> "
      "{}</h3><p>{}</p>{}{}{}</article>\n",
      html_escape(now.object.name), data.css_of(now.object.id), html_escape(to_text(now.object)),
      html_escape(state_text(now)), images_of(data, history), stays_of(data, history),
      statements_about(data, history));
}

std::string bars(const Chart& chart) {
  double most = 0;
  for (const auto& [name, value] : chart.bars) most = std::max(most, value);
  std::string rows;
  for (const auto& [name, value] : chart.bars)
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{}</td><td><div class=\"bar\" "
        "style=\"width:{:.0f}%\"></div></td></tr>\n",
        html_escape(name), value, most > 0 ? 100 * value / most : 0);
  return fmt::format(
      "<figure><figcaption>{} <span class=\"faint\">({})</span></figcaption><table "
      "class=\"bars\">{}</table></figure>\n",
      html_escape(chart.title), html_escape(chart.unit), rows);
}

constexpr size_t kMaxShown = 30;

struct Decision {
  const SceneRow* scene = nullptr;
  ChosenAssociation association = {};
};

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

/// The log of the annotators, with their times.
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
  return rows.empty() ? "" : html_table({"annotator", "ms", "messages"}, rows);
}

std::string scene_log(const ReportData& data, const SceneRow& scene, const SceneSummary& summary) {
  std::map<Id, ChosenAssociation> chosen = chosen_associations(data.store, scene.id);
  std::map<Id, std::string> annotations;
  for (const AnnotationRow& row : data.store.annotations(scene.id))
    if (row.observation && !row.value.empty()) {
      std::string& text = annotations[*row.observation];
      const std::string type = row.type.substr(row.type.rfind('.') + 1);
      text += fmt::format("{}{} {}", text.empty() ? "" : "; ", type, row.value);
    }
  std::vector<std::vector<std::string>> rows;
  for (const ObservationRow& observation : data.store.observations(scene.id)) {
    const auto& [row, probability, alternatives] = chosen[observation.id];
    rows.push_back({fmt::format("{}", observation.number), row.object ? object_name(*row.object) : "none",
                    fmt::format("{:.0f} %", 100 * probability), to_text(row.explanation),
                    observation_text(observation), observation.location.value_or(""),
                    annotations[observation.id]});
  }
  std::string views;
  for (const auto& [place, part] : summary.seen_places)
    views += fmt::format("{}{:.0f} % of {}", views.empty() ? "" : ", ", 100 * part, place);
  const std::string head = fmt::format(
      "scene {} at {}: {} observation{}{}{}", scene.id, data.times.text(scene.time), rows.size(),
      rows.size() == 1 ? "" : "s", summary.scene.frame ? fmt::format(", frame {}", *summary.scene.frame) : "",
      summary.has_pose ? "" : ", no pose");
  return fmt::format(
      "<details><summary>{}</summary><p>{}</p>{}{}</details>\n", html_escape(head),
      html_escape(views.empty() ? "saw no place" : "saw " + views),
      html_table({"", "object", "probability", "explanation", "appearance", "where", "annotations"}, rows),
      annotators_table(data.store, scene.id));
}

}  // namespace

std::string objects_section(const ReportData& data) {
  std::string cards;
  for (const ObjectHistory& history : data.histories) cards += card(data, history);
  if (cards.empty()) cards = "<p class=\"faint\">No object is known yet.</p>";
  return html_section("objects", "Objects",
                      data.objects_left_out() + "<div class=\"cards\">\n" + cards + "</div>\n");
}

std::string statistics_section(const ReportData& data, Progress& progress) {
  std::string body;
  for (const Chart& chart : memory_statistics(data.store, progress))
    if (!chart.bars.empty()) body += bars(chart);
  return html_section("statistics", "Statistics", "<div class=\"cards\">\n" + body + "</div>\n");
}

std::string decisions_section(const ReportData& data) {
  std::vector<Decision> all;
  for (const SceneRow& scene : data.scenes)
    for (auto& [observation, association] : chosen_associations(data.store, scene.id))
      all.push_back({&scene, std::move(association)});
  const size_t count = all.size();
  const auto sure = static_cast<size_t>(std::count_if(all.begin(), all.end(), [](const Decision& decision) {
    return decision.association.probability >= 0.95;
  }));
  std::stable_sort(all.begin(), all.end(), [](const Decision& a, const Decision& b) {
    return a.association.probability < b.association.probability;
  });
  if (all.size() > kMaxShown) all.resize(kMaxShown);
  std::vector<std::vector<std::string>> rows;
  for (const Decision& decision : all)
    rows.push_back(
        {data.times.text(decision.scene->time), fmt::format("scene {}", decision.scene->id),
         partner_name(decision.association.chosen.object), to_text(decision.association.chosen.explanation),
         fmt::format("{:.0f} %", 100 * decision.association.probability), decision.association.alternatives});
  const std::string text = fmt::format(
      "<p>{} of {} observations are associated with a probability of 95 % or more. The least "
      "probable{}:</p>\n",
      sure, count, count > all.size() ? fmt::format(" {} of them", all.size()) : "");
  return html_section(
      "decisions", "Object identity",
      data.scenes_left_out() + text +
          html_table({"time", "scene", "associated with", "explanation", "probability", "alternatives"},
                     rows));
}

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
