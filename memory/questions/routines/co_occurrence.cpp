#include "memory/questions/routines/co_occurrence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/routines/routines.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/visits.h"

namespace loci::memory {

using namespace format;

namespace {

constexpr size_t kMaxSimilar = 5;

struct PlaceVisit {
  TimeNs from = 0, to = 0;
  double fraction = 0;        ///< of the place that its scenes saw together, where no single one saw enough
  std::set<Id> objects = {};  ///< seen at the place
};

/// Per object, the scenes in which it was seen, with the place.
using ScenesOfObjects = std::map<Id, std::map<Id, std::optional<Id>>>;

ScenesOfObjects scenes_of_objects(const Snapshot& snapshot, const std::vector<Id>& objects) {
  ScenesOfObjects all;
  for (const Id object : objects) {
    auto& scenes = all[object];
    for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of()))
      scenes[sighting.association.scene] = sighting.observation.place;
  }
  return all;
}

CoOccurrence co_occurrence_of(const Snapshot& snapshot, const ScenesOfObjects& all, Id object, Id other) {
  CoOccurrence both{.object = snapshot.object_ref(other), .scenes = all.at(other).size()};
  for (const auto& [scene, place] : all.at(object)) {
    const auto found = all.at(other).find(scene);
    if (found == all.at(other).end()) continue;
    ++both.together;
    if (place && found->second == place) ++both.same_place;
    const auto ref = snapshot.scene_ref(scene);
    if (ref && (!both.last || both.last->time <= ref->time)) both.last = ref;
  }
  const size_t either = all.at(object).size() + both.scenes - both.together;
  if (either > 0) both.share = static_cast<double>(both.together) / static_cast<double>(either);
  return both;
}

std::vector<PlaceVisit> visits_of(const Snapshot& snapshot, const ScenesOfObjects& all,
                                  const PlaceRow& visited) {
  const Id place = visited.id;
  std::map<Id, std::set<Id>> there;
  for (const auto& [object, scenes] : all)
    for (const auto& [scene, at] : scenes)
      if (at == place) there[scene].insert(object);
  std::map<Id, double> fractions;
  for (const VisibilityRow& row : snapshot.store().visibility_of_place(place))
    fractions[row.scene] = row.fraction.value_or(0);
  std::vector<PlaceVisit> visits;
  for (const SceneRow& scene : snapshot.scenes()) {
    const double fraction = fractions.contains(scene.id) ? fractions[scene.id] : 0;
    const auto seen = there.find(scene.id);
    if (fraction <= 0 && seen == there.end()) continue;
    if (visits.empty() || scene.time - visits.back().to > kVisitGap)
      visits.push_back({.from = scene.time, .to = scene.time});
    PlaceVisit& visit = visits.back();
    visit.to = scene.time;
    visit.fraction = std::max(visit.fraction, fraction);
    if (seen != there.end()) visit.objects.insert(seen->second.begin(), seen->second.end());
  }
  for (PlaceVisit& visit : visits)
    if (visit.fraction > 0)
      visit.fraction = fraction_of_visit(snapshot, visited, visit.from, visit.to, visit.fraction);
  return visits;
}

/// Keeps the visits that saw enough, at these hours, and showed one of the objects that are there now.
std::vector<PlaceVisit> comparable(std::vector<PlaceVisit> visits, const std::set<Id>& present,
                                   const Occasion* occasion, const TimeZone& zone) {
  std::erase_if(visits, [&](const PlaceVisit& visit) {
    const bool shares = present.empty() || std::ranges::any_of(present, [&](Id object) {
                          return visit.objects.contains(object);
                        });
    return !shares || visit.objects.empty() || (visit.fraction > 0 && visit.fraction < kMinSeenFraction) ||
           (occasion != nullptr && !occasion->covers(local_hour(visit.from, zone)));
  });
  return visits;
}

