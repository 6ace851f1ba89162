#include "memory/report/memory_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "mapping/base/html.h"
#include "memory/questions/words.h"

namespace loci {
namespace {

/// A question as it is typed, and its answer in words.
struct QuestionAndAnswer {
  std::string command;
  std::string answer;
};

template <class Question>
std::string answer_text(const Store& store, const Question& question) {
  return to_text(ask(store, question), TimeWriter(store));
}

std::string picture_of(const Store& store, Id object) {
  const auto sightings = store.sightings(object);
  for (auto sighting = sightings.rbegin(); sighting != sightings.rend(); ++sighting) {
    if (!sighting->observation.crop) continue;
    const BlobRow blob = store.blob(*sighting->observation.crop);
    const auto* bytes = reinterpret_cast<const unsigned char*>(blob.bytes.data());
    return html_image({bytes, blob.bytes.size()}, blob.media, object_name(object));
  }
  return "<p>no picture</p>";
}

std::string object_card(const Store& store, const ObjectHistory& history, const TimeWriter& times) {
  std::vector<std::vector<std::string>> rows;
  for (const Stay& stay : history.stays)
    rows.push_back({times.span_text(stay.scenes.front().time, stay.scenes.back().time),
                    stay.place ? stay.place->name : "", fmt::format("{}", stay.scenes.size()),
                    fmt::format("{:.0f} %", 100 * stay.probability)});
  return "<h3>" + html_escape(object_text(history.now.object)) + "</h3>" +
         picture_of(store, history.now.object.id) + html_table({"when", "where", "sightings", "sure"}, rows);
}

std::string objects_section(const Store& store) {
  const TimeWriter times(store);
  std::string body = "<pre>" + html_escape(answer_text(store, ObjectsQuestion{})) + "</pre>";
  for (const ObjectState& state : ask(store, ObjectsQuestion{}).objects) {
    const HistoryAnswer answer = ask(store, HistoryQuestion{.subject = state.object.name});
    for (const ObjectHistory& history : answer.objects) body += object_card(store, history, times);
  }
  return html_section("objects", "Objects", body);
}

std::string timeline_section(const Store& store) {
  const TimeWriter times(store);
  std::vector<std::vector<std::string>> rows;
  for (const TimelineEntry& entry : ask(store, TimelineQuestion{}).entries) {
    std::string happened;
    for (const Change& change : entry.changes)
      happened += (happened.empty() ? "" : "; ") + change_text(change);
    rows.push_back({times.text(entry.scene.scene.time), fmt::format("{}", entry.seen.size()), happened});
  }
  return html_section("timeline", "What happened",
                      html_table({"time", "objects seen", "what changed"}, rows));
}

/// Questions that any day answers: about each place that holds something, about the object that moved most,
/// and whether it was where it began during the whole time.
std::vector<QuestionAndAnswer> questions_of_the_day(const Store& store) {
  std::vector<QuestionAndAnswer> result;
  for (const PlaceRow& place : store.places()) {
    const ContentsQuestion question{.place = place.name};
    const ContentsAnswer answer = ask(store, question);
    const bool known = std::any_of(
        answer.places.begin(), answer.places.end(),
        [](const PlaceContents& contents) { return !contents.there.empty() || !contents.gone.empty(); });
    if (known)
      result.push_back({fmt::format("loci-memory {} {}", place.container ? "in" : "on", place.name),
                        to_text(answer, TimeWriter(store))});
  }
  std::optional<ObjectHistory> traveller;
  for (const ObjectState& state : ask(store, ObjectsQuestion{}).objects)
    for (const ObjectHistory& history : ask(store, HistoryQuestion{.subject = state.object.name}).objects)
      if (!traveller || history.stays.size() > traveller->stays.size()) traveller = history;
  if (!traveller) return result;
  const std::string& name = traveller->now.object.name;
  result.push_back({"loci-memory where " + name, answer_text(store, WhereQuestion{.subject = name})});
  result.push_back({"loci-memory history " + name, answer_text(store, HistoryQuestion{.subject = name})});
  const auto scenes = ask(store, ScenesQuestion{}).scenes;
  if (!traveller->stays.empty() && traveller->stays.front().place && !scenes.empty()) {
    const std::string& place = traveller->stays.front().place->name;
    const TimeNs from = traveller->stays.front().scenes.back().time, to = scenes.back().scene.time;
    result.push_back(
        {fmt::format("loci-memory was {} on {} --between {} {}", name, place, format_time(from),
                     format_time(to)),
         answer_text(store, WasQuestion{.subject = name, .place = place, .from = from, .to = to})});
  }
  return result;
}

std::string questions_section(const Store& store) {
  std::string body;
  for (const QuestionAndAnswer& question : questions_of_the_day(store))
    body += "<pre><strong>$ " + html_escape(question.command) + "</strong>\n" + html_escape(question.answer) +
            "</pre>";
  return html_section("questions", "Questions and answers", body);
}

}  // namespace

std::string memory_report(const Store& store, const std::optional<std::string>& page) {
  const std::vector<std::pair<std::string, std::string>> sections = {{"questions", questions_section(store)},
                                                                     {"objects", objects_section(store)},
                                                                     {"timeline", timeline_section(store)}};
  std::string result = page ? *page : html_page("Memory " + store.path().filename().string(), std::string());
  for (const auto& [id, section] : sections) result = html_with_section(result, id, section);
  return result;
}

}  // namespace loci
