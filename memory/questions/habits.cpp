#include "memory/questions/habits.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <sstream>

#include "memory/questions/people_time.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

/// Hours and days of the week.
class During {
 public:
  During(const std::string& text, const Store& store) : zone_(store.time_zone_minutes()) {
    std::istringstream words(text);
    std::string rest;
    for (std::string word; words >> word;)
      if (!take_day(word)) rest += (rest.empty() ? "" : " ") + word;
    if (rest.empty()) return;
    const TimeReader times(store);
    const size_t to = rest.find(" to ");
    const TimeSpan first = times.read(rest.substr(0, to));
    const TimeSpan last = to == std::string::npos ? first : times.read(rest.substr(to + 4));
    if (first.last - first.first >= 23 * 3600 * kSecond)
      days_.insert(local_weekday(first.first, zone_));  // "today"
    else
      hours_ = {local_hour(first.first, zone_), local_hour(last.last, zone_)};
  }

  bool holds(TimeNs time) const {
    if (!days_.empty() && !days_.contains(local_weekday(time, zone_))) return false;
    if (!hours_) return true;
    const auto [from, to] = *hours_;
    const int hour = local_hour(time, zone_);
    return from <= to ? from <= hour && hour <= to : from <= hour || hour <= to;
  }

 private:
  bool take_day(std::string word) {
    static const std::array<std::string, 7> names = {"monday", "tuesday",  "wednesday", "thursday",
                                                     "friday", "saturday", "sunday"};
    std::ranges::transform(word, word.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (word.ends_with('s')) word.pop_back();
    const auto name = std::ranges::find(names, word);
    if (name != names.end())
      days_.insert(static_cast<int>(name - names.begin()));
    else if (word == "weekend")
      days_.insert({5, 6});
    else if (word == "weekday")
      days_.insert({0, 1, 2, 3, 4});
    else
      return word == "on" || word == "every" || word == "in";
    return true;
  }

  int zone_;
  std::set<int> days_;  ///< 0 = Monday; empty = any
  std::optional<std::pair<int, int>> hours_;
};

std::vector<UsualPlace> usual_places(const Snapshot& snapshot, Id object, const During& during) {
  std::vector<UsualPlace> places;
  const int zone = snapshot.store().time_zone_minutes();
  size_t all = 0;
  for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of())) {
    const auto place = snapshot.place_ref(sighting.observation.place);
    if (!place || !during.holds(sighting.time)) continue;
    ++all;
    auto found = std::find_if(places.begin(), places.end(),
                              [&](const UsualPlace& one) { return one.place.id == place->id; });
    if (found == places.end()) found = places.insert(places.end(), {.place = *place});
    ++found->sightings;
    ++found->by_hour[local_hour(sighting.time, zone)];
    ++found->by_weekday[local_weekday(sighting.time, zone)];
    found->last = *snapshot.scene_ref(sighting.association.scene);
  }
  for (UsualPlace& place : places)
    place.share = static_cast<double>(place.sightings) / static_cast<double>(all);
  std::sort(places.begin(), places.end(), [](const UsualPlace& a, const UsualPlace& b) {
    return a.sightings != b.sightings ? a.sightings > b.sightings : a.place.name < b.place.name;
  });
  return places;
}

}  // namespace

UsualAnswer ask(const Store& store, const UsualQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  const During during(question.during, store);
  UsualAnswer answer{.asked = question.subject, .during = question.during};
  for (const Id object : snapshot.find_objects(question.subject))
    answer.objects.push_back(
        {snapshot.state(*snapshot.belief(object)), usual_places(snapshot, object, during)});
  return answer;
}

KeptAnswer ask(const Store& store, const KeptQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  KeptAnswer answer{.asked = question.place};
  for (const PlaceRow& row : snapshot.find_places(question.place)) {
    KeptPlace kept{.place = {row.id, row.name, row.container}};
    for (const VisibilityRow& look : store.visibility_of_place(row.id)) {
      const SceneRow* scene = snapshot.scene(look.scene);
      if (scene == nullptr || look.fraction.value_or(0) <= 0) continue;
      ++kept.looks;
      if (!kept.last_look || kept.last_look->time <= scene->time) kept.last_look = snapshot.scene_ref(*scene);
    }
    for (const BeliefRow& belief : snapshot.beliefs()) {
      KeptObject object;
      size_t all = 0;
      for (const ObjectObservation& sighting : store.observations_of(belief.object, question.as_of)) {
        if (sighting.observation.place) ++all;
        if (sighting.observation.place != row.id) continue;
        object.last = *snapshot.scene_ref(sighting.association.scene);
        if (object.sightings++ == 0) object.first = object.last;
      }
      if (object.sightings == 0) continue;
      object.now = snapshot.state(belief);
      object.share = static_cast<double>(object.sightings) / static_cast<double>(all);
      object.still_there =
          belief.place == row.id && belief.status != ObjectStatus::gone && belief.probability >= 0.5;
      kept.objects.push_back(std::move(object));
    }
    std::sort(kept.objects.begin(), kept.objects.end(), [](const KeptObject& a, const KeptObject& b) {
      return a.sightings != b.sightings ? a.sightings > b.sightings : a.now.object.id < b.now.object.id;
    });
    answer.places.push_back(std::move(kept));
  }
  return answer;
}

}  // namespace loci::memory