/// `meant`: the objects asked about; empty = all.
MissingPlace missing_at(const Snapshot& snapshot, const ScenesOfObjects& all, const PlaceRow& row,
                        const Occasion* occasion, const std::set<Id>& meant) {
  MissingPlace result{.place = {row.id, row.name, row.container}};
  std::set<Id> present;
  for (const BeliefRow& belief : snapshot.beliefs())
    if (is_believed_at(belief, row.id)) present.insert(belief.object);
  const std::vector<PlaceVisit> visits =
      comparable(visits_of(snapshot, all, row), present, occasion, snapshot.store().time_zone());
  result.visits = visits.size();
  for (const BeliefRow& belief : snapshot.beliefs()) {
    if (!meant.empty() && !meant.contains(belief.object)) continue;
    ExpectedObject expected{.now = snapshot.object_belief(belief)};
    expected.visits = static_cast<size_t>(std::ranges::count_if(
        visits, [&](const PlaceVisit& visit) { return visit.objects.contains(belief.object); }));
    if (!visits.empty())
      expected.share = static_cast<double>(expected.visits) / static_cast<double>(visits.size());
    if (present.contains(belief.object))
      result.present.push_back(std::move(expected));
    else if (expected.visits > 0 && expected.share >= 0.5)
      result.missing.push_back(std::move(expected));
    else if (!meant.empty())
      result.seldom.push_back(std::move(expected));
  }
  for (auto* list : {&result.present, &result.missing})
    std::ranges::stable_sort(*list, std::ranges::greater(), &ExpectedObject::visits);
  return result;
}

using ObjectsOfScenes = std::map<Id, std::set<Id>>;

/// How probable each occasion is, by what other scenes at its hours showed (naive Bayes with add-half
/// smoothing).
std::vector<std::pair<std::string, double>> occasions_of(const Snapshot& snapshot,
                                                         const ObjectsOfScenes& objects_in, Id scene) {
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
          !occasion.covers(local_hour(row->time, snapshot.store().time_zone())))
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
  std::ranges::stable_sort(occasions, std::ranges::greater(), &std::pair<std::string, double>::second);
  return occasions;
}

std::vector<SimilarScene> similar_scenes(const Snapshot& snapshot, const ObjectsOfScenes& objects_in,
                                         Id scene) {
  std::vector<SimilarScene> similar;
  const std::set<Id>& own = objects_in.at(scene);
  for (const auto& entry : objects_in) {
    const Id other = entry.first;
    const std::set<Id>& objects = entry.second;
    const auto common =
        static_cast<double>(std::ranges::count_if(own, [&](Id object) { return objects.contains(object); }));
    if (other == scene || common == 0) continue;
    similar.push_back(
        {*snapshot.scene_ref(other), common / (static_cast<double>(own.size() + objects.size()) - common)});
  }
  std::ranges::stable_sort(similar, std::ranges::greater(), &SimilarScene::similarity);
  if (similar.size() > kMaxSimilar) similar.resize(kMaxSimilar);
  return similar;
}

const Record<ExpectedObject>& expected_record() {
  static const auto record = Record<ExpectedObject>("ExpectedObject")
                                 .with(&ExpectedObject::now, belief_record())
                                 .value("visits_there", &ExpectedObject::visits)
                                 .value("share", &ExpectedObject::share);
  return record;
}

}  // namespace

CoOccurrenceAnswer ask(const Store& store, const CoOccurrenceQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  CoOccurrenceAnswer answer{.asked = question.subject, .other = question.other};
  const std::vector<Id> objects = snapshot.find_objects(question.subject);
  const std::vector<Id> others = snapshot.find_objects(question.other);
  ScenesOfObjects all = scenes_of_objects(snapshot, objects);
  all.merge(scenes_of_objects(snapshot, others));
  for (const Id object : objects) {
    CoOccurrences entry{.object = snapshot.object_ref(object), .scenes = all.at(object).size()};
    for (const Id other : others) {
      if (other == object) continue;
      CoOccurrence both = co_occurrence_of(snapshot, all, object, other);
      if (both.together > 0 || !question.other.empty()) entry.others.push_back(std::move(both));
    }
    std::ranges::stable_sort(entry.others, [](const CoOccurrence& a, const CoOccurrence& b) {
      return a.together != b.together ? a.together > b.together : a.share > b.share;
    });
    answer.objects.push_back(std::move(entry));
  }
  return answer;
}

