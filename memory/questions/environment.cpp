#include "memory/questions/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mapping/base/math/math.h"
#include "mapping/base/text/text.h"
#include "memory/questions/names/related_words.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

/// "45 cm" or "90 degrees".
std::string travel_text(const PartMotion& motion, double position) {
  return motion.type == mapping::JointType::prismatic
             ? fmt::format("{:.0f} cm", 100 * std::abs(position))
             : fmt::format("{:.0f} degrees", std::abs(position) / kDegree);
}

std::string motion_text(const PartMotion& motion, const TimeWriter& times) {
  const double range = std::max(std::abs(motion.lower), std::abs(motion.upper));
  std::string text =
      fmt::format("{} up to {}", motion.type == mapping::JointType::prismatic ? "slides" : "turns",
                  travel_text(motion, range));
  if (motion.position && motion.seen)
    text += fmt::format(
        "; {} as of {} ({})",
        motion.is_open(*motion.position) ? "open by " + travel_text(motion, *motion.position) : "closed",
        times.text(motion.seen->time), scene_text(*motion.seen));
  if (motion.next_position && motion.next_seen)
    text += fmt::format("; {} at the next look, {} ({})",
                        motion.is_open(*motion.next_position) ? "open" : "closed",
                        times.text(motion.next_seen->time), scene_text(*motion.next_seen));
  if (motion.opened) text += fmt::format("; last opened by {}", times.text(motion.opened->time));
  if (motion.closed) text += fmt::format("; last closed by {}", times.text(motion.closed->time));
  if (!motion.opened && !motion.closed) text += "; never seen to move";
  return text;
}

/// "door_1 (door, fridge)".
std::string title(const EnvironmentPart& part) {
  return fmt::format("{} ({}{}{})", part.name, part.class_name, part.aliases.empty() ? "" : ", ",
                     fmt::join(part.aliases, ", "));
}

std::string part_text(const EnvironmentPart& part, const TimeWriter& times) {
  std::string text = part.motion ? motion_text(*part.motion, times) : "";
  if (!part.place) return text;
  if (part.motion) text += "; ";
  if (part.height) text += fmt::format("{:.2f} m high, ", *part.height);
  const std::string objects = part.objects == 0 ? "nothing" : counted(part.objects, "object");
  const char* preposition = part.place->container ? "in" : "on";
  return text + (part.last_view ? fmt::format("{} {} it, last looked at {}", objects, preposition,
                                              times.text(part.last_view->time))
                                : fmt::format("{} known {} it, never looked at", objects, preposition));
}

std::optional<TimeNs> time_of_change(const std::optional<Change>& change) {
  return change ? std::optional(change->time) : std::nullopt;
}

const Record<PartMotion>& motion_record() {
  static const auto record =
      Record<PartMotion>("PartMotion")
          .value("name", &PartMotion::joint)
          .value("type", [](const PartMotion& motion) { return joint_type_name(motion.type); })
          .value("lower", &PartMotion::lower)
          .value("upper", &PartMotion::upper)
          .value("name_in_map",
                 [](const PartMotion& motion) {
                   return motion.map_joint != motion.joint ? std::optional(motion.map_joint) : std::nullopt;
                 })
          .value("position", &PartMotion::position)
          .value("open", &PartMotion::open)
          .record("seen", &PartMotion::seen, scene_record())
          .value("next_position", &PartMotion::next_position)
          .record("next_seen", &PartMotion::next_seen, scene_record())
          .time("last_opened", [](const PartMotion& motion) { return time_of_change(motion.opened); })
          .time("last_closed", [](const PartMotion& motion) { return time_of_change(motion.closed); });
  return record;
}

const Record<EnvironmentPart>& part_record() {
  static const auto record =
      Record<EnvironmentPart>("EnvironmentPart")
          .value("name", &EnvironmentPart::name)
          .value("class", &EnvironmentPart::class_name)
          .value("name_in_map",
                 [](const EnvironmentPart& part) {
                   return part.map_name != part.name ? std::optional(part.map_name) : std::nullopt;
                 })
          .value("aliases", [](const EnvironmentPart& part) { return unless_empty(part.aliases); })
          .value("position", &EnvironmentPart::position)
          .value("size", &EnvironmentPart::size)
          .record("joint", &EnvironmentPart::motion, motion_record())
          .value("place", &EnvironmentPart::place)
          .value("objects",
                 [](const EnvironmentPart& part) {
                   return part.place ? std::optional(part.objects) : std::nullopt;
                 })
          .value("height", &EnvironmentPart::height)
          .record("last_look", &EnvironmentPart::last_view, scene_record());
  return record;
}

}  // namespace

namespace {

/// Whether a part did not open in the period; unset where no look of it showed the part.
std::optional<bool> is_unopened(const Store& store, const PartMotion& motion,
                                const std::set<std::string>& opened, const OpensQuestion& question) {
  if (opened.contains(motion.map_joint) || motion.open() == true) return false;
  const bool seen = is_joint_seen(store, motion.map_joint, question.as_of, question.from, question.to);
  return seen ? std::optional(true) : std::nullopt;
}

}  // namespace

