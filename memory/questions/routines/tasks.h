#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// What a robot or a person needs for a task: which objects, where they are, where they go, and what is
// missing.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> task_questions();

struct TaskQuestion {
  enum class Kind {
    bring,  ///< `subject` to whoever asks
    stow,   ///< `subject` to `place`, or to where each usually is
    set,    ///< `place` with what is needed for `occasion`
    clean,  ///< what is at `place` (empty = anywhere) to where each usually is
  };
  Kind kind = Kind::bring;
  std::string subject = {};
  std::string place = {};
  std::string occasion = {};
  AsOf as_of = {};
};

struct TaskTarget {
  PlaceRef place = {};
  double probability = 1;   ///< share of its sightings that were there, or 1 when the place was asked for
  std::string reason = {};  ///< "asked for", "seen there in 12 of 14 scenes"
};
struct TaskItem {
  ObjectBelief object = {};
  std::optional<TaskTarget> target = {};  ///< unset for bring
  bool done = false;                      ///< it is there already
};
struct TaskAnswer {
  TaskQuestion::Kind kind = TaskQuestion::Kind::bring;
  std::string asked = {};  ///< "bring tea cup"
  std::vector<TaskItem> items = {};
  std::vector<std::string> missing = {};  ///< what prevents the task, one sentence each
  std::vector<std::string> notes = {};    ///< assumptions
};
TaskAnswer ask(const Store& store, const TaskQuestion& question);
std::string to_text(const TaskAnswer& answer, const TimeWriter& times);
void write_reply(const TaskAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const TaskAnswer& answer);

}  // namespace loci::memory