std::string to_text(const CoOccurrenceAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const CoOccurrences& object : answer.objects) {
    const std::string name = to_text(object.object);
    if (object.others.empty()) {
      lines.push_back(fmt::format("{} was never seen with anything else.", name));
      continue;
    }
    lines.push_back(fmt::format("{} was seen in {}, together with", name, counted(object.scenes, "scene")));
    for (const CoOccurrence& other : object.others)
      lines.push_back(
          fmt::format("  {}: in {} ({} at one place); {} of the scenes with either{}", to_text(other.object),
                      counted(other.together, "scene"), other.same_place, percent(other.share),
                      other.last ? fmt::format(", last at {}", times.text(other.last->time)) : ""));
  }
  return lines_text(lines);
}

namespace {

const Record<CoOccurrence>& other_record() {
  static const auto record = Record<CoOccurrence>("CoOccurrence")
                                 .with(&CoOccurrence::object, object_record())
                                 .value("scenes", &CoOccurrence::scenes)
                                 .value("together", &CoOccurrence::together)
                                 .value("same_place", &CoOccurrence::same_place)
                                 .value("share", &CoOccurrence::share)
                                 .record("last", &CoOccurrence::last, scene_record());
  return record;
}

const Record<CoOccurrences>& co_occurrences_record() {
  static const auto record = Record<CoOccurrences>("CoOccurrences")
                                 .with(&CoOccurrences::object, object_record())
                                 .value("scenes", &CoOccurrences::scenes)
                                 .record("together", &CoOccurrences::others, other_record());
  return record;
}

const Record<CoOccurrenceAnswer>& co_occurrence_record() {
  static const auto record =
      Record<CoOccurrenceAnswer>("CoOccurrenceAnswer")
          .value("asked", &CoOccurrenceAnswer::asked)
          .record("objects", &CoOccurrenceAnswer::objects, co_occurrences_record())
          .value("other", [](const CoOccurrenceAnswer& answer) { return unless_empty(answer.other); });
  return record;
}

}  // namespace

Json to_json(const CoOccurrenceAnswer& answer) {
  return co_occurrence_record().json(answer);
}

MissingAnswer ask(const Store& store, const MissingQuestion& question) {
  const Occasion* occasion = find_occasion(question.occasion);
  if (occasion == nullptr && !question.occasion.empty())
    throw Error(fmt::format("'{}' is no occasion", question.occasion), {},
                "occasions: breakfast, lunch, tea, dinner, supper");
  const Snapshot snapshot(store, question.as_of);
  MissingAnswer answer{.asked = question.place, .occasion = question.occasion, .subject = question.subject};
  std::set<Id> meant;
  if (!question.subject.empty())
    for (const Id object : snapshot.find_objects(question.subject)) meant.insert(object);
  const ScenesOfObjects all = scenes_of_objects(snapshot, snapshot.find_objects(""));
  for (const PlaceRow& place :
       question.place.empty() ? snapshot.places() : snapshot.find_places(question.place))
    answer.places.push_back(missing_at(snapshot, all, place, occasion, meant));
  return answer;
}

std::string reason_of(const MissingPlace& place) {
  const std::string visits = counted(place.visits, "visit");
  const auto in_visits = [&](const ExpectedObject& object) {
    return fmt::format("it was there in {} of {}", object.visits, visits);
  };
  if (place.visits == 0) return "no earlier visit saw anything like this";
  if (place.missing.size() + place.present.size() + place.seldom.size() == 1) {
    if (!place.missing.empty()) return in_visits(place.missing[0]) + " and is not there now";
    return place.present.empty() ? in_visits(place.seldom[0]) + ", less than half" : "it is there now";
  }
  const auto usual = std::ranges::count_if(place.present, [](const auto& one) { return one.share >= 0.5; });
  if (place.missing.empty())
    return usual == 0 ? fmt::format("nothing was there in half of {}", visits)
                      : fmt::format("what was there in at least half of {} is there now", visits);
  return fmt::format("what was there in at least half of {} is not there now", visits);
}

