#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/html.h"
#include "memory/questions/about.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

constexpr size_t kImages = 4;
constexpr size_t kStays = 20;

std::string when_text(const TimeWriter& times, const Stay& stay) {
  const std::string first = times.text(stay.scenes.front().time), last = times.text(stay.scenes.back().time);
  return first == last ? first : first + " – " + last;
}

std::string state_text(const ObjectState& now) {
  const std::string where = now.place ? (now.place->container ? " in " : " on ") + now.place->name : "";
  if (now.status == "gone") return where.empty() ? "gone" : "gone, was" + where;
  std::string status = now.status;
  std::replace(status.begin(), status.end(), '_', ' ');
  return fmt::format("{}{}, {:.0f} % sure", status, where.empty() ? "" : "," + where, 100 * now.probability);
}

/// From stays at different times, the last first.
std::string images_of(const ReportData& data, const ObjectHistory& history) {
  std::string images;
  size_t count = 0;
  for (auto stay = history.stays.rbegin(); stay != history.stays.rend() && count < kImages; ++stay) {
    const Id scene = stay->scenes.back().scene;
    const TimeNs time = stay->scenes.back().time;
    for (const ObjectObservation& sighting :
         data.store.observations_of(history.now.object.id, {}, time, time)) {
      if (sighting.observation.scene != scene || !sighting.observation.crop) continue;
      const BlobRow blob = data.store.blob(*sighting.observation.crop);
      const auto* bytes = reinterpret_cast<const unsigned char*>(blob.bytes.data());
      images += html_image({bytes, blob.bytes.size()}, blob.media,
                           history.now.object.name + " at " + data.times.text(time));
      ++count;
      break;
    }
  }
  return images.empty() ? "<p class=\"faint\">no image is kept</p>" : images;
}

std::string stays_of(const ReportData& data, const ObjectHistory& history) {
  std::vector<std::vector<std::string>> rows;
  const size_t first = history.stays.size() > kStays ? history.stays.size() - kStays : 0;
  for (size_t i = first; i < history.stays.size(); ++i) {
    const Stay& stay = history.stays[i];
    rows.push_back({when_text(data.times, stay), stay.place ? stay.place->name : "",
                    fmt::format("{}", stay.scenes.size()), fmt::format("{:.0f} %", 100 * stay.probability)});
  }
  const std::string before =
      first > 0 ? fmt::format("<p class=\"faint\">{} earlier stays are left out.</p>", first) : "";
  return before + html_table({"when", "where", "seen"}, rows);
}

std::string said_of(const ReportData& data, const ObjectHistory& history) {
  std::string body;
  const AboutAnswer about =
      ask(data.store, AboutQuestion{.subject = history.now.object.name, .max_sightings = 50});
  for (const AboutObject& object : about.objects) {
    std::vector<std::vector<std::string>> rows;
    for (const Fact& fact : object.facts) rows.push_back({fact.key, fact.value, fact.source, ""});
    for (const AnnotationSupport& evidence : object.evidence)
      rows.push_back({evidence.type, evidence.value, fmt::format("{} sightings", evidence.sightings),
                      fmt::format("{:.0f} %", 100 * evidence.agreement)});
    if (!rows.empty()) body += html_table({"what", "value", "said by", "agreement"}, rows);
  }
  return body.empty() ? body : "<details><summary>what is said of it</summary>" + body + "</details>";
}

std::string card(const ReportData& data, const ObjectHistory& history) {
  const ObjectState& now = history.now;
  return fmt::format(
      "<article class=\"card\" id=\"{}\"><h3><span style=\"color:{}\">●</span> "
      "{}</h3><p>{}</p>{}{}{}</article>\n",
      html_escape(now.object.name), object_css(now.object.id), html_escape(object_text(now.object)),
      html_escape(state_text(now)), images_of(data, history), stays_of(data, history),
      said_of(data, history));
}

}  // namespace

std::string objects_section(const ReportData& data) {
  std::string cards;
  for (const ObjectHistory& history : data.histories) cards += card(data, history);
  if (cards.empty()) cards = "<p class=\"faint\">No object is known yet.</p>";
  return html_section("objects", "Objects",
                      data.objects_left_out() + "<div class=\"cards\">\n" + cards + "</div>\n");
}

}  // namespace loci::memory
