#include "memory/questions/spoken.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

#include "mapping/base/error.h"
#include "memory/questions/change_kinds.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/unseen.h"

namespace loci::memory {
namespace {

const std::set<std::string> kPronouns = {"it", "them", "that",     "this",    "they",
                                         "he", "she",  "that one", "this one"};

/// What the clocks of a command line mean, beside those that were given.
AsOf clocks_of(const CommandLine& command, const TimeReader& times, const AsOf& given) {
  AsOf as_of = given;
  if (!command.option("at").empty()) as_of.at = times.read(command.option("at")).last;
  return as_of;
}

struct FromTo {
  std::optional<TimeNs> from = {}, to = {};
};
FromTo span_of(const CommandLine& command, const TimeReader& times) {
  FromTo span;
  if (command.verb == "task") return span;  // its --to is a place
  const auto both = command.options.find("between");
  const std::string from = both == command.options.end() ? command.option("from") : both->second.at(0);
  const std::string to = both == command.options.end() ? command.option("to") : both->second.at(1);
  if (!from.empty()) span.from = times.read(from).first;
  if (!to.empty()) span.to = times.read(to).last;
  return span;
}

WasQuestion was_question(const Store& store, const CommandLine& command, const FromTo& span,
                         const AsOf& as_of) {
  const auto scenes = store.scenes();
  WasQuestion question = read_was(command.words);
  question.from = span.from.value_or(scenes.empty() ? 0 : scenes.front().time);
  question.to = span.to.value_or(scenes.empty() ? 0 : scenes.back().time);
  question.as_of = as_of;
  return question;
}

TaskQuestion task_question(const CommandLine& command, const AsOf& as_of) {
  TaskQuestion question{.kind = task_kind(command.words.at(0)), .as_of = as_of};
  CommandLine rest = command;
  rest.words.erase(rest.words.begin());
  const bool about_place =
      question.kind == TaskQuestion::Kind::set || question.kind == TaskQuestion::Kind::clean;
  (about_place ? question.place : question.subject) = rest.joined_words();
  if (!about_place) question.place = command.option("to");
  question.occasion = command.option("for");
  return question;
}

NearQuestion near_question(const CommandLine& command, const AsOf& as_of) {
  NearQuestion question{.subject = command.joined_words(), .as_of = as_of};
  if (const std::string radius = command.option("radius"); !radius.empty())
    question.radius_m = read_length(radius);
  return question;
}

/// Puts what is meant in place of "it" and "this drawer".
class Reference {
 public:
  Reference(const Store& store, const AsOf& as_of) : snapshot_(store, as_of) {}

  /// What the last sentence was about.
  void remember(const CommandLine& command) {
    if (const std::string subject = subject_of(command); !subject.empty()) last_subject_ = subject;
    if (const auto places = places_of(command); !places.empty()) last_place_ = places.front();
  }

  void resolve(CommandLine& command, std::vector<std::string>& notes) {
    for (std::string* text : texts(command)) {
      if (kPronouns.contains(*text)) replace_pronoun(*text, notes);
      if (text->starts_with("this ") || text->starts_with("that ")) replace_pointed_at(*text, notes);
    }
    if (command.verb == "was" && command.words.size() == 3 && command.words[2] == "there")
      replace_there(command, notes);
  }

  /// Says what a place was taken for that nobody has called so.
  void note_places(const CommandLine& command, std::vector<std::string>& notes) const {
    for (const std::string& name : places_of(command)) {
      if (!snapshot_.places_called(name).empty()) continue;
      try {
        const auto places = snapshot_.find_places(name);
        notes.push_back(
            fmt::format("no place is called '{}'; {} is meant", name,
                        places.size() == 1 ? places[0].name : "any " + name.substr(name.rfind(' ') + 1)));
      } catch (const UnknownName&) {
        continue;  // the answer will say so
      }
    }
  }

 private:
  static std::string subject_of(const CommandLine& command) {
    if (!command.option("object").empty()) return command.option("object");
    if (command.verb == "where" || command.verb == "history" || command.verb == "objects" ||
        command.verb == "usual" || command.verb == "was" || command.verb == "near" ||
        command.verb == "together" || command.verb == "lifecycle" || command.verb == "next-look" ||
        command.verb == "like" || command.verb == "about")
      return command.words.empty() ? "" : command.words[0];
    return command.verb == "task" && command.words.size() > 1 &&
                   (command.words[0] == "bring" || command.words[0] == "stow")
               ? command.words[1]
               : "";
  }
  static std::vector<std::string> places_of(const CommandLine& command) {
    std::vector<std::string> places;
    if (command.verb == "on" || command.verb == "in" || command.verb == "kept" || command.verb == "missing")
      places.push_back(command.joined_words());
    if (command.verb == "was" && command.words.size() == 3) places.push_back(command.words[2]);
    if (command.verb == "task" && command.words.size() > 1 &&
        (command.words[0] == "set" || command.words[0] == "clean"))
      places.push_back(command.words[1]);
    for (const char* option : {"place", "to"})
      if (!command.option(option).empty() && (command.verb == "task" || command.verb == "changes") &&
          (command.verb == "task" || std::string(option) == "place"))
        places.push_back(command.option(option));
    return places;
  }
  static std::vector<std::string*> texts(CommandLine& command) {
    std::vector<std::string*> result;
    for (std::string& word : command.words) result.push_back(&word);
    for (const char* name : {"object", "place", "to", "with"})
      if (const auto found = command.options.find(name); found != command.options.end())
        result.push_back(&found->second[0]);
    return result;
  }