std::string to_text(const MissingAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  const std::string hours = answer.occasion.empty() ? "" : " at the hours of " + answer.occasion;
  for (const MissingPlace& place : answer.places) {
    const std::string where = place_text(place.place);
    if (place.visits == 0) {
      lines.push_back(
          fmt::format("What belongs {}{} is not known: no visit saw anything like this.", where, hours));
      continue;
    }
    const std::string visits = counted(place.visits, "visit") + hours;
    lines.push_back(place.missing.empty()
                        ? fmt::format("Nothing is missing {}, by {}: {}.", where, visits, reason_of(place))
                        : fmt::format("Missing {}, by {}:", where, visits));
    for (const ExpectedObject& missing : place.missing)
      lines.push_back(
          fmt::format("  there in {} of {}: {}", missing.visits, visits, belief_text(missing.now, times)));
    for (const ExpectedObject& seldom : place.seldom)
      lines.push_back(fmt::format("  not usual: {}, there in {} of {}", to_text(seldom.now.object),
                                  seldom.visits, visits));
    for (const ExpectedObject& present : place.present)
      lines.push_back(fmt::format("  present: {}, there in {} of {}", to_text(present.now.object),
                                  present.visits, visits));
  }
  return lines_text(lines);
}

namespace {

const Record<MissingPlace>& missing_place_record() {
  static const auto record = Record<MissingPlace>("MissingPlace")
                                 .value("place", &MissingPlace::place)
                                 .value("visits", &MissingPlace::visits)
                                 .value("reason", [](const MissingPlace& place) { return reason_of(place); })
                                 .record("missing", &MissingPlace::missing, expected_record())
                                 .record("present", &MissingPlace::present, expected_record());
  return record;
}

const Record<MissingAnswer>& missing_record() {
  static const auto record =
      Record<MissingAnswer>("MissingAnswer")
          .value("asked", &MissingAnswer::asked)
          .record("places", &MissingAnswer::places, missing_place_record())
          .value("occasion", [](const MissingAnswer& answer) { return unless_empty(answer.occasion); });
  return record;
}

}  // namespace

Json to_json(const MissingAnswer& answer) {
  return missing_record().json(answer);
}

SceneTypeAnswer ask(const Store& store, const SceneTypeQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  if (snapshot.scenes().empty()) throw Error("the memory has no scene yet");
  const Id id = question.scene.value_or(snapshot.scenes().back().id);
  const SceneRow* scene = snapshot.scene(id);
  if (scene == nullptr)
    throw Error(fmt::format("there is no scene {}", id), {}, "loci-memory scenes lists them");
  ObjectsOfScenes objects_in;
  std::set<std::string> places;
  for (const SceneRow& row : snapshot.scenes()) objects_in[row.id] = {};
  for (const auto& [object, scenes] : scenes_of_objects(snapshot, snapshot.find_objects("")))
    for (const auto& [other, place] : scenes) {
      objects_in[other].insert(object);
      if (other == id && place) places.insert(snapshot.place_ref(place)->name);
    }
  SceneTypeAnswer answer{.scene = snapshot.scene_ref(*scene), .places = {places.begin(), places.end()}};
  for (const Id object : objects_in.at(id)) answer.objects.push_back(snapshot.object_ref(object));
  if (answer.objects.empty()) return answer;
  answer.occasions = occasions_of(snapshot, objects_in, id);
  answer.similar = similar_scenes(snapshot, objects_in, id);
  return answer;
}

std::string to_text(const SceneTypeAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> names;
  for (const ObjectRef& object : answer.objects) names.push_back(to_text(object));
  std::vector<std::string> lines = {
      fmt::format("The scene at {}: {}{}.", times.text(answer.scene.time),
                  names.empty() ? "no object" : fmt::format("{}", fmt::join(names, ", ")),
                  answer.places.empty() ? "" : fmt::format(", at {}", fmt::join(answer.places, ", ")))};
  for (const auto& [name, probability] : answer.occasions)
    lines.push_back(fmt::format("  as at {}: {}", name, percent(probability)));
  for (const SimilarScene& similar : answer.similar)
    lines.push_back(fmt::format("  similar to that at {} ({}): {} of the objects in common",
                                times.text(similar.scene.time), scene_text(similar.scene),
                                percent(similar.similarity)));
  return lines_text(lines);
}

