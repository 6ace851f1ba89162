#include "memory/questions/routines/routines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "mapping/base/math/math.h"
#include "mapping/base/text/text.h"
#include "memory/questions/events.h"
#include "memory/questions/location.h"
#include "memory/questions/names/related_words.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/visits.h"

namespace loci::memory {

using namespace format;

namespace {

constexpr std::array<const char*, 7> kDays = {"Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"};

/// Hours and days of the week.
class RecurringTime {
 public:
  RecurringTime(const std::string& text, const Store& store) : zone_(store.time_zone()) {
    std::istringstream words(text);
    std::string rest;
    for (std::string word; words >> word;)
      if (!take_day(word)) rest += (rest.empty() ? "" : " ") + word;
    if (rest.empty()) return;
    const TimeReader times(store);
    const size_t to = rest.find(" to ");
    const TimeSpan first = times.read(rest.substr(0, to));
    const TimeSpan last = to == std::string::npos ? first : times.read(rest.substr(to + 4));
    if (first.last - first.first >= 23 * kHour)
      days_.insert(local_weekday(first.first, zone_));  // "today"
    else
      hours_ = {local_hour(first.first, zone_), local_hour(last.last, zone_)};
  }

  bool covers(TimeNs time) const {
    if (!days_.empty() && !days_.contains(local_weekday(time, zone_))) return false;
    if (!hours_) return true;
    const auto [from, to] = *hours_;
    const int hour = local_hour(time, zone_);
    return from <= to ? from <= hour && hour <= to : from <= hour || hour <= to;
  }

 private:
  bool take_day(std::string word) {
    word = lower_case(word);
    if (word.ends_with('s')) word.pop_back();
    if (const auto day = weekday_of(word))
      days_.insert(*day);
    else if (word == "weekend")
      days_.insert({5, 6});
    else if (word == "weekday")
      days_.insert({0, 1, 2, 3, 4});
    else
      return word == "on" || word == "every" || word == "in";
    return true;
  }

  TimeZone zone_;
  std::set<int> days_;  ///< 0 = Monday; empty = any
  std::optional<std::pair<int, int>> hours_;
};

std::vector<UsualPlace> usual_places(const Snapshot& snapshot, Id object, const RecurringTime& during) {
  std::vector<UsualPlace> places;
  const TimeZone zone = snapshot.store().time_zone();
  size_t all = 0;
  for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of())) {
    const auto place = snapshot.place_ref(sighting.observation.place);
    if (!place || !during.covers(sighting.time)) continue;
    ++all;
    auto found =
        std::ranges::find_if(places, [&](const UsualPlace& one) { return one.place.id == place->id; });
    if (found == places.end()) found = places.insert(places.end(), {.place = *place});
    ++found->sightings;
    ++found->by_hour[local_hour(sighting.time, zone)];
    ++found->by_weekday[local_weekday(sighting.time, zone)];
    found->last = *snapshot.scene_ref(sighting.association.scene);
  }
  for (UsualPlace& place : places)
    place.share = static_cast<double>(place.sightings) / static_cast<double>(all);
  std::ranges::sort(places, [](const UsualPlace& a, const UsualPlace& b) {
    return a.sightings != b.sightings ? a.sightings > b.sightings : a.place.name < b.place.name;
  });
  return places;
}

/// "most in the hours from 7:00 (3), 12:00 (2)".
std::string hours_text(const std::map<int, size_t>& by_hour) {
  std::vector<std::pair<int, size_t>> hours(by_hour.begin(), by_hour.end());
  std::ranges::stable_sort(hours, std::ranges::greater(), &std::pair<int, size_t>::second);
  if (hours.size() > 3) hours.resize(3);
  std::vector<std::string> parts;
  for (const auto& [hour, count] : hours) parts.push_back(fmt::format("{}:00 ({})", hour, count));
  return fmt::format("most in the hours from {}", fmt::join(parts, ", "));
}

std::string days_text(const std::map<int, size_t>& by_weekday) {
  std::vector<std::string> parts;
  for (const auto& [day, count] : by_weekday)
    parts.push_back(fmt::format("{} {}", kDays.at(static_cast<size_t>(day)), count));
  return fmt::format("{}", fmt::join(parts, ", "));
}

