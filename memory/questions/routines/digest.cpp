#include "memory/questions/routines/digest.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/events.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/routines/routines.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

constexpr TimeNs kMissingFor = 7 * 24 * kHour;  ///< what is gone for longer is not reported
constexpr size_t kMinUsualSightings = 3;        ///< fewer are not a habit
constexpr double kMinUsualShare = 0.5;          ///< of its sightings
constexpr double kMinPresent = 0.5;             ///< probability that it is where it is believed to be

std::vector<ObjectBelief> missing_objects(const Snapshot& snapshot, TimeNs since) {
  std::vector<ObjectBelief> missing;
  for (const BeliefRow& row : snapshot.beliefs()) {
    if (row.status != ObjectStatus::gone) continue;
    ObjectBelief belief = snapshot.object_belief(row);
    if (belief.last_seen && belief.last_seen->time >= since && !seen_once(belief))
      missing.push_back(std::move(belief));
  }
  std::ranges::stable_sort(missing, std::greater(), [](const ObjectBelief& belief) {
    return belief.last_seen ? belief.last_seen->time : 0;
  });
  return missing;
}

}  // namespace

std::vector<MisplacedObject> misplaced_objects(const Store& store, const AsOf& as_of) {
  std::vector<MisplacedObject> misplaced;
  for (const UsualObject& object : ask(store, UsualQuestion{{}, as_of, {}}).objects) {
    if (object.places.empty() || !object.now.place || object.now.status == ObjectStatus::gone) continue;
    const UsualPlace& usual = object.places.front();
    if (usual.place.id == object.now.place->id || usual.sightings < kMinUsualSightings ||
        usual.share < kMinUsualShare || object.now.probability < kMinPresent)
      continue;
    misplaced.push_back({object.now, usual.place, usual.sightings, usual.share});
  }
  return misplaced;
}

DigestAnswer ask(const Store& store, const DigestQuestion& question) {
  const std::optional<SceneRow> last = store.latest_scene(question.as_of);
  if (!last) throw store.error("there are no scenes yet");
  const TimeReader times(store);
  const TimeNs moment = question.day.empty() ? last->time : times.read(question.day).first;
  const std::string day = store.time_zone().format(moment).substr(0, 10);
  const auto [from, to] = times.read(day);
  AsOf as_of = question.as_of;
  as_of.at = std::min(to, as_of.at.value_or(last->time));
  const Snapshot snapshot(store, as_of);
  DigestAnswer answer{.from = from,
                      .to = to,
                      .day = day,
                      .scenes = store.scenes(as_of, from, to).size(),
                      .changes = ask(store, ChangesQuestion{from, to, {}, {}, as_of, {}}).changes,
                      .misplaced = {},
                      .missing = missing_objects(snapshot, from - kMissingFor)};
  if (!snapshot.beliefs().empty()) answer.misplaced = misplaced_objects(store, as_of);
  return answer;
}

std::string to_text(const MisplacedObject& object) {
  return fmt::format("{} is {}, usually {} ({} of its sightings)", to_text(object.now.object),
                     place_text(*object.now.place), place_text(object.usual), percent(object.share));
}

std::string to_text(const DigestAnswer& answer, const TimeWriter& times) {
  if (answer.scenes == 0) return fmt::format("Nothing was observed on {}.\n", answer.day);
  std::string text = fmt::format("{}: {}, {}; {} out of the usual place, {} missing.\n", answer.day,
                                 counted(answer.scenes, "scene"), counted(answer.changes.size(), "change"),
                                 counted(answer.misplaced.size(), "object"), answer.missing.size());
  const auto list = [&text](const char* heading, const auto& items, const auto& line) {
    if (!items.empty()) text += fmt::format("\n{}:\n", heading);
    for (const auto& item : items) text += fmt::format("  {}\n", line(item));
  };
  list("Changed", answer.changes, [&](const Change& change) {
    return fmt::format("{}  {}", when_text(change, times), to_text(change));
  });
  list("Out of the usual place", answer.misplaced,
       [](const MisplacedObject& object) { return to_text(object); });
  list("Missing", answer.missing, [&](const ObjectBelief& belief) { return belief_text(belief, times); });
  return text;
}

namespace {

const Record<MisplacedObject>& misplaced_record() {
  static const auto record = Record<MisplacedObject>("MisplacedObject")
                                 .with(&MisplacedObject::now, belief_record())
                                 .value("usually", &MisplacedObject::usual)
                                 .value("share", &MisplacedObject::share);
  return record;
}

const Record<DigestAnswer>& digest_record() {
  static const auto record = Record<DigestAnswer>("DigestAnswer")
                                 .value("day", &DigestAnswer::day)
                                 .time("from", &DigestAnswer::from)
                                 .time("to", &DigestAnswer::to)
                                 .value("scenes", &DigestAnswer::scenes)
                                 .record("changes", &DigestAnswer::changes, change_record())
                                 .record("out_of_place", &DigestAnswer::misplaced, misplaced_record())
                                 .record("missing", &DigestAnswer::missing, belief_record());
  return record;
}

}  // namespace

Json to_json(const DigestAnswer& answer) {
  return digest_record().json(answer);
}

std::vector<Question> digest_questions() {
  return {{.name = "digest",
           .description = "A day: what changed, what is out of its usual place, what is missing",
           .parameters = {{.name = "day",
                           .type = ParameterType::time,
                           .help = "\"yesterday\", \"2026-05-01\", or any time of it",
                           .default_text = "the day of the last scene"}},
           .examples = {"", "--day 2026-05-01 --json"},
           .answer = format::schema_by<digest_record>,
           .run = [](const Arguments& given) -> Answer {
             return ask(given.store(), DigestQuestion{given.text("day"), given.as_of()});
           },
           .time = SentenceTime::at,
           .sentences = {{"order|bare|what: digest|summary [give|show|tell]", Asks::summary,
                          "Give me a digest of the day."},
                         {"what: outofplace [thing|which]", Asks::objects, "What is out of its usual place?"},
                         {"yes|bare: thing outofplace", Asks::exists, "Is anything out of place?"},
                         {"yes|bare: everything asusual", Asks::all, "Is everything in its usual place?"}},
           .of_moment = false}};
}

}  // namespace loci::memory
