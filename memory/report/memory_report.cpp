#include "memory/report/memory_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "mapping/base/text/html.h"
#include "memory/questions/contents.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/presence.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

/// A question as it is typed, and its answer in words.
struct QuestionAndAnswer {
  std::string command;
  std::string answer;
};

template <class Question>
std::string answer_text(const ReportData& data, const Question& question) {
  return to_text(ask(data.store, question), data.times);
}

/// Questions that any day answers: about each place that holds something, about the object that moved most,
/// and whether it was where it began during the whole time.
std::vector<QuestionAndAnswer> questions_of_the_day(const ReportData& data) {
  const Store& store = data.store;
  std::vector<QuestionAndAnswer> result;
  for (const PlaceRow& place : named_places(store)) {
    const ContentsQuestion question{.place = place.name};
    const ContentsAnswer answer = ask(store, question);
    const bool known = std::any_of(
        answer.places.begin(), answer.places.end(),
        [](const PlaceContents& contents) { return !contents.there.empty() || !contents.gone.empty(); });
    if (known)
      result.push_back({fmt::format("loci-memory {} {}", place.container ? "in" : "on", place.name),
                        to_text(answer, data.times)});
  }
  const auto traveller = std::max_element(
      data.histories.begin(), data.histories.end(),
      [](const ObjectHistory& a, const ObjectHistory& b) { return a.stays.size() < b.stays.size(); });
  if (traveller == data.histories.end()) return result;
  const std::string& name = traveller->now.object.name;
  result.push_back({"loci-memory where " + name, answer_text(data, WhereQuestion{.subject = name})});
  result.push_back({"loci-memory history " + name, answer_text(data, HistoryQuestion{.subject = name})});
  if (!traveller->stays.empty() && traveller->stays.front().place && !data.scenes.empty()) {
    const std::string& place = traveller->stays.front().place->name;
    const TimeNs from = traveller->stays.front().scenes.back().time, to = data.scenes.back().time;
    result.push_back(
        {fmt::format("loci-memory was {} on {} --between {} {}", name, place, format_time(from),
                     format_time(to)),
         answer_text(data, WasQuestion{.subject = name, .place = place, .from = from, .to = to})});
  }
  return result;
}

std::string questions_section(const ReportData& data) {
  std::string body;
  for (const QuestionAndAnswer& question : questions_of_the_day(data))
    body += "<pre><strong>$ " + html_escape(question.command) + "</strong>\n" + html_escape(question.answer) +
            "</pre>";
  return html_section("questions", "Questions and answers", body);
}

}  // namespace

std::string memory_report(const Store& store, const std::optional<std::string>& page,
                          const ReportOptions& options, Progress& progress) {
  if (page && !is_html_page(*page))
    throw Error("is no page of a report", {}, "give a page that loci-map or loci-memory wrote");
  const Store::ReadTransaction moment(store);
  PartialProgress reading(progress, 0, 0.3), counting(progress, 0.3, 1);
  const ReportData data(store, options, reading);
  const std::vector<std::pair<std::string, std::string>> sections = {
      {"questions", questions_section(data)},
      {"plan", plan_section(data)},
      {"timeline", timeline_section(data)},
      {"objects", objects_section(data)},
      {"statistics", statistics_section(data, counting)},
      {"decisions", decisions_section(data)},
      {"log", log_section(data)}};
  std::string result = page ? *page : html_page("Memory " + store.path().filename().string(), std::string());
  for (const auto& [id, section] : sections) result = html_with_section(result, id, section);
  return result;
}

}  // namespace loci::memory