const Record<UsualPlace>& usual_place_record() {
  static const auto record = Record<UsualPlace>("UsualPlace")
                                 .value("place", &UsualPlace::place)
                                 .value("sightings", &UsualPlace::sightings)
                                 .value("share", &UsualPlace::share)
                                 .record("last", &UsualPlace::last, scene_record())
                                 .value("by_hour",
                                        [](const UsualPlace& place) {
                                          std::vector<std::pair<std::string, size_t>> counts;
                                          for (const auto& [hour, count] : place.by_hour)
                                            counts.emplace_back(std::to_string(hour), count);
                                          return counts;
                                        })
                                 .value("by_weekday", [](const UsualPlace& place) {
                                   std::vector<std::pair<std::string, size_t>> counts;
                                   for (const auto& [day, count] : place.by_weekday)
                                     counts.emplace_back(kDays.at(static_cast<size_t>(day)), count);
                                   return counts;
                                 });
  return record;
}

/// When the visits began that looks belong to.
std::vector<TimeNs> visit_begins(std::vector<TimeNs> looks) {
  std::ranges::sort(looks);
  std::vector<TimeNs> begins;
  for (size_t i = 0; i < looks.size(); ++i)
    if (i == 0 || looks[i] - looks[i - 1] > kVisitGap) begins.push_back(looks[i]);
  return begins;
}

/// `meant`: the objects asked about; unset = all.
PlaceContentsHistory contents_history_of(const Snapshot& snapshot, const PlaceRow& place,
                                         const ContentsHistoryQuestion& question,
                                         const std::optional<std::set<Id>>& meant) {
  constexpr double kMinLook = 0.1;
  const RecurringTime during(question.during, snapshot.store());
  const auto is_then = [&](TimeNs time) {
    return (!question.from || time >= *question.from) && (!question.to || time <= *question.to) &&
           during.covers(time);
  };
  PlaceContentsHistory history{.place = {place.id, place.name, place.container}};
  std::vector<TimeNs> times;
  for (const VisibilityRow& view : snapshot.store().visibility_of_place(place.id)) {
    const SceneRow* scene = snapshot.scene(view.scene);
    if (scene == nullptr || view.fraction.value_or(0) < kMinLook || !is_then(scene->time)) continue;
    ++history.looks;
    times.push_back(scene->time);
    if (!history.last_look || history.last_look->time <= scene->time)
      history.last_look = snapshot.scene_ref(*scene);
  }
  const std::vector<TimeNs> visits = visit_begins(std::move(times));
  history.visits = visits.size();
  for (const BeliefRow& belief : snapshot.beliefs()) {
    if (meant && !meant->contains(belief.object)) continue;
    PastContent object;
    size_t all = 0;
    std::set<TimeNs> seen_in;
    for (const ObjectObservation& sighting :
         snapshot.store().observations_of(belief.object, snapshot.as_of())) {
      if (sighting.observation.place) ++all;
      if (sighting.observation.place != place.id || !is_then(sighting.time)) continue;
      object.last = *snapshot.scene_ref(sighting.association.scene);
      if (object.sightings++ == 0) object.first = object.last;
      if (const auto after = std::ranges::upper_bound(visits, sighting.time); after != visits.begin())
        seen_in.insert(*std::prev(after));
    }
    if (object.sightings == 0) continue;
    object.visits = seen_in.size();
    object.now = snapshot.object_belief(belief);
    object.share = static_cast<double>(object.sightings) / static_cast<double>(all);
    object.still_there = is_believed_at(belief, place.id);
    history.objects.push_back(std::move(object));
  }
  std::ranges::sort(history.objects, [](const PastContent& a, const PastContent& b) {
    return a.sightings != b.sightings ? a.sightings > b.sightings : a.now.object.id < b.now.object.id;
  });
  return history;
}

