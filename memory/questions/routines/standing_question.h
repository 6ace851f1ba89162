#pragma once

#include <set>
#include <string>
#include <vector>

#include "memory/questions/events.h"
#include "memory/store/store.h"

namespace loci::memory {

/// What to wait for: "milk leaves the fridge", "anything appears", "drawer_1 opens".
struct StandingQuestion {
  std::string text = {};
  std::string object = {};  ///< words for objects; empty = any
  std::string place = {};   ///< empty = anywhere
  std::string kind = {};    ///< as of ChangesQuestion
  std::string joint = {};   ///< beginning of the name of a joint that opens or closes; empty = no joint
  bool opens = true;
};
/// Error that shows the forms when it is none.
StandingQuestion parse_standing_question(const std::string& text);
/// "SUBJECT leaves PLACE, …", for messages and help.
std::string standing_question_forms();

/// Compares a memory with itself while it is written.
class EventWatcher {
 public:
  explicit EventWatcher(std::vector<StandingQuestion> questions) : questions_(std::move(questions)) {}
  /// What happened before now is not told.
  void begin_now(const Store& store);
  /// What the questions name that means nothing in this memory yet, one sentence for each.
  std::vector<std::string> unknown(const Store& store) const;

  struct News {
    std::string question;
    Change change;
  };
  /// Changes that were not there at the last call, by question, in order of time.
  std::vector<News> poll(const Store& store);

 private:
  std::vector<Change> changes_of(const StandingQuestion& question, const Store& store) const;

  std::vector<StandingQuestion> questions_;
  std::optional<TimeNs> from_;
  std::set<std::string> reported_;
};

}  // namespace loci::memory
