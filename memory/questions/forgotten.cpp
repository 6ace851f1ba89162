#include "memory/questions/forgotten.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "memory/questions/replies/reply.h"

namespace loci::memory {
namespace {

constexpr TimeNs kAlways = std::numeric_limits<TimeNs>::min();

/// The time that a query asks about.
struct AskedTime {
  TimeSpan span = {};
  bool is_moment = false;  ///< at which something held
  bool is_said = true;     ///< by the query; else it is that of the last scene
  bool is_state = false;   ///< of what held at the moment; else whether it was seen then
};

bool asks_for_moment(const Question& question, const Query& query) {
  const bool of_past =
      query.asks == Asks::last_time || query.asks == Asks::first_time || query.asks == Asks::ago;
  return question.of_moment && (question.time == SentenceTime::period || !of_past);
}

std::optional<AskedTime> asked_time(const Store& store, const Query& query, const AsOf& as_of) {
  const Question* const question = find_question(query.question);
  if (question == nullptr) return std::nullopt;
  const Arguments given(store, query, as_of);
  const std::optional<TimeNs> from = given.from(), to = given.to(), at = given.as_of().at;
  const TimeNs last = TimeReader(store).now();
  if (!from && !to && !at) return AskedTime{.span = {last, last}, .is_said = false};
  if (from || to || !asks_for_moment(*question, query))
    return AskedTime{.span = {from.value_or(kAlways), to.value_or(at.value_or(last))}};
  return AskedTime{.span = {*at, *at}, .is_moment = true, .is_state = question->time != SentenceTime::period};
}

/// Whether all scenes of a period were forgotten.
bool leaves_no_scene(const Store& store, const std::vector<ForgottenRow>& forgotten, const TimeSpan& span,
                     const AsOf& as_of) {
  return std::ranges::all_of(store.scenes({.known_at = as_of.known_at}, span.first, span.last),
                             [&](const SceneRow& scene) { return was_forgotten(forgotten, scene.time); });
}

/// Before the forgotten period, or several of them, that a time lies in.
TimeNs before_forgotten(const std::vector<ForgottenRow>& forgotten, TimeNs time) {
  while (was_forgotten(forgotten, time))
    for (const ForgottenRow& row : forgotten)
      if (was_forgotten({row}, time)) time = *row.valid_from - 1;
  return time;
}

/// The last scene before the forgotten period that a time lies in.
std::optional<TimeNs> last_scene_before(const Store& store, const std::vector<ForgottenRow>& forgotten,
                                        TimeNs time) {
  std::optional<SceneRow> scene = store.latest_scene({.at = before_forgotten(forgotten, time)});
  while (scene && was_forgotten(forgotten, scene->time))
    scene = store.latest_scene({.at = before_forgotten(forgotten, scene->time)});
  return scene ? std::optional(scene->time) : std::nullopt;
}

}  // namespace

std::optional<TimeSpan> forgotten_part(const Store& store, const TimeSpan& period) {
  std::optional<TimeSpan> part;
  for (const ForgottenRow& row : store.forgotten()) {
    if (!row.valid_from || *row.valid_from > period.last || *row.valid_to < period.first) continue;
    if (!part) part = {*row.valid_from, *row.valid_to};
    part = {std::min(part->first, *row.valid_from), std::max(part->last, *row.valid_to)};
  }
  const std::vector<TimeNs> first = part ? store.scene_times_at_ends(1) : std::vector<TimeNs>();
  if (!first.empty() && first.front() <= part->last) part->first = std::max(part->first, first.front());
  return part;
}

std::optional<ForgottenTime> forgotten_time(const Store& store, const Query& query, const AsOf& as_of) {
  const std::vector<ForgottenRow> forgotten = store.forgotten();
  if (forgotten.empty()) return std::nullopt;
  const std::optional<AskedTime> asked = asked_time(store, query, as_of);
  if (!asked) return std::nullopt;
  const std::optional<TimeSpan> part = forgotten_part(store, asked->span);
  if (!part) return std::nullopt;
  ForgottenTime time{.period = *part};
  time.all = asked->is_said && (asked->is_moment || leaves_no_scene(store, forgotten, asked->span, as_of));
  if (asked->is_state) time.before = last_scene_before(store, forgotten, asked->span.first);
  return time;
}

std::string forgotten_text(const TimeSpan& period, const TimeWriter& times) {
  return fmt::format("what was seen {} was forgotten on request", times.span_text(period.first, period.last));
}

Reply forgotten_reply(const ForgottenTime& forgotten, const Reply& known, const TimeWriter& times) {
  Reply reply{.text = fmt::format("Not observed: {}.", forgotten_text(forgotten.period, times)),
              .evidence = known.evidence,
              .verdict = Verdict::not_observed,
              .not_known = true};
  if (forgotten.before)
    reply.evidence.insert(
        reply.evidence.begin(),
        fmt::format("before, at {}: {}", times.text(*forgotten.before), uncapitalised(known.text)));
  return reply;
}

}  // namespace loci::memory