/// What is there now and was not in the period.
PlaceContentsHistory new_contents_of(const Snapshot& snapshot, const PlaceRow& place,
                                     const ContentsHistoryQuestion& question,
                                     const std::optional<std::set<Id>>& meant) {
  std::set<Id> then;
  for (const PastContent& object : contents_history_of(snapshot, place, question, meant).objects)
    then.insert(object.now.object.id);
  if (question.to) {  // what was not in view, too
    const Snapshot at_end(snapshot.store(), {.at = question.to});
    for (const BeliefRow& belief : at_end.beliefs())
      if (is_believed_at(belief, place.id)) then.insert(belief.object);
  }
  ContentsHistoryQuestion ever = question;
  ever.from.reset();
  ever.to.reset();
  PlaceContentsHistory history = contents_history_of(snapshot, place, ever, meant);
  std::erase_if(history.objects, [&](const PastContent& object) {
    return then.contains(object.now.object.id) || !object.still_there || !replies::is_there(object.now);
  });
  return history;
}

struct PlaceStay {
  Id place = 0;
  TimeNs from = 0;
};

/// Stays at known places; consecutive ones at one place are one.
std::vector<PlaceStay> stays_at_places(const Snapshot& snapshot, Id object) {
  std::vector<PlaceStay> stays;
  for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of()))
    if (sighting.observation.place && (stays.empty() || stays.back().place != *sighting.observation.place))
      stays.push_back({*sighting.observation.place, sighting.time});
  return stays;
}

/// Of an even number the mean of the two in the middle: stays are few.
double median_of_few(std::vector<double> values) {
  std::ranges::sort(values);
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

/// Counts the stays of objects and the steps between them.
class TransitionCounts {
 public:
  void add(const std::vector<PlaceStay>& stays) {
    if (!stays.empty()) ++begins_[stays.front().place];
    for (size_t i = 0; i < stays.size(); ++i) {
      ++stays_[stays[i].place];
      if (i + 1 == stays.size()) break;
      ++steps_[stays[i].place][stays[i + 1].place];
      hours_[stays[i].place].push_back(static_cast<double>(stays[i + 1].from - stays[i].from) /
                                       static_cast<double>(kHour));
    }
  }

  void write(const Snapshot& snapshot, LifeCycleAnswer& answer) const {
    for (const auto& [place, count] : stays_) {
      answer.places.push_back({*snapshot.place_ref(place), count, {}});
      if (const auto found = hours_.find(place); found != hours_.end())
        answer.places.back().hours = median_of_few(found->second);
    }
    for (const auto& [from, targets] : steps_)
      for (const auto& [to, count] : targets)
        answer.steps.push_back({*snapshot.place_ref(from), *snapshot.place_ref(to), count,
                                static_cast<double>(count) / static_cast<double>(hours_.at(from).size())});
    std::ranges::stable_sort(answer.places, std::ranges::greater(), &LifeCyclePlace::stays);
    std::ranges::stable_sort(answer.steps, std::ranges::greater(), &LifeCycleStep::count);
    for (const Id place : usual_cycle()) answer.usual.push_back(*snapshot.place_ref(place));
  }

 private:
  using Counts = std::map<Id, size_t>;
  static Id most(const Counts& counts) {
    return std::ranges::max_element(counts, {}, &Counts::value_type::second)->first;
  }

  std::vector<Id> usual_cycle() const {
    std::vector<Id> cycle;
    if (begins_.empty()) return cycle;
    std::set<Id> visited;
    for (Id place = most(begins_);; place = most(steps_.at(place))) {
      cycle.push_back(place);
      if (!visited.insert(place).second || !steps_.contains(place)) return cycle;
    }
  }

  Counts begins_, stays_;
  std::map<Id, Counts> steps_;
  std::map<Id, std::vector<double>> hours_;
};

}  // namespace

const Occasion* find_occasion(std::string_view name) {
  const auto* found = std::ranges::find_if(kOccasions, [&](const Occasion& one) { return name == one.name; });
  return found == kOccasions.end() ? nullptr : found;
}

UsualAnswer ask(const Store& store, const UsualQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  const RecurringTime during(question.during, store);
  UsualAnswer answer{.asked = question.subject, .during = question.during};
  for (const Id object : snapshot.find_objects(question.subject))
    answer.objects.push_back({snapshot.object_belief(object), usual_places(snapshot, object, during)});
  return answer;
}

