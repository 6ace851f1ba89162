#pragma once

#include "memory/questions/answers.h"

namespace loci::memory {

/// A task for a robot or a person: which objects are concerned, where they are, where they are to go, and
/// what is missing for it.
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
  std::string reason = {};  ///< "asked for", "12 of 14 sightings were there"
};
struct TaskItem {
  ObjectState object = {};
  std::optional<TaskTarget> target = {};  ///< unset for bring
  bool done = false;                      ///< it is there already
  std::string needed_as = {};             ///< set: what it is needed as, e.g. "cup"
};
struct TaskAnswer {
  TaskQuestion::Kind kind = TaskQuestion::Kind::bring;
  std::string asked = {};  ///< the task in words: "bring tea cup"
  std::vector<TaskItem> items = {};
  std::vector<std::string> missing = {};  ///< what stands in the way, one sentence each
  std::vector<std::string> notes = {};    ///< what was taken for granted
};
TaskAnswer ask(const Store& store, const TaskQuestion& question);

std::string task_name(TaskQuestion::Kind kind);  ///< "bring", "stow", "set", "clean"
/// Error with the known ones.
TaskQuestion::Kind task_kind(const std::string& name);

}  // namespace loci::memory
