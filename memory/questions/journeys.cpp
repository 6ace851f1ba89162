#include "memory/questions/journeys.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "mapping/base/quantile.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

constexpr double kMetresPerSecond = 0.5;  // of a robot among people
constexpr double kLookSeconds = 3;
constexpr double kOpenSeconds = 8;  // a drawer or door
constexpr double kUnknownWay_m = 2;
constexpr double kUnknownVisibility = 0.5;
/// Sightings at a place where it was never seen count so much: it may be anywhere.
constexpr double kAnywhere = 0.25;
/// What a look at all of a place would have missed.
constexpr double kOverlooked = 0.1;
constexpr size_t kMaxPlaces = 10;

struct PlaceStay {
  Id place = 0;
  TimeNs from = 0;
};

/// Stays at known places; two at one place without another between are one.
std::vector<PlaceStay> stays_at_places(const Snapshot& snapshot, Id object) {
  std::vector<PlaceStay> stays;
  for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of()))
    if (sighting.observation.place && (stays.empty() || stays.back().place != *sighting.observation.place))
      stays.push_back({*sighting.observation.place, sighting.time});
  return stays;
}

/// What the objects' stays add up to.
class Lifecycle {
 public:
  void add(const std::vector<PlaceStay>& stays) {
    if (!stays.empty()) ++begins_[stays.front().place];
    for (size_t i = 0; i < stays.size(); ++i) {
      ++stays_[stays[i].place];
      if (i + 1 == stays.size()) break;
      ++steps_[stays[i].place][stays[i + 1].place];
      hours_[stays[i].place].push_back(static_cast<double>(stays[i + 1].from - stays[i].from) /
                                       static_cast<double>(3600 * kSecond));
    }
  }

  void write(const Snapshot& snapshot, LifecycleAnswer& answer) const {
    for (const auto& [place, count] : stays_) {
      answer.places.push_back({*snapshot.place_ref(place), count, {}});
      if (const auto found = hours_.find(place); found != hours_.end())
        answer.places.back().hours = median(found->second);
    }
    for (const auto& [from, targets] : steps_)
      for (const auto& [to, count] : targets)
        answer.steps.push_back({*snapshot.place_ref(from), *snapshot.place_ref(to), count,
                                static_cast<double>(count) / static_cast<double>(hours_.at(from).size())});
    std::stable_sort(answer.places.begin(), answer.places.end(),
                     [](const auto& a, const auto& b) { return a.stays > b.stays; });
    std::stable_sort(answer.steps.begin(), answer.steps.end(),
                     [](const auto& a, const auto& b) { return a.count > b.count; });
    for (const Id place : usual_way()) answer.usual.push_back(*snapshot.place_ref(place));
  }

 private:
  using Counts = std::map<Id, size_t>;
  static Id most(const Counts& counts) {
    return std::max_element(counts.begin(), counts.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }

  std::vector<Id> usual_way() const {
    std::vector<Id> way;
    if (begins_.empty()) return way;
    std::set<Id> been;
    for (Id place = most(begins_);; place = most(steps_.at(place))) {
      way.push_back(place);
      if (!been.insert(place).second || !steps_.contains(place)) return way;
    }
  }

  Counts begins_, stays_;
  std::map<Id, Counts> steps_;
  std::map<Id, std::vector<double>> hours_;
};

/// The looks at a place: how much they show, and what they showed since a scene.
struct PlaceLooks {
  double visibility = kUnknownVisibility;
  double unseen_since = 1;  ///< probability that a thing there would not have been seen since
  std::optional<SceneRef> last = {};
};

PlaceLooks looks_at(const Snapshot& snapshot, const PlaceRow& place, TimeNs since) {
  PlaceLooks looks;
  double sum = 0, count = 0;
  for (const VisibilityRow& look : snapshot.store().visibility_of_place(place.id)) {
    const SceneRow* scene = snapshot.scene(look.scene);
    const double fraction = look.fraction.value_or(0);
    if (scene == nullptr || fraction <= 0) continue;
    sum += fraction;
    ++count;
    if (scene->time > since)
      looks.unseen_since = std::min(looks.unseen_since, 1 - (1 - kOverlooked) * fraction);
    if (!looks.last || looks.last->time <= scene->time) looks.last = snapshot.scene_ref(*scene);
  }
  if (count > 0) looks.visibility = sum / count;
  return looks;
}

class Search {
 public:
  Search(const Snapshot& snapshot, std::optional<Vector2d> from) : snapshot_(snapshot), from_(from) {}