std::string to_text(const UsualAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  const std::string during = answer.during.empty() ? "" : fmt::format(" ({})", answer.during);
  for (const UsualObject& object : answer.objects) {
    const std::string name = to_text(object.now.object);
    if (object.places.empty()) {
      lines.push_back(fmt::format("{} was never seen at a place{}.", name, during));
      continue;
    }
    size_t all = 0;
    for (const UsualPlace& place : object.places) all += place.sightings;
    const UsualPlace& first = object.places[0];
    lines.push_back(fmt::format("{} is usually {}{}: seen there in {} of {} scenes ({:.0f} %), {}; {}.", name,
                                place_text(first.place), during, first.sightings, all, 100 * first.share,
                                hours_text(first.by_hour), days_text(first.by_weekday)));
    for (size_t i = 1; i < object.places.size(); ++i)
      lines.push_back(fmt::format("  also {} in {} ({:.0f} %), last at {}",
                                  place_text(object.places[i].place),
                                  counted(object.places[i].sightings, "scene"), 100 * object.places[i].share,
                                  times.text(object.places[i].last.time)));
  }
  return lines_text(lines);
}

namespace {

const Record<UsualObject>& usual_object_record() {
  static const auto record = Record<UsualObject>("UsualObject")
                                 .with(&UsualObject::now, belief_record())
                                 .record("places", &UsualObject::places, usual_place_record());
  return record;
}

const Record<UsualAnswer>& usual_record() {
  static const auto record =
      Record<UsualAnswer>("UsualAnswer")
          .value("asked", &UsualAnswer::asked)
          .record("objects", &UsualAnswer::objects, usual_object_record())
          .value("during", [](const UsualAnswer& answer) { return unless_empty(answer.during); });
  return record;
}

}  // namespace

Json to_json(const UsualAnswer& answer) {
  return usual_record().json(answer);
}

namespace {

/// "biggest" of "biggest cup", "second biggest" of "second biggest cup"; "" where none is said.
std::string superlative_of(const std::string& subject) {
  const std::vector<std::string> words = words_of(subject);
  const size_t at = !words.empty() && rank_called(words[0]) > 0 ? 1 : 0;
  if (at >= words.size() || !is_superlative(words[at])) return "";
  return at == 0 ? words[0] : words[0] + " " + words[1];
}

/// Only the one of all with most of something.
void keep_most(const Snapshot& snapshot, const std::string& rank, ContentsHistoryAnswer& answer) {
  std::vector<std::string> names;
  for (const PlaceContentsHistory& place : answer.places)
    for (const PastContent& object : place.objects) names.push_back(object.now.object.name);
  if (names.empty()) return;
  const Id most = snapshot.find_objects(fmt::format("{} {}", rank, fmt::join(names, " or "))).front();
  for (PlaceContentsHistory& place : answer.places)
    std::erase_if(place.objects, [&](const PastContent& object) { return object.now.object.id != most; });
}

}  // namespace

ContentsHistoryAnswer ask(const Store& store, const ContentsHistoryQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ContentsHistoryAnswer answer{.asked = question.place, .during = question.during};
  // "Biggest cup": of the cups that were there.
  const std::string rank = superlative_of(question.subject);
  const std::string subject = trimmed(question.subject.substr(rank.size()));
  std::optional<std::set<Id>> meant;
  if (!subject.empty()) {
    const std::vector<Id> objects = snapshot.find_objects(subject);
    meant.emplace(objects.begin(), objects.end());
  }
  const bool fresh = question.state == "new";
  for (const PlaceRow& place : snapshot.find_places(question.place))
    answer.places.push_back(
        (fresh ? new_contents_of : contents_history_of)(snapshot, place, question, meant));
  if (!rank.empty()) keep_most(snapshot, rank, answer);
  if (question.state.empty() || fresh) return answer;
  std::set<Id> handled;  // that left, or were moved
  if (question.state != "gone")
    for (const Change& change :
         ask(store, ChangesQuestion{question.from, question.to, "", question.place, question.as_of,
                                    question.state == "stayed" ? "left" : "handled"})
             .changes)
      if (change.object) handled.insert(change.object->id);
  for (PlaceContentsHistory& place : answer.places)
    std::erase_if(place.objects, [&](const PastContent& object) {
      const bool there = object.still_there && replies::is_there(object.now);
      return question.state == "gone" ? there : !there || handled.contains(object.now.object.id);
    });
  return answer;
}