namespace {

const Record<SimilarScene>& similar_scene_record() {
  static const auto record = Record<SimilarScene>("SimilarScene")
                                 .record("scene", &SimilarScene::scene, scene_record())
                                 .value("similarity", &SimilarScene::similarity);
  return record;
}

const Record<SceneTypeAnswer>& scene_type_record() {
  static const auto record = Record<SceneTypeAnswer>("SceneTypeAnswer")
                                 .record("scene", &SceneTypeAnswer::scene, scene_record())
                                 .value("places", &SceneTypeAnswer::places)
                                 .record("objects", &SceneTypeAnswer::objects, object_record())
                                 .record("similar", &SceneTypeAnswer::similar, similar_scene_record())
                                 .value("occasions", &SceneTypeAnswer::occasions);
  return record;
}

}  // namespace

Json to_json(const SceneTypeAnswer& answer) {
  return scene_type_record().json(answer);
}

std::vector<Question> co_occurrence_questions() {
  Parameter place = place_parameter();
  place.required = false;
  place.default_text = "every place";
  return {
      {.name = "co-occurrence",
       .description = "How often objects are seen together",
       .parameters = {object_parameter(),
                      {.name = "with",
                       .type = ParameterType::object,
                       .help = "The other object",
                       .default_text = "all others"}},
       .examples = {"red", "red --with green --json"},
       .answer = format::schema_by<co_occurrence_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(),
                    CoOccurrenceQuestion{given.text("object"), given.text("with"), given.as_of()});
       },
       .time = SentenceTime::none,
       .sentences = {{"howoften: together <object> and<with> [see|stand|move|find]", Asks::number,
                      "How often are the red cup and the plate seen together?"},
                     {"yes: together do|did|was|been|see|usually <object> and<with> [stand|move|find]",
                      Asks::verdict},
                     {"what: see|move|find|stand|together|go|belong with<object> [usually|thing|together]",
                      Asks::objects, "What is used together with the tea cup?"}},
       .of_moment = false},
      {.name = "missing",
       .description = "What is missing at a place, by what its earlier visits showed",
       .parameters = {place,
                      only_object_parameter(),
                      {.name = "occasion",
                       .help = "Only visits at its hours",
                       .default_text = "any",
                       .choices = {"breakfast", "lunch", "tea", "dinner", "supper"}}},
       .examples = {"table_1", "table_1 --occasion breakfast --json"},
       .answer = format::schema_by<missing_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), MissingQuestion{given.text("place"), given.text("occasion"), given.as_of(),
                                                   given.text("object")});
       },
       .sentences = {{"what: miss at<place> for<occasion> [thing]", Asks::objects,
                      "What is missing on the table for breakfast?"},
                     {"what: miss from<place> for<occasion> [thing]", Asks::objects},
                     {"what: miss [thing] -did -have", Asks::objects},
                     {"what: miss at<place> [thing]", Asks::objects},
                     {"what: miss from<place> [thing]", Asks::objects},
                     {"yes|bare: miss thing", Asks::exists, "Is anything missing?"},
                     {"yes|bare: miss thing at<place>", Asks::exists},
                     {"yes|bare: miss thing from<place>", Asks::exists}}},
      {.name = "scene-type",
       .group = QuestionGroup::inspect,
       .description = "The scenes and the occasion that a scene is most similar to",
       .parameters = {{.name = "scene",
                       .type = ParameterType::number,
                       .help = "Number of the scene",
                       .default_text = "the last"}},
       .examples = {"", "--scene 3 --json"},
       .answer = format::schema_by<scene_type_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), SceneTypeQuestion{given.number("scene"), given.as_of()});
       },
       .sentences = {{"what: scene|situation|meal|occasion <any> [of|kind]", Asks::summary,
                      "What kind of scene is this?"}},
       .of_moment = false},
  };
}

}  // namespace loci::memory
