#include "memory/questions/company.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "memory/questions/occasions.h"
#include "memory/questions/people_time.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

constexpr TimeNs kVisitGap = 600 * kSecond;

/// Scenes of a place that follow each other closely are one visit: no single view sees all of it.
struct Visit {
  TimeNs from = 0, to = 0;
  double fraction = 0;        ///< most of the place that a scene of it saw
  std::set<Id> objects = {};  ///< seen at the place
};

constexpr size_t kMaxAlike = 5;

/// "1.2,0.4,0.9" as numbers; empty when it is something else.
std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream parts(text);
  std::string part;
  while (std::getline(parts, part, ',')) {
    size_t used = 0;
    try {
      numbers.push_back(std::stod(part, &used));
    } catch (const std::exception&) {
      return {};
    }
    if (part.find_first_not_of(' ', used) != std::string::npos || !std::isfinite(numbers.back())) return {};
  }
  return numbers.size() == 2 || numbers.size() == 3 ? numbers : std::vector<double>{};
}

/// Fills in what the point is.
void locate(const Snapshot& snapshot, const std::string& subject, NearAnswer& answer) {
  if (const auto numbers = numbers_of(subject); !numbers.empty()) {
    answer.level = numbers.size() == 2;
    answer.point = {numbers[0], numbers[1], answer.level ? 0 : numbers[2]};
    return;
  }
  const std::vector<PlaceRow> places = snapshot.places_called(subject);
  if (!places.empty()) {
    const std::optional<Vector3d> centre = centre_of(places[0]);
    if (!centre) throw Error(fmt::format("where {} is is not known", places[0].name));
    answer.around = places[0].name;
    answer.point = *centre;
    answer.level = true;
    return;
  }
  for (const Id object : snapshot.find_objects(subject)) {
    const BeliefRow& belief = *snapshot.belief(object);
    if (!belief.position) continue;
    answer.around = object_name(object);
    answer.point = *belief.position;
    return;
  }
  throw Error(fmt::format("where '{}' is is not known", subject));
}

/// Scenes in which an object was seen, with the place.
std::map<Id, std::optional<Id>> scenes_of(const Snapshot& snapshot, Id object) {
  std::map<Id, std::optional<Id>> scenes;
  for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of()))
    scenes[sighting.association.scene] = sighting.observation.place;
  return scenes;
}

using ScenesOfObjects = std::map<Id, std::map<Id, std::optional<Id>>>;

ScenesOfObjects scenes_of_objects(const Snapshot& snapshot, const std::vector<Id>& objects) {
  ScenesOfObjects all;
  for (const Id object : objects) all[object] = scenes_of(snapshot, object);
  return all;
}

Company company_of(const Snapshot& snapshot, const ScenesOfObjects& all, Id object, Id other) {
  Company company{.object = snapshot.object_ref(other), .scenes = all.at(other).size()};
  for (const auto& [scene, place] : all.at(object)) {
    const auto found = all.at(other).find(scene);
    if (found == all.at(other).end()) continue;
    ++company.together;
    if (place && found->second == place) ++company.same_place;
    const auto ref = snapshot.scene_ref(scene);
    if (ref && (!company.last || company.last->time <= ref->time)) company.last = ref;
  }
  const size_t either = all.at(object).size() + company.scenes - company.together;
  if (either > 0) company.share = static_cast<double>(company.together) / static_cast<double>(either);
  return company;
}

std::vector<Visit> visits_of(const Snapshot& snapshot, const ScenesOfObjects& all, Id place) {
  std::map<Id, std::set<Id>> there;
  for (const auto& [object, scenes] : all)
    for (const auto& [scene, at] : scenes)
      if (at == place) there[scene].insert(object);
  std::map<Id, double> fractions;
  for (const VisibilityRow& look : snapshot.store().visibility_of_place(place))
    fractions[look.scene] = look.fraction.value_or(0);
  std::vector<Visit> visits;
  for (const SceneRow& scene : snapshot.scenes()) {
    const double fraction = fractions.contains(scene.id) ? fractions[scene.id] : 0;
    const auto seen = there.find(scene.id);
    if (fraction <= 0 && seen == there.end()) continue;
    if (visits.empty() || scene.time - visits.back().to > kVisitGap)
      visits.push_back({.from = scene.time, .to = scene.time});
    Visit& visit = visits.back();
    visit.to = scene.time;
    visit.fraction = std::max(visit.fraction, fraction);
    if (seen != there.end()) visit.objects.insert(seen->second.begin(), seen->second.end());
  }
  return visits;
}