std::vector<TimeSpan> spans_at(const Store& store, const AsOf& as_of, const PastContent& object,
                               const PlaceRef& place) {
  const HistoryAnswer history =
      ask(store, HistoryQuestion{.subject = object.now.object.name, .as_of = as_of, .place = place.name});
  std::vector<TimeSpan> spans = spans_of(history.objects.front().stays);
  const auto latest = store.latest_scene(as_of);
  if (object.still_there && replies::is_there(object.now) && latest && !spans.empty())
    spans.back().last = latest->time;
  return spans;
}

std::string to_text(const ContentsHistoryAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const PlaceContentsHistory& history : answer.places) {
    const std::string where = place_text(history.place), looks = counted(history.looks, "look");
    if (history.objects.empty()) {
      lines.push_back(history.looks == 0
                          ? fmt::format("What is kept {} is not known: nobody has looked there.", where)
                          : fmt::format("Nothing was seen {} in the {} at it.", where, looks));
      continue;
    }
    lines.push_back(fmt::format("{} {} seen {} ({}):", counted(history.objects.size(), "object"),
                                history.objects.size() == 1 ? "was" : "were", where, looks));
    for (const PastContent& object : history.objects)
      lines.push_back(fmt::format("  {}: in {} {}, {:.0f} % of all that saw it at a place; {}.",
                                  to_text(object.now.object), counted(object.sightings, "scene"),
                                  times.span_text(object.first.time, object.last.time), 100 * object.share,
                                  object.still_there ? "still there" : "no longer there"));
  }
  return lines_text(lines);
}

namespace {

const Record<PastContent>& past_content_record() {
  static const auto record = Record<PastContent>("PastContent")
                                 .with(&PastContent::now, belief_record())
                                 .value("sightings_there", &PastContent::sightings)
                                 .value("visits_there", &PastContent::visits)
                                 .value("share", &PastContent::share)
                                 .record("first_there", &PastContent::first, scene_record())
                                 .record("last_there", &PastContent::last, scene_record())
                                 .value("still_there", &PastContent::still_there);
  return record;
}

const Record<PlaceContentsHistory>& place_history_record() {
  static const auto record = Record<PlaceContentsHistory>("PlaceContentsHistory")
                                 .value("place", &PlaceContentsHistory::place)
                                 .value("looks", &PlaceContentsHistory::looks)
                                 .value("visits", &PlaceContentsHistory::visits)
                                 .record("objects", &PlaceContentsHistory::objects, past_content_record())
                                 .record("last_view", &PlaceContentsHistory::last_look, scene_record());
  return record;
}

const Record<ContentsHistoryAnswer>& contents_history_record() {
  static const auto record =
      Record<ContentsHistoryAnswer>("ContentsHistoryAnswer")
          .value("asked", &ContentsHistoryAnswer::asked)
          .value("during", [](const ContentsHistoryAnswer& answer) { return unless_empty(answer.during); })
          .record("places", &ContentsHistoryAnswer::places, place_history_record());
  return record;
}

}  // namespace

Json to_json(const ContentsHistoryAnswer& answer) {
  return contents_history_record().json(answer);
}

LifeCycleAnswer ask(const Store& store, const LifeCycleQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  LifeCycleAnswer answer{.asked = question.subject};
  TransitionCounts counts;
  for (const Id object : snapshot.find_objects(question.subject)) {
    answer.objects.push_back(snapshot.object_ref(object));
    counts.add(stays_at_places(snapshot, object));
  }
  counts.write(snapshot, answer);
  return answer;
}

