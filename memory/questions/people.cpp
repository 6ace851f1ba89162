#include "memory/questions/people.h"

#include <fmt/format.h>

#include <limits>

#include "mapping/base/text/text.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;
using namespace replies;

PeopleAnswer ask(const Store& store, const PeopleQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  PeopleAnswer answer;
  for (const SceneRow& scene :
       store.scenes_annotated(kPersonType, question.from.value_or(std::numeric_limits<TimeNs>::min()),
                              question.to.value_or(std::numeric_limits<TimeNs>::max()), question.as_of))
    answer.scenes.push_back(snapshot.scene_ref(scene));
  return answer;
}

std::string to_text(const PeopleAnswer& answer, const TimeWriter& times) {
  if (answer.scenes.empty()) return "No person was recognised.\n";
  std::vector<std::string> lines;
  for (const SceneRef& scene : answer.scenes)
    lines.push_back(fmt::format("{}: somebody was in view ({})", times.text(scene.time), scene_text(scene)));
  return lines_text(lines);
}

namespace {

const Record<PeopleAnswer>& people_record() {
  static const auto record =
      Record<PeopleAnswer>("PeopleAnswer").record("scenes", &PeopleAnswer::scenes, scene_record());
  return record;
}

}  // namespace

Json to_json(const PeopleAnswer& answer) {
  return people_record().json(answer);
}

void write_reply(const PeopleAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Asks asks = context.query.asks;
  if (answer.scenes.empty()) {
    if (asks == Asks::verdict) reply.verdict = Verdict::not_observed;
    reply.not_known = true;
    reply.text = "Not observed: no person was recognised then.";
    return;
  }
  const TimeNs first = answer.scenes.front().time, last = answer.scenes.back().time;
  const std::string span = context.times.span_text(first, last);
  reply.time = TimeSpan{first, last};
  if (asks == Asks::verdict) {
    reply.verdict = Verdict::yes;
    reply.text = fmt::format("Yes: somebody was in view {}.", span);
  } else if (asks == Asks::number) {
    reply.number = answer.scenes.size();
    reply.text = fmt::format("In {}, {}.", counted(answer.scenes.size(), "scene"), span);
  } else {
    reply.time = at_once(last);
    reply.text = fmt::format("At {}: somebody was in view then.", context.times.text(last));
  }
  reply.evidence.push_back("in view in " + scenes_text(answer.scenes));
}

std::vector<Question> people_questions() {
  using enum Asks;
  return {
      {.name = "people",
       .description = "When somebody was in view",
       .period = true,
       .asks = last_time,
       .examples = {"", "--from 09:00 --json"},
       .answer = format::schema_by<people_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(),
                    PeopleQuestion{.from = given.from(), .to = given.to(), .as_of = given.as_of()});
       },
       .time = SentenceTime::period,
       .sentences = {{"yes|bare: person room [see|been|come|there]", verdict, "Was anybody in the kitchen?"},
                     {"yes: see person", verdict},
                     {"when: person room [see|been|last|there]", last_time, "When was somebody here last?"},
                     {"howoften: person room [see|been|there]", number}},
       .of_moment = false}};
}

}  // namespace loci::memory