  NextLook plan(Id object) const {
    const BeliefRow& belief = *snapshot_.belief(object);
    NextLook look{.now = snapshot_.state(belief)};
    const double there = belief.status == ObjectStatus::gone ? 0 : belief.probability;
    const TimeNs seen = look.now.last_seen ? look.now.last_seen->time : 0;
    std::map<Id, double> counts;
    for (const ObjectObservation& sighting : snapshot_.store().observations_of(object, snapshot_.as_of()))
      if (sighting.observation.place) ++counts[*sighting.observation.place];
    double elsewhere = 0;
    for (const PlaceRow& place : snapshot_.places()) {
      const PlaceLooks looks = looks_at(snapshot_, place, seen);
      LookPlace one = place_to_look(place, looks);
      const bool current = belief.place == place.id;
      const double count = counts.contains(place.id) ? counts[place.id] : 0;
      // What is believed of its place already knows of the looks since; elsewhere they must be reckoned in.
      one.probability = current ? there : (count + kAnywhere) * looks.unseen_since;
      if (!current) elsewhere += one.probability;
      one.reason = current && there > 0 ? "it is believed to be there"
                   : count > 0          ? fmt::format("it was seen there in {} scenes", count)
                                        : "it was never seen there";
      look.places.push_back(std::move(one));
    }
    for (LookPlace& one : look.places) {
      if (belief.place != one.place.id && elsewhere > 0) one.probability *= (1 - there) / elsewhere;
      one.chance_per_minute = one.probability * one.visibility / one.seconds * 60;
    }
    std::stable_sort(look.places.begin(), look.places.end(), [](const LookPlace& a, const LookPlace& b) {
      return a.chance_per_minute > b.chance_per_minute;
    });
    if (look.places.size() > kMaxPlaces) look.places.resize(kMaxPlaces);
    return look;
  }

 private:
  LookPlace place_to_look(const PlaceRow& row, const PlaceLooks& looks) const {
    LookPlace place{.place = {row.id, row.name, row.container}};
    place.visibility = looks.visibility;
    place.last_look = looks.last;
    const auto centre = centre_of(row);
    if (from_ && centre) place.distance_m = (centre->head<2>() - *from_).norm();
    place.seconds = place.distance_m.value_or(kUnknownWay_m) / kMetresPerSecond + kLookSeconds +
                    (row.container ? kOpenSeconds : 0);
    return place;
  }

  const Snapshot& snapshot_;
  std::optional<Vector2d> from_;
};

}  // namespace

LifecycleAnswer ask(const Store& store, const LifecycleQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  LifecycleAnswer answer{.asked = question.subject};
  Lifecycle lifecycle;
  for (const Id object : snapshot.find_objects(question.subject)) {
    answer.objects.push_back(snapshot.object_ref(object));
    lifecycle.add(stays_at_places(snapshot, object));
  }
  lifecycle.write(snapshot, answer);
  return answer;
}

NextLookAnswer ask(const Store& store, const NextLookQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  std::optional<Vector2d> from = question.from;
  for (auto scene = snapshot.scenes().rbegin(); !from && scene != snapshot.scenes().rend(); ++scene)
    if (scene->map_from_camera) from = scene->map_from_camera->translation().head<2>();
  NextLookAnswer answer{.asked = question.subject};
  const Search search(snapshot, from);
  for (const Id object : snapshot.find_objects(question.subject))
    answer.objects.push_back(search.plan(object));
  return answer;
}

}  // namespace loci::memory