std::string to_text(const LifeCycleAnswer& answer, const TimeWriter&) {
  std::vector<std::string> names, cycle;
  for (const ObjectRef& object : answer.objects) names.push_back(to_text(object));
  if (answer.places.empty()) return fmt::format("{}: never seen at a place.\n", fmt::join(names, ", "));
  for (const PlaceRef& place : answer.usual) cycle.push_back(place.name);
  std::vector<std::string> lines = {fmt::format("{}: {}", fmt::join(names, ", "), fmt::join(cycle, " → "))};
  for (const LifeCyclePlace& place : answer.places)
    lines.push_back(fmt::format(
        "  {}: {}{}", place_text(place.place), counted(place.stays, "stay"),
        place.hours ? fmt::format(", {:.1f} h until it is seen at the next place (median)", *place.hours)
                    : ""));
  for (const LifeCycleStep& step : answer.steps)
    lines.push_back(fmt::format("  {} → {}: {} ({} of the moves from there)", step.from.name, step.to.name,
                                counted(step.count, "time"), percent(step.share)));
  return lines_text(lines);
}

namespace {

const Record<LifeCyclePlace>& life_cycle_place_record() {
  static const auto record = Record<LifeCyclePlace>("LifeCyclePlace")
                                 .value("place", &LifeCyclePlace::place)
                                 .value("stays", &LifeCyclePlace::stays)
                                 .value("hours", &LifeCyclePlace::hours);
  return record;
}

const Record<LifeCycleStep>& life_cycle_step_record() {
  static const auto record = Record<LifeCycleStep>("LifeCycleStep")
                                 .value("from", &LifeCycleStep::from)
                                 .value("to", &LifeCycleStep::to)
                                 .value("count", &LifeCycleStep::count)
                                 .value("share", &LifeCycleStep::share);
  return record;
}

const Record<LifeCycleAnswer>& life_cycle_record() {
  static const auto record = Record<LifeCycleAnswer>("LifeCycleAnswer")
                                 .value("asked", &LifeCycleAnswer::asked)
                                 .record("objects", &LifeCycleAnswer::objects, object_record())
                                 .record("places", &LifeCycleAnswer::places, life_cycle_place_record())
                                 .record("steps", &LifeCycleAnswer::steps, life_cycle_step_record())
                                 .value("usual", &LifeCycleAnswer::usual);
  return record;
}

}  // namespace

Json to_json(const LifeCycleAnswer& answer) {
  return life_cycle_record().json(answer);
}