RoomAnswer ask(const Store& store, const RoomQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  RoomAnswer answer{.asked = question.part,
                    .state = question.state,
                    .map = map_name(snapshot),
                    .parts = find_parts(snapshot, question.part)};
  add_states(snapshot, answer.parts);
  if (!question.state.empty())
    std::erase_if(answer.parts, [&](const EnvironmentPart& part) {
      return !part.place || !part.last_view || (part.objects == 0) != (question.state == "empty");
    });
  for (const EnvironmentPart& part : answer.parts) ++answer.classes[part.class_name];
  return answer;
}

namespace {

/// "cupboards", "any cabinet".
bool is_cupboard(const std::string& asked) {
  const std::string word = singular_of(asked.substr(asked.rfind(' ') + 1));
  return word == "cabinet" || furniture_called(word) == "cabinet";
}

}  // namespace

OpensAnswer ask(const Store& store, const OpensQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  OpensAnswer answer{
      .asked = question.part, .state = question.state, .parts = find_parts(snapshot, question.part)};
  const auto keep_moving = [&] {
    std::erase_if(answer.parts, [](const EnvironmentPart& part) { return !part.motion; });
  };
  keep_moving();
  if (answer.parts.empty() && is_cupboard(question.part)) {  // what opens of it are doors
    answer.parts = find_parts(snapshot, "door");
    keep_moving();
  }
  add_states(snapshot, answer.parts);
  if (question.state.empty()) return answer;
  std::set<std::string> opened;
  for (const EventRow& event : store.events(question.as_of, question.from, question.to))
    if (event.joint && is_opening(snapshot.change(event))) opened.insert(*event.joint);
  for (EnvironmentPart& part : std::exchange(answer.parts, {})) {
    const std::optional<bool> open = part.motion->open();
    const std::optional<bool> is_so = question.state == "unopened"
                                          ? is_unopened(store, *part.motion, opened, question)
                                      : open ? std::optional(*open == (question.state == "open"))
                                             : std::nullopt;
    (!is_so ? answer.not_observed : *is_so ? answer.parts : answer.others).push_back(std::move(part));
  }
  return answer;
}

std::string to_text(const RoomAnswer& answer, const TimeWriter& times) {
  if (answer.parts.empty())
    return answer.state.empty() ? "No map, and no place was found yet.\n"
                                : fmt::format("No place that was looked at is {}.\n", answer.state);
  std::vector<std::string> counts;
  for (const auto& [name, count] : answer.classes) counts.push_back(counted(count, name));
  std::vector<std::string> lines = {fmt::format(
      "{}: {}", answer.map.empty() ? "No map; places that were found" : answer.map, fmt::join(counts, ", "))};
  for (const EnvironmentPart& part : answer.parts) {
    const std::string text = part_text(part, times);
    lines.push_back(fmt::format("  {}{}{}", title(part), text.empty() ? "" : ": ", text));
  }
  return lines_text(lines);
}

std::string to_text(const OpensAnswer& answer, const TimeWriter& times) {
  if (answer.parts.empty() && answer.state.empty())
    return answer.asked.empty() ? "Nothing is known to open: the map has no joints.\n"
                                : fmt::format("'{}' has no part that moves.\n", answer.asked);
  std::vector<std::string> lines;
  for (const EnvironmentPart& part : answer.parts)
    lines.push_back(fmt::format("{} {}.", title(part), motion_text(*part.motion, times)));
  if (lines.empty()) lines.push_back(fmt::format("None is {}.", answer.state));
  for (const EnvironmentPart& part : answer.not_observed)
    lines.push_back(fmt::format("Not observed: {} {}.", title(part), motion_text(*part.motion, times)));
  return lines_text(lines);
}

namespace {

const Record<RoomAnswer>& room_record() {
  static const auto record =
      Record<RoomAnswer>("RoomAnswer")
          .value("asked", &RoomAnswer::asked)
          .value("state", [](const RoomAnswer& answer) { return unless_empty(answer.state); })
          .value("classes", &RoomAnswer::classes)
          .record("parts", &RoomAnswer::parts, part_record())
          .value("map", [](const RoomAnswer& answer) { return unless_empty(answer.map); });
  return record;
}

}  // namespace

Json to_json(const RoomAnswer& answer) {
  return room_record().json(answer);
}

namespace {

const Record<OpensAnswer>& opens_record() {
  static const auto record = Record<OpensAnswer>("OpensAnswer")
                                 .value("asked", &OpensAnswer::asked)
                                 .record("parts", &OpensAnswer::parts, part_record())
                                 .record("not_observed", &OpensAnswer::not_observed, part_record());
  return record;
}

}  // namespace

Json to_json(const OpensAnswer& answer) {
  return opens_record().json(answer);
}