  void replace_pronoun(std::string& text, std::vector<std::string>& notes) const {
    if (!last_subject_.empty()) {
      notes.push_back(fmt::format("'{}' is taken as '{}'", text, last_subject_));
      text = last_subject_;
      return;
    }
    const BeliefRow* latest = nullptr;
    const auto seen = [&](const BeliefRow& row) {
      const SceneRow* scene = row.last_scene ? snapshot_.scene(*row.last_scene) : nullptr;
      return scene == nullptr ? TimeNs{0} : scene->time;
    };
    for (const BeliefRow& row : snapshot_.beliefs())
      if (latest == nullptr || seen(row) > seen(*latest)) latest = &row;
    if (latest == nullptr) return;
    notes.push_back(fmt::format("nothing was spoken of before: '{}' is taken as {}, which was seen last",
                                text, object_name(latest->object)));
    text = object_name(latest->object);
  }

  /// Where the first of the things that are meant is believed to be; "" = unknown.
  std::string place_of(const std::string& subject) const {
    try {
      const Id object = snapshot_.find_objects(subject).front();
      const auto place = snapshot_.place_ref(snapshot_.belief(object)->place);
      return place ? place->name : "";
    } catch (const UnknownName&) {
      return "";  // the answer will say so
    }
  }

  /// "there" is the place that was spoken of last, else where the thing was seen last.
  void replace_there(CommandLine& command, std::vector<std::string>& notes) const {
    const std::string place = last_place_.empty() ? place_of(command.words[0]) : last_place_;
    if (place.empty()) {
      command.words.resize(1);  // anywhere
      return;
    }
    notes.push_back(fmt::format("'there' is taken as {}", place));
    command.words[2] = place;
  }

  /// "this drawer" is the drawer that was looked at last.
  void replace_pointed_at(std::string& text, std::vector<std::string>& notes) const {
    const std::string name = text.substr(5);
    std::vector<PlaceRow> places;
    try {
      places = snapshot_.find_places(name);
    } catch (const UnknownName&) {
      text = name;
      return;
    }
    const PlaceRow* chosen = nullptr;
    TimeNs latest = 0;
    for (const PlaceRow& place : places)
      for (const VisibilityRow& look : snapshot_.store().visibility_of_place(place.id)) {
        const SceneRow* scene = snapshot_.scene(look.scene);
        if (scene == nullptr || look.fraction.value_or(0) <= 0 || scene->time < latest) continue;
        latest = scene->time;
        chosen = &place;
      }
    if (chosen == nullptr) chosen = &places[0];
    notes.push_back(fmt::format("'{}' is taken as {}, {}", text, chosen->name,
                                latest == 0 ? "the first of that name" : "which was looked at last"));
    text = chosen->name;
  }