bool believed_at(const BeliefRow& belief, Id place) {
  return belief.place == place && belief.status != ObjectStatus::gone && belief.probability >= 0.5;
}

/// Visits before now that saw enough, at these hours, and had something of what is there now.
std::vector<Visit> alike(std::vector<Visit> visits, const std::set<Id>& present, const Occasion* occasion,
                         int zone_minutes) {
  std::erase_if(visits, [&](const Visit& visit) {
    const bool shares = present.empty() || std::any_of(present.begin(), present.end(), [&](Id object) {
                          return visit.objects.contains(object);
                        });
    return !shares || visit.objects.empty() || (visit.fraction > 0 && visit.fraction < kEnoughSeen) ||
           (occasion != nullptr && !occasion->covers(local_hour(visit.from, zone_minutes)));
  });
  return visits;
}

MissingPlace missing_at(const Snapshot& snapshot, const ScenesOfObjects& all, const PlaceRow& row,
                        const Occasion* occasion) {
  MissingPlace result{.place = {row.id, row.name, row.container}};
  std::set<Id> present;
  for (const BeliefRow& belief : snapshot.beliefs())
    if (believed_at(belief, row.id)) present.insert(belief.object);
  const std::vector<Visit> visits =
      alike(visits_of(snapshot, all, row.id), present, occasion, snapshot.store().time_zone_minutes());
  result.visits = visits.size();
  for (const BeliefRow& belief : snapshot.beliefs()) {
    ExpectedObject expected{.now = snapshot.state(belief)};
    expected.visits =
        static_cast<size_t>(std::count_if(visits.begin(), visits.end(), [&](const Visit& visit) {
          return visit.objects.contains(belief.object);
        }));
    if (!visits.empty())
      expected.share = static_cast<double>(expected.visits) / static_cast<double>(visits.size());
    if (present.contains(belief.object))
      result.present.push_back(std::move(expected));
    else if (expected.visits > 0 && expected.share >= 0.5)
      result.missing.push_back(std::move(expected));
  }
  for (auto* list : {&result.present, &result.missing})
    std::stable_sort(list->begin(), list->end(),
                     [](const ExpectedObject& a, const ExpectedObject& b) { return a.visits > b.visits; });
  return result;
}

/// How probable each occasion is, by what other scenes at its hours showed (naive Bayes, one scene of doubt).
std::vector<std::pair<std::string, double>> occasions_of(const Snapshot& snapshot,
                                                         const std::map<Id, std::set<Id>>& objects_in,
                                                         Id scene) {
  std::vector<std::pair<std::string, double>> occasions;
  double sum = 0;
  const std::set<Id>& own = objects_in.at(scene);
  for (const Occasion& occasion : kOccasions) {
    if (std::string_view(occasion.name) == "supper") continue;  // the hours of dinner
    double scenes = 0, log_likelihood = 0;
    std::map<Id, double> seen;
    for (const auto& [other, objects] : objects_in) {
      const SceneRow* row = snapshot.scene(other);
      if (other == scene || row == nullptr ||
          !occasion.covers(local_hour(row->time, snapshot.store().time_zone_minutes())))
        continue;
      ++scenes;
      for (const Id object : objects) ++seen[object];
    }
    if (scenes == 0) continue;
    for (const Id object : own) log_likelihood += std::log((seen[object] + 0.5) / (scenes + 1));
    occasions.emplace_back(occasion.name, std::exp(log_likelihood));
    sum += occasions.back().second;
  }
  for (auto& [name, probability] : occasions) probability /= sum;
  std::stable_sort(occasions.begin(), occasions.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return occasions;
}

}  // namespace

