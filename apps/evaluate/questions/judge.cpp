#include "apps/evaluate/questions/judge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"

namespace loci::apps::questions {
namespace {

using memory::NaturalLanguageAnswer;
using memory::Reply;

bool contains(const std::vector<std::string>& list, const std::string& value) {
  return std::ranges::count(list, value) > 0;
}

/// drawer_1_bottom is drawer_1.
bool is_place(const std::string& named, const std::string& expected) {
  return named == expected || named.starts_with(expected + "_");
}

bool are_places(const std::vector<std::string>& named, const std::vector<std::string>& expected) {
  const auto each = [](const std::vector<std::string>& a, const std::vector<std::string>& b, auto same) {
    return std::ranges::all_of(a, [&](const std::string& one) {
      return std::ranges::any_of(b, [&](const auto& other) { return same(one, other); });
    });
  };
  return each(named, expected, [](const auto& a, const auto& b) { return is_place(a, b); }) &&
         each(expected, named, [](const auto& a, const auto& b) { return is_place(b, a); });
}

/// Minutes of "08:30".
double minutes_of(const std::string& clock) {
  return 60 * std::stod(clock.substr(0, 2)) + std::stod(clock.substr(3));
}

double minutes_of(TimeNs time, const memory::Store& store) {
  constexpr double kDay_min = 24 * 60;
  const double minutes = static_cast<double>(store.time_zone().local(time)) / (60.0 * kSecond);
  return minutes - kDay_min * std::floor(minutes / kDay_min);
}

/// Objects by the first that looks like them.
std::multiset<std::string> by_looks(const std::set<std::string>& objects, const Twins& twins) {
  std::multiset<std::string> names;
  for (const std::string& object : objects) names.insert(twins.contains(object) ? twins.at(object) : object);
  return names;
}

std::string words_of(memory::Verdict verdict) {
  return verdict == memory::Verdict::not_observed ? "not observed" : to_text(verdict);
}

/// Of one thing that is expected: unset = the reply says nothing of that type.
std::optional<bool> fits(const AskedQuestion& asked, const Reply& reply, const memory::Store& store,
                         const TrueNames& names, const Twins& twins) {
  if (!asked.verdict.empty())
    return reply.verdict ? std::optional(contains(asked.verdict, words_of(*reply.verdict))) : std::nullopt;
  if (asked.number) return reply.number ? std::optional(*reply.number == *asked.number) : std::nullopt;
  if (!asked.place.empty()) {
    if (reply.places.empty()) return reply.not_known ? std::optional(false) : std::nullopt;
    return reply.places.size() == 1 && std::ranges::any_of(asked.place, [&](const std::string& one) {
             return is_place(reply.places[0], one);
           });
  }
  if (asked.objects) {
    std::set<std::string> said;
    for (const memory::Id id : reply.objects)
      said.insert(names.contains(id) ? names.at(id) : memory::object_name(id));
    return by_looks(said, twins) == by_looks({asked.objects->begin(), asked.objects->end()}, twins);
  }
  if (asked.places) return are_places(reply.places, *asked.places);
  if (asked.time)
    return reply.time ? std::optional(minutes_of(reply.time->first, store) >= minutes_of(asked.time->first) &&
                                      minutes_of(reply.time->last, store) <= minutes_of(asked.time->second))
                      : std::nullopt;
  if (asked.duration) {
    if (!reply.duration) return std::nullopt;
    const double minutes = static_cast<double>(*reply.duration) / (60.0 * kSecond);
    return minutes >= minutes_of(asked.duration->first) && minutes <= minutes_of(asked.duration->second);
  }
  if (asked.probability)
    return reply.probability ? std::optional(*reply.probability >= asked.probability->first &&
                                             *reply.probability <= asked.probability->second)
                             : std::nullopt;
  if (!asked.text.empty())
    return std::ranges::any_of(asked.text, [&](const std::string& one) {
      return lower_case(reply.text).find(one) != std::string::npos;
    });
  if (!asked.reason.empty())
    return reply.text.starts_with("Because") &&
           lower_case(reply.text).find(asked.reason) != std::string::npos;
  return std::nullopt;
}

Outcome outcome_of(const AskedQuestion& asked, const NaturalLanguageAnswer& answer,
                   const memory::Store& store, const TrueNames& names, const Twins& twins) {
  if (!answer.query)
    return contains(asked.answer, "not understood") ? Outcome::right : Outcome::not_understood;
  if (!answer.reply) {
    if (contains(asked.answer, "unknown")) return Outcome::right;
    return answer.why_not->reason == "not_possible" ? Outcome::not_understood : Outcome::misleading;
  }
  const Reply& reply = *answer.reply;
  const bool gone = reply.not_known && reply.text.find("gone") != std::string::npos;
  if ((contains(asked.answer, "gone") && gone) || (contains(asked.answer, "not known") && reply.not_known) ||
      (reply.verdict && contains(asked.answer, words_of(*reply.verdict))))
    return Outcome::right;
  const auto right = fits(asked, reply, store, names, twins);
  if (right && *right) return Outcome::right;
  if (reply.not_known || reply.verdict == memory::Verdict::not_observed) return Outcome::undecided;
  return right ? Outcome::wrong : Outcome::misleading;
}

}  // namespace

std::string to_text(Outcome outcome) {
  switch (outcome) {
    case Outcome::right:
      return "right";
    case Outcome::wrong:
      return "wrong";
    case Outcome::misleading:
      return "misleading";
    case Outcome::undecided:
      return "undecided";
    case Outcome::not_understood:
      return "not understood";
  }
  return {};
}

JudgedAnswer judge(const AskedQuestion& asked, const memory::Store& store, const TrueNames& names,
                   const Twins& twins) {
  std::vector<std::string> sentences = asked.after;
  sentences.push_back(asked.sentence);
  const Stopwatch watch;
  const NaturalLanguageAnswer answer = ask(store, memory::NaturalLanguageQuestion{sentences}).back();
  const double taken_ms = 1000 * watch.cpu_seconds();
  JudgedAnswer judged{.asked = asked, .outcome = outcome_of(asked, answer, store, names, twins)};
  judged.text = to_text(answer, memory::TimeWriter(store));
  if (answer.query) judged.command = answer.query->text();
  judged.ms = taken_ms / static_cast<double>(sentences.size());
  return judged;
}

size_t QuestionFigures::max_length() const {
  size_t longest = 0;
  for (const JudgedAnswer& one : answers) longest = std::max(longest, one.text.find('\n'));
  return longest;
}

size_t QuestionFigures::max_lines() const {
  size_t most = 0;
  for (const JudgedAnswer& one : answers)
    if (!one.command.empty())
      most = std::max(most, static_cast<size_t>(std::ranges::count(one.text, '\n')) - 1);
  return most;
}

std::string text_of(const QuestionFigures& figures, bool all) {
  std::string text;
  std::map<Outcome, size_t> counts;
  std::vector<double> times;
  for (const JudgedAnswer& one : figures.answers) {
    ++counts[one.outcome];
    times.push_back(one.ms);
    if (!all && one.outcome == Outcome::right) continue;
    text +=
        fmt::format("{}: {} [{}, line {}]\n  {}", to_text(one.outcome), one.asked.sentence, one.asked.memory,
                    one.asked.line, one.command.empty() ? "" : "= " + one.command + "\n  ");
    text += one.text.substr(0, one.text.find('\n')) + "\n";
  }
  std::ranges::sort(times);
  const size_t count = figures.answers.size();
  text += fmt::format(
      "{} questions: {} right ({:.0f} %), {} wrong, {} misleading, {} undecided, {} not understood\n", count,
      counts[Outcome::right],
      100.0 * static_cast<double>(counts[Outcome::right]) / static_cast<double>(count),
      counts[Outcome::wrong], counts[Outcome::misleading], counts[Outcome::undecided],
      counts[Outcome::not_understood]);
  text += fmt::format("CPU time per question: median {:.1f} ms, longest {:.1f} ms\n", times[count / 2],
                      times.back());
  text += fmt::format("longest answer: {} characters, {} lines of evidence\n", figures.max_length(),
                      figures.max_lines());
  return text;
}

Json json_of(const QuestionFigures& figures) {
  Json answers = Json::array();
  for (const JudgedAnswer& one : figures.answers)
    answers.push_back({{"memory", one.asked.memory},
                       {"question", one.asked.sentence},
                       {"outcome", to_text(one.outcome)},
                       {"command", one.command},
                       {"answer", one.text},
                       {"ms", one.ms}});
  return {{"answers", answers}, {"max_length", figures.max_length()}, {"max_lines", figures.max_lines()}};
}

}  // namespace loci::apps::questions