namespace {

std::vector<SentenceForm> usual_sentences() {
  using enum Asks;
  return {
      {"where: keep <object> [stand|find|location]", place, "Where do we keep the cereal?"},
      {"where: usually <object> [location|keep|put|find|see|leave|stand|belong|go|get]", place,
       "Where is the red cup usually in the morning?"},
      {"where: belong <object> [location]", place},
      {"where: do put|go <object> -did -person", place},
      {"where: do put <object> -did", place},
      {"where: should <object> [go|stand|put|keep]", place},
      {"what|bare: usually location <object>", place, "What is the usual place of the pot?"},
      {"what|bare: usually location for<object>", place},
      {"yes|bare: asusual <object> [stand|keep|put|leave|back|see]",
       verdict,
       "Is the pot in its usual place?",
       {},
       SentenceTime::at},
  };
}

std::vector<SentenceForm> contents_history_sentences() {
  using enum Asks;
  const auto state = [](const char* name) { return std::map<std::string, std::string>{{"state", name}}; };
  const auto no_longer = state("gone"), stayed = state("stayed"), unmoved = state("unmoved");
  return {
      {"what: keep at<place> [usually|thing]", objects, "What do we keep in this drawer?"},
      {"what: do put at<place> [usually|thing] -did", objects},
      {"what: belong|go to<place> [usually|thing] -was -did -have", objects},
      {"what: usually at<place> [keep|stand|find|thing|put|see]",
       objects,
       "What is usually on the counter at eight?",
       {},
       SentenceTime::during},
      {"what: usually at<place> [keep|stand|find|thing|put|see]", objects},
      {"what: miss from<place> time [thing]", objects, "What is missing from the table since noon?",
       no_longer},
      {"what: miss at<place> time [thing]", objects, "", no_longer},
      {"what: not leave <place> [thing|move|take]", objects, "What never left the counter?", stayed},
      {"what: not leave|go|take|move from<place> [thing]", objects, "", stayed},
      {"what: not leave which<object> <place> [move|take]", objects, "", stayed},
      {"what: not leave|go|take|move which<object> from<place>", objects, "", stayed},
      {"what: throughout at<place> [thing|keep|leave]", objects, "What was on the table all day?", stayed},
      {"what: throughout which<object> at<place> [keep|leave]", objects, "", stayed},
      {"what: stays at<place> [thing]", objects, "", stayed},
      {"what: stays which<object> at<place>", objects, "", stayed},
      {"yes: stays thing at<place>", exists, "", stayed},
      {"what: not stays at<place> [thing]", objects, "What did not stay on the table?", no_longer},
      {"what: not stays which<object> at<place>", objects, "", no_longer},
      {"what: not move at<place> [thing|take|change]", objects, "What was not moved on the counter?",
       unmoved},
      {"what: see at<place> person [thing] -may -do", objects},
      {"what: see last at<place> [thing]", last_time},
      {"what: last at<place> [thing|put|stand]", last_time},
      {"when: thing last at<place> [stand|see]", last_time, "When was anything on the shelf last?"},
      {"when: see last at<place> [thing|stand]", last_time},
      {"what: newsince at<place> [thing]", objects, "", state("new")},
      {"what: newsince which<object> at<place>", objects, "", state("new")},
      {"what: been at<place> [stand|thing|put|see|keep]", objects, "What has been on the table today?"},
      {"what: most<object> at<place> [stand|put|see]", objects,
       "What was the biggest object on the table today?"},
      {"what: longesttime at<place> [thing|keep|leave]", longest, "What has been on the table the longest?"},
      {"what: longesttime which<object> at<place> [keep|leave]", longest},
      {"howlong: empty <place> -was -did -had",
       duration,
       "How long has the drawer been empty?",
       {},
       SentenceTime::none},
      {"sincewhen: empty <place> -was -did -had", duration, "", {}, SentenceTime::none},
      {"howoften: look <place>", looks, "How often did you look at the shelf?"},
      {"howoften: look|see at<place>", looks},
      {"howmany: look at<place>", looks},
  };
}

constexpr const char* kDuringHelp =
    "Only what was seen then: \"noon\", \"9 to 11\", \"Mondays\", \"weekend morning\"";

}  // namespace

std::vector<Question> routine_questions() {
  return {
      {.name = "usual",
       .description = "Where an object usually is, by hour and weekday",
       .parameters = {object_parameter(), {.name = "during", .help = kDuringHelp}},
       .examples = {"red", "object_5 --during morning --json"},
       .answer = format::schema_by<usual_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), UsualQuestion{given.text("object"), given.as_of(), given.text("during")});
       },
       .time = SentenceTime::during,
       .sentences = usual_sentences(),
       .of_moment = false},
      {.name = "contents-history",
       .description = "What was seen on or in a place, ever or in a period",
       .parameters = {place_parameter(),
                      only_object_parameter(),
                      {.name = "state",
                       .help =
                           "gone: only what is no longer there; new: only what is there and was not then; "
                           "stayed: only what never left; unmoved: "
                           "nor was moved",
                       .default_text = "any",
                       .choices = {"gone", "stayed", "unmoved", "new"}},
                      {.name = "during", .help = kDuringHelp}},
       .period = true,
       .examples = {"drawer_1", "table_1 --between 08:00 10:00 --json"},
       .answer = format::schema_by<contents_history_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(),
                    ContentsHistoryQuestion{given.text("place"), given.as_of(), given.from(), given.to(),
                                            given.text("object"), given.text("state"), given.text("during")});
       },
       .time = SentenceTime::period,
       .sentences = contents_history_sentences(),
       .of_moment = false},
      {.name = "life-cycle",
       .description = "From which place to which an object usually moves",
       .parameters = {object_parameter()},
       .examples = {"red", "green --json"},
       .answer = format::schema_by<life_cycle_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), LifeCycleQuestion{given.text("object"), given.as_of()});
       },
       .time = SentenceTime::none,
       .sentences = {{"what|bare|order: lifecycle <object> [show]", Asks::summary,
                      "What is the life cycle of a plate?"}},
       .of_moment = false},
  };
}

}  // namespace loci::memory
