#pragma once

#include <variant>

#include "memory/questions/about.h"
#include "memory/questions/company.h"
#include "memory/questions/habits.h"
#include "memory/questions/journeys.h"
#include "memory/questions/likeness.h"
#include "memory/questions/room.h"
#include "memory/questions/sentence.h"
#include "memory/questions/tasks.h"

namespace loci::memory {

using AnyAnswer =
    std::variant<WhereAnswer, HistoryAnswer, ContentsAnswer, WasAnswer, ChangesAnswer, ObjectsAnswer,
                 ScenesAnswer, TimelineAnswer, UsualAnswer, KeptAnswer, TaskAnswer, NearAnswer,
                 TogetherAnswer, MissingAnswer, KindAnswer, LifecycleAnswer, NextLookAnswer, LikeAnswer,
                 AboutAnswer, RoomAnswer, OpensAnswer>;

/// Why there is no answer.
struct WhyNot {
  std::string reason = {};  ///< not_understood, never_seen, not_yet_seen, unknown_place, not_possible
  std::string text = {};
};

/// Sentences in English, one after the other: "it" is what the one before was about.
struct SpokenQuestion {
  std::vector<std::string> sentences = {};
  AsOf as_of = {};  ///< `at` is what a sentence says that says no time
};
struct SpokenAnswer {
  std::string sentence = {};
  std::optional<CommandLine> command = {};  ///< what it became; unset = not understood
  std::vector<std::string> notes = {};      ///< what words were taken for
  std::optional<AnyAnswer> answer = {};
  std::optional<WhyNot> why_not = {};     ///< set where there is no answer
  std::vector<std::string> nearest = {};  ///< sentences that are understood, when this one is not
};
/// One answer per sentence. What is not understood or means nothing here is an answer, not an error.
std::vector<SpokenAnswer> ask(const Store& store, const SpokenQuestion& question);

/// "X on PLACE", "X in PLACE", "X PLACE" or "X" alone; the times are left at 0.
WasQuestion read_was(std::vector<std::string> words);

/// Runs a command as loci-memory would. Error for a verb that is no question.
AnyAnswer run_question(const Store& store, const CommandLine& command, const AsOf& as_of);

}  // namespace loci::memory
