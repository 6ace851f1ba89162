#include "memory/questions/routines/standing_question.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "mapping/base/text/text.h"
#include "memory/questions/environment.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

struct Verb {
  const char* words;
  const char* kind;  ///< of ChangesQuestion
  bool takes_place;
};
constexpr std::array<Verb, 12> kVerbs = {{{"leaves", "left", true},
                                          {"is taken from", "left", true},
                                          {"comes to", "came", true},
                                          {"arrives at", "came", true},
                                          {"is put on", "came", true},
                                          {"is put into", "came", true},
                                          {"appears", "appeared", false},
                                          {"reappears", "reappeared", false},
                                          {"disappears", "gone", false},
                                          {"moves", "moved", false},
                                          {"opens", "joint_changed", false},
                                          {"closes", "joint_changed", false}}};

std::string without_article(const std::string& text) {
  for (const char* article : {"the ", "a ", "an ", "my "})
    if (text.starts_with(article)) return trimmed(text.substr(std::string_view(article).size()));
  return trimmed(text);
}

/// What makes an event the same when names change meanwhile.
std::string key_of(const StandingQuestion& question, const Change& change) {
  return fmt::format("{}|{}|{}|{}|{}", question.text, to_text(change.kind), change.time,
                     change.object ? change.object->id : 0, change.joint.value_or(""));
}

bool fits(const StandingQuestion& question, const Change& change) {
  if (question.joint.empty()) return true;
  if (!change.joint || !change.joint->starts_with(question.joint)) return false;
  const double before = change.from_joint_position.value_or(0), after = change.joint_position.value_or(0);
  return question.opens ? after > before : after < before;
}

}  // namespace

std::string standing_question_forms() {
  std::vector<std::string> forms;
  for (const Verb& verb : kVerbs)
    forms.push_back((verb.kind == std::string_view("joint_changed") ? "DRAWER " : "OBJECT ") +
                    std::string(verb.words) + (verb.takes_place ? " PLACE" : ""));
  return joined(forms, ", ");
}

StandingQuestion parse_standing_question(const std::string& text) {
  const std::string sentence = fmt::format(" {} ", lower_case(trimmed(text)));
  for (const Verb& verb : kVerbs) {
    const std::string words = fmt::format(" {} ", verb.words);
    const size_t at = sentence.find(words);
    if (at == std::string::npos) continue;
    const std::string subject = without_article(trimmed(sentence.substr(0, at)));
    const std::string rest = without_article(trimmed(sentence.substr(at + words.size() - 1)));
    if (subject.empty() || rest.empty() == verb.takes_place) break;
    StandingQuestion question{.text = text, .object = subject, .place = rest, .kind = verb.kind};
    if (subject == "anything" || subject == "something") question.object.clear();
    if (question.kind == "joint_changed") {
      question.joint = std::exchange(question.object, {});
      std::ranges::replace(question.joint, ' ', '_');
      question.opens = verb.words == std::string_view("opens");
    }
    return question;
  }
  throw Error("'" + text + "' is no event to wait for", {}, "write " + standing_question_forms());
}

void EventWatcher::begin_now(const Store& store) {
  from_ = store.last_scene_time();
  for (const StandingQuestion& question : questions_)
    for (const Change& change : changes_of(question, store)) reported_.insert(key_of(question, change));
}

std::vector<std::string> EventWatcher::unknown(const Store& store) const {
  std::vector<std::string> unknown;
  for (const StandingQuestion& question : questions_) try {
      if (question.joint.empty())
        ask(store, ChangesQuestion{from_, {}, question.object, question.place, {}, question.kind});
      else if (ask(store, OpensQuestion{.part = question.joint}).parts.empty())
        unknown.push_back(fmt::format("nothing that opens is known as '{}'", question.joint));
    } catch (const UnknownName& error) {
      unknown.push_back(error.message());
    }
  return unknown;
}

std::vector<EventWatcher::News> EventWatcher::poll(const Store& store) {
  std::vector<News> news;
  for (const StandingQuestion& question : questions_)
    for (const Change& change : changes_of(question, store))
      if (reported_.insert(key_of(question, change)).second) news.push_back({question.text, change});
  std::ranges::stable_sort(news, {}, [](const News& each) { return each.change.time; });
  return news;
}

std::vector<Change> EventWatcher::changes_of(const StandingQuestion& question, const Store& store) const {
  try {
    std::vector<Change> changes =
        ask(store, ChangesQuestion{from_, {}, question.object, question.place, {}, question.kind}).changes;
    std::erase_if(changes, [&](const Change& change) { return !fits(question, change); });
    return changes;
  } catch (const UnknownName&) {  // It may be seen, or get this name, later.
    return {};
  }
}

}  // namespace loci::memory