double read_length(const std::string& text) {
  static const std::map<std::string, double> units = {{"", 1},
                                                      {"m", 1},
                                                      {"metre", 1},
                                                      {"metres", 1},
                                                      {"meter", 1},
                                                      {"meters", 1},
                                                      {"cm", 0.01},
                                                      {"centimetre", 0.01},
                                                      {"centimetres", 0.01},
                                                      {"centimeter", 0.01},
                                                      {"centimeters", 0.01},
                                                      {"mm", 0.001},
                                                      {"millimetres", 0.001},
                                                      {"millimeters", 0.001}};
  double value = 0;
  const auto [rest, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(rest, text.data() + text.size());
  unit.erase(0, unit.find_first_not_of(' '));
  const auto factor = units.find(unit);
  if (failure != std::errc() || factor == units.end() || !std::isfinite(value) || value <= 0)
    throw Error(fmt::format("'{}' is no length", text), {}, "for example 0.5, \"0.5 m\" or \"50 cm\"");
  return value * factor->second;
}

NearAnswer ask(const Store& store, const NearQuestion& question) {
  if (!(question.radius_m > 0) || !std::isfinite(question.radius_m))
    throw Error(fmt::format("a radius of {} m is none", question.radius_m), {}, "give metres above 0");
  const Snapshot snapshot(store, question.as_of);
  NearAnswer answer{.asked = question.subject, .radius_m = question.radius_m};
  locate(snapshot, question.subject, answer);
  for (const BeliefRow& belief : snapshot.beliefs()) {
    if (!belief.position || belief.status == ObjectStatus::gone ||
        object_name(belief.object) == answer.around)
      continue;
    Vector3d away = *belief.position - answer.point;
    if (answer.level) away.z() = 0;
    if (away.norm() <= question.radius_m) answer.objects.push_back({snapshot.state(belief), away.norm()});
  }
  std::stable_sort(answer.objects.begin(), answer.objects.end(),
                   [](const NearObject& a, const NearObject& b) { return a.distance_m < b.distance_m; });
  return answer;
}

TogetherAnswer ask(const Store& store, const TogetherQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  TogetherAnswer answer{.asked = question.subject, .other = question.other};
  const std::vector<Id> objects = snapshot.find_objects(question.subject);
  const std::vector<Id> others = snapshot.find_objects(question.other);
  ScenesOfObjects all = scenes_of_objects(snapshot, objects);
  all.merge(scenes_of_objects(snapshot, others));
  for (const Id object : objects) {
    TogetherObject entry{.object = snapshot.object_ref(object), .scenes = all.at(object).size()};
    for (const Id other : others) {
      if (other == object) continue;
      Company company = company_of(snapshot, all, object, other);
      if (company.together > 0 || !question.other.empty()) entry.company.push_back(std::move(company));
    }
    std::stable_sort(entry.company.begin(), entry.company.end(), [](const Company& a, const Company& b) {
      return a.together != b.together ? a.together > b.together : a.share > b.share;
    });
    answer.objects.push_back(std::move(entry));
  }
  return answer;
}

MissingAnswer ask(const Store& store, const MissingQuestion& question) {
  const Occasion* occasion = occasion_called(question.occasion);
  if (occasion == nullptr && !question.occasion.empty())
    throw Error(fmt::format("'{}' is no occasion", question.occasion), {},
                "occasions: breakfast, lunch, tea, dinner, supper");
  const Snapshot snapshot(store, question.as_of);
  MissingAnswer answer{.asked = question.place, .occasion = question.occasion};
  const ScenesOfObjects all = scenes_of_objects(snapshot, snapshot.find_objects(""));
  for (const PlaceRow& place :
       question.place.empty() ? snapshot.places() : snapshot.find_places(question.place))
    answer.places.push_back(missing_at(snapshot, all, place, occasion));
  return answer;
}

KindAnswer ask(const Store& store, const KindQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  if (snapshot.scenes().empty()) throw Error("the memory has no scene yet");
  const Id id = question.scene.value_or(snapshot.scenes().back().id);
  const SceneRow* scene = snapshot.scene(id);
  if (scene == nullptr)
    throw Error(fmt::format("there is no scene {}", id), {}, "loci-memory scenes lists them");
  std::map<Id, std::set<Id>> objects_in;
  std::set<std::string> places;
  for (const SceneRow& row : snapshot.scenes()) objects_in[row.id] = {};
  for (const auto& [object, scenes] : scenes_of_objects(snapshot, snapshot.find_objects("")))
    for (const auto& [other, place] : scenes) {
      objects_in[other].insert(object);
      if (other == id && place) places.insert(snapshot.place_ref(place)->name);
    }
  KindAnswer answer{.scene = snapshot.scene_ref(*scene), .places = {places.begin(), places.end()}};
  const std::set<Id>& own = objects_in.at(id);
  for (const Id object : own) answer.objects.push_back(snapshot.object_ref(object));
  if (own.empty()) return answer;
  answer.occasions = occasions_of(snapshot, objects_in, id);
  for (const auto& [other, objects] : objects_in) {
    const auto common = static_cast<double>(
        std::count_if(own.begin(), own.end(), [&](Id object) { return objects.contains(object); }));
    if (other == id || common == 0) continue;
    answer.like.push_back(
        {*snapshot.scene_ref(other), common / (static_cast<double>(own.size() + objects.size()) - common)});
  }
  std::stable_sort(answer.like.begin(), answer.like.end(),
                   [](const LikeScene& a, const LikeScene& b) { return a.likeness > b.likeness; });
  if (answer.like.size() > kMaxAlike) answer.like.resize(kMaxAlike);
  return answer;
}

}  // namespace loci::memory