std::vector<Question> environment_questions() {
  const Parameter part = {.name = "part",
                          .type = ParameterType::part,
                          .help = "Only these: a link of the map, a place, an alias, a class",
                          .positional = true,
                          .default_text = "all"};
  const std::map<std::string, std::string> are_open = {{"state", "open"}}, are_closed = {{"state", "closed"}},
                                           unopened = {{"state", "unopened"}}, empty = {{"state", "empty"}},
                                           used = {{"state", "in use"}};
  return {
      {.name = "room",
       .group = QuestionGroup::inspect,
       .description = "The furniture: what opens, and what is where",
       .parameters = {part,
                      {.name = "state",
                       .help = "Only places that are so",
                       .default_text = "any",
                       .choices = {"empty", "in use"}}},
       .examples = {"", "drawers --at 17:45 --json"},
       .answer = format::schema_by<room_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), RoomQuestion{given.text("part"), given.as_of(), given.text("state")});
       },
       .sentences = {{"what: room consist|contain|have|made [of|thing]", Asks::summary,
                      "What does this room consist of?"},
                     {"order: describe|show room"},
                     {"howmany: <part> [contain|know]", Asks::number, "How many drawers are there?"},
                     {"howmany: <part> room [contain]", Asks::number},
                     {"what: which<part> [room|know]", Asks::objects, "Which drawers are there?"},
                     {"what: furniture [know|room]"},
                     {"where: <part> [room|location]", Asks::place, "Where is the table?"},
                     {"howbig: <part>", Asks::property, "How big is the table?"},
                     {"what: which<kind> most<part>",
                      Asks::property,
                      "Which drawer is the widest?",
                      {{"part", "{part} {kind}"}},
                      SentenceTime::none},
                     {"what: most<part>", Asks::property, "", {}, SentenceTime::none},
                     {"howlong: <part> -was -have -do -did -had -there -stand -time -see", Asks::property},
                     {"what: furniture empty", Asks::objects, "", empty},
                     {"what: which<part> empty [every|leave]", Asks::objects, "Which drawers are empty?",
                      empty},
                     {"howmany: empty <part>", Asks::number, "", empty},
                     {"yes|bare: any empty <part>", Asks::exists, "Is any drawer empty?", empty},
                     {"what: which<part> not empty", Asks::objects, "", used},
                     {"what: which<part> full", Asks::objects, "", used},
                     {"what: which<part> inside|contain|have thing", Asks::objects, "", used},
                     {"where: mostthings [contain|have|stand|keep|put]", Asks::most,
                      "Which place has the most objects?"},
                     {"what: mostthings [location|furniture]", Asks::most},
                     {"what: mostthings <part>", Asks::most},
                     {"what: mostthings which<part> [contain|have]", Asks::most}}},
      {.name = "opens",
       .group = QuestionGroup::inspect,
       .description = "What opens, whether it is open, and when it was opened",
       .parameters = {part,
                      {.name = "state",
                       .help = "Only those that are so",
                       .default_text = "any",
                       .choices = {"open", "closed", "unopened"}}},
       .period = true,
       .examples = {"", "drawer_1 --at 17:45"},
       .answer = format::schema_by<opens_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), OpensQuestion{given.text("part"), given.text("state"), given.as_of(),
                                                 given.from(), given.to()});
       },
       .sentences = {{"what: open|opened [thing|every] -was -did -been", Asks::summary, "What opens?"},
                     {"what: which<part> open [stand|leave]", Asks::objects, "Which drawers are open?",
                      are_open},
                     {"what: which<part> close [stand]", Asks::objects, "", are_closed},
                     {"what: which<part> not opened|move|look", Asks::objects,
                      "Which drawer was never opened?", unopened, SentenceTime::period},
                     {"what: which<part> not open have|did|person|was", Asks::objects, "", unopened,
                      SentenceTime::period},
                     {"what: which<part> close throughout", Asks::objects, "", unopened,
                      SentenceTime::period},
                     {"what: which<part> not close", Asks::objects, "", are_open},
                     {"what: which<part> not open -have -did -person -was", Asks::objects, "", are_closed},
                     {"what: which<part> opened may"},
                     {"yes|bare: open <part> [stand|leave|sure|think]", Asks::open, "Is the drawer open?"},
                     {"yes|bare: close <part> [sure|think|every]", Asks::closed, "Is drawer_2 closed?"},
                     {"yes|bare: not open <part>", Asks::closed},
                     {"yes|bare: not close <part>", Asks::open},
                     {"yes|bare: open thing [leave]", Asks::open, "Is anything open?"},
                     {"what|bare|yes|how|order: state <part> [tell|give|show|every]", Asks::property,
                      "State of the first drawer?"},
                     {"howmany: open <part>", Asks::number, "", are_open},
                     {"howmany: close <part>", Asks::number, "", are_closed},
                     {"howfar: open|opened <part>"}}},
  };
}

}  // namespace loci::memory