  Snapshot snapshot_;
  std::string last_subject_, last_place_;
};

WhyNot why_not(const Store& store, const CommandLine& command, const AsOf& as_of, const UnknownName& error) {
  const std::string hint = error.hint().empty() ? "" : " (" + error.hint() + ")";
  if (error.kind() == UnknownName::Kind::place)
    return {"unknown_place", fmt::format("Not known: {}{}.", error.message(), hint)};
  if (as_of.at) {
    // Perhaps it came later.
    try {
      CommandLine later = command;
      later.options.erase("at");
      run_question(store, later, {.at = {}, .known_at = as_of.known_at});
      return {"not_yet_seen",
              fmt::format("Not known then: {} at that time; it was first seen later.", error.message())};
    } catch (const Error&) {
      return {"never_seen", fmt::format("Never seen: {}{}.", error.message(), hint)};
    }
  }
  return {"never_seen", fmt::format("Never seen: {}{}.", error.message(), hint)};
}

}  // namespace

WasQuestion read_was(std::vector<std::string> words) {
  WasQuestion question;
  const auto join = [](auto first, auto last) {
    std::string text;
    for (auto word = first; word != last; ++word) text += (text.empty() ? "" : " ") + *word;
    return text;
  };
  const auto preposition = std::find_if(words.begin(), words.end(),
                                        [](const std::string& word) { return word == "on" || word == "in"; });
  if (preposition != words.end() && preposition != words.begin() && preposition + 1 != words.end()) {
    question.place = join(preposition + 1, words.end());
    words.erase(preposition, words.end());
  } else if (words.size() > 1) {
    question.place = words.back();
    words.pop_back();
  }
  question.subject = join(words.begin(), words.end());
  return question;
}

AnyAnswer run_question(const Store& store, const CommandLine& command, const AsOf& given) {
  const TimeReader times(store);
  const AsOf as_of = clocks_of(command, times, given);
  const FromTo span = span_of(command, times);
  const std::string words = command.joined_words();
  using Run = std::function<AnyAnswer()>;
  const std::map<std::string, Run> runs = {
      {"where",
       [&] {
         return ask(store, WhereQuestion{words, as_of});
       }},
      {"history",
       [&] {
         return ask(store, HistoryQuestion{words, span.from, span.to, as_of});
       }},
      {"on",
       [&] {
         return ask(store, ContentsQuestion{words, as_of, command.option("object")});
       }},
      {"in",
       [&] {
         return ask(store, ContentsQuestion{words, as_of, command.option("object")});
       }},
      {"was", [&] { return ask(store, was_question(store, command, span, as_of)); }},
      {"changes",
       [&] {
         return ask_for_kind(
             store,
             ChangesQuestion{span.from, span.to, command.option("object"), command.option("place"), as_of},
             command.option("kind"));
       }},
      {"objects",
       [&] {
         const std::string since = command.option("unseen-since");
         const ObjectsQuestion question{words, as_of};
         return since.empty() ? ask(store, question)
                              : ask_unseen_since(store, question, times.read(since).first);
       }},
      {"scenes",
       [&] {
         return ask(store, ScenesQuestion{span.from, span.to, as_of});
       }},
      {"timeline",
       [&] {
         return ask(store, TimelineQuestion{span.from, span.to, as_of});
       }},
      {"usual",
       [&] {
         return ask(store, UsualQuestion{words, as_of, command.option("during")});
       }},
      {"kept",
       [&] {
         return ask(store, KeptQuestion{words, as_of});
       }},
      {"task", [&] { return ask(store, task_question(command, as_of)); }},
      {"near", [&] { return ask(store, near_question(command, as_of)); }},
      {"together",
       [&] {
         return ask(store, TogetherQuestion{words, command.option("with"), as_of});
       }},
      {"missing",
       [&] {
         return ask(store, MissingQuestion{words, command.option("for"), as_of});
       }},
      {"kind", [&] { return ask(store, KindQuestion{.as_of = as_of}); }},
      {"lifecycle",
       [&] {
         return ask(store, LifecycleQuestion{words, as_of});
       }},
      {"next-look", [&] { return ask(store, NextLookQuestion{.subject = words, .as_of = as_of}); }},
      {"like", [&] { return ask(store, LikeQuestion{.subject = words, .as_of = as_of}); }},
      {"about", [&] { return ask(store, AboutQuestion{.subject = words, .as_of = as_of}); }},
      {"room",
       [&] {
         return ask(store, RoomQuestion{words, as_of});
       }},
      {"opens",
       [&] {
         return ask(store, OpensQuestion{words, as_of});
       }},
  };
  const auto found = runs.find(command.verb);
  if (found == runs.end()) throw Error(fmt::format("'{}' is no question", command.verb));
  return found->second();
}

std::vector<SpokenAnswer> ask(const Store& store, const SpokenQuestion& question) {
  const TimeReader times(store);
  Reference reference(store, question.as_of);
  std::vector<SpokenAnswer> answers;
  for (const std::string& sentence : question.sentences) {
    SpokenAnswer answer{.sentence = sentence};
    answer.command = understand(sentence, times);
    if (!answer.command) {
      answer.why_not = WhyNot{"not_understood", fmt::format("'{}' is not understood.", sentence)};
      answer.nearest = nearest_sentences(sentence);
    } else {
      reference.resolve(*answer.command, answer.notes);
      reference.remember(*answer.command);
      reference.note_places(*answer.command, answer.notes);
      try {
        answer.answer = run_question(store, *answer.command, question.as_of);
      } catch (const UnknownName& error) {
        answer.why_not =
            why_not(store, *answer.command, clocks_of(*answer.command, times, question.as_of), error);
      } catch (const Error& error) {
        answer.why_not = WhyNot{"not_possible", fmt::format("Not possible: {}.", error.message())};
      }
    }
    answers.push_back(std::move(answer));
  }
  return answers;
}

}  // namespace loci::memory
