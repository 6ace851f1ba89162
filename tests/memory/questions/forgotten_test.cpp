// A period that was forgotten was not observed: all questions answer so at times within it, and what is known
// before it and after it stays.

#include <gmock/gmock.h>

#include "memory/questions/forgotten.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "tests/memory/questions/generated_day.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ForgottenPeriod : public testing_support::GeneratedDay, public testing::WithParamInterface<uint64_t> {
 protected:
  static constexpr int kFirst = 10, kLast = 17;  ///< scenes of the period

  void SetUp() override {
    GeneratedDay::SetUp();
    generate(GetParam());
    {
      const Store store = Store::open_read(file_);
      for (const SceneRow& scene : store.scenes()) times_.push_back(scene.time);
      for (const BeliefRow& belief : store.beliefs({.at = times_[kFirst - 1]}))
        known_.push_back(belief.object);
      for (const TimeNs time : times_) before_.push_back(places(store, time));
    }
    Store store = Store::open_write(file_);
    store.forget({.from = times_[kFirst], .to = times_[kLast]}, store.begin_run("test", "{}"));
  }

  /// Where objects are believed to be at a time.
  static std::string places(const Store& store, TimeNs time) {
    std::string text;
    for (const BeliefRow& row : store.beliefs({.at = time}))
      text += fmt::format("{} {} {:.3f}\n", object_name(row.object), row.place.value_or(0), row.probability);
    return text;
  }

  /// All questions whose arguments are objects and places, about one of each.
  std::vector<Query> queries() const {
    std::vector<Query> all;
    for (const Question& question : questions()) {
      Query query{.question = question.name};
      bool complete = true;
      for (const Parameter& parameter : question.parameters) {
        if (!parameter.required) continue;
        using enum ParameterType;
        if (parameter.type == object || (parameter.type == spot && parameter.name != "with"))
          query.arguments[parameter.name] = object_name(known_.front());
        else if (parameter.type == place)
          query.arguments[parameter.name] = "table_1";
        else
          complete = false;
      }
      if (complete && is_answered(query)) all.push_back(query);
    }
    return all;
  }

  /// Some need one of several arguments, or images.
  bool is_answered(const Query& query) const {
    try {
      ask(Store::open_read(file_), query, {.at = times_[kFirst - 1]});
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  static Reply reply_to(const Store& store, const Query& query) {
    return find_question(query.question)->reply(store, query, ask(store, query));
  }

  std::vector<TimeNs> times_;
  std::vector<Id> known_;
  std::vector<std::string> before_;
};

TEST_P(ForgottenPeriod, IsNotObservedAtMomentsWithinIt) {
  const Store store = Store::open_read(file_);
  size_t asked = 0;
  for (Query query : queries())
    for (const TimeNs time : {times_[kFirst], times_[kFirst] + 60 * kSecond, times_[kLast]}) {
      query.arguments["at"] = format_time(time);
      SCOPED_TRACE(query.text());
      const Reply reply = reply_to(store, query);
      if (!find_question(query.question)->of_moment) {
        EXPECT_THAT(reply.notes, testing::Contains(HasSubstr("was forgotten on request")));
        continue;
      }
      ++asked;
      EXPECT_THAT(reply.text, StartsWith("Not observed: what was seen from "));
      EXPECT_TRUE(reply.not_known);
      EXPECT_EQ(reply.verdict, Verdict::not_observed);
      EXPECT_TRUE(reply.objects.empty() && reply.places.empty() && !reply.probability);
    }
  EXPECT_GT(asked, 20U);
}

TEST_P(ForgottenPeriod, IsNotObservedAsAPeriod) {
  const Store store = Store::open_read(file_);
  for (Query query : queries()) {
    if (!find_question(query.question)->period) continue;
    // Its borders, within it, and a little more that has no scene of its own.
    for (const auto& [from, to] : {std::pair(times_[kFirst], times_[kLast]),
                                   {times_[kFirst] + 1, times_[kFirst + 1]},
                                   {times_[kFirst] - 60 * kSecond, times_[kLast] + 60 * kSecond}}) {
      query.arguments["from"] = format_time(from);
      query.arguments["to"] = format_time(to);
      SCOPED_TRACE(query.text());
      EXPECT_THAT(reply_to(store, query).text, StartsWith("Not observed: what was seen from "));
    }
    query.arguments["from"] = format_time(times_[kFirst - 1]);
    EXPECT_THAT(reply_to(store, query).notes, testing::Contains(HasSubstr("was forgotten on request")))
        << query.text();
  }
}

TEST_P(ForgottenPeriod, LeavesWhatIsKnownBefore) {
  const Store store = Store::open_read(file_);
  for (size_t i = 0; i < size_t{kFirst}; ++i) EXPECT_EQ(places(store, times_[i]), before_[i]) << i;
  for (Query query : queries())
    for (const TimeNs time : {times_[kFirst] - kSecond, times_[kLast] + kSecond}) {
      query.arguments["at"] = format_time(time);
      const Reply reply = reply_to(store, query);
      if (find_question(query.question)->of_moment && query.question != "was") {
        EXPECT_THAT(reply.text, testing::Not(HasSubstr("forgotten"))) << query.text();
      }
    }
}

TEST_P(ForgottenPeriod, AnswersAreThoseOfTheTimeBefore) {
  const Store store = Store::open_read(file_);
  for (Query query : queries()) {
    const Question& question = *find_question(query.question);
    if (!question.of_moment || question.time == SentenceTime::period) continue;
    query.arguments["at"] = format_time(times_[kFirst - 1]);
    const std::string before = ask(store, query).to_json().dump();
    query.arguments["at"] = format_time(times_[kFirst + 2]);
    EXPECT_EQ(ask(store, query).to_json().dump(), before) << query.text();
  }
}

INSTANTIATE_TEST_SUITE_P(GeneratedDays, ForgottenPeriod, testing::Range<uint64_t>(1, 9));

}  // namespace
}  // namespace loci::memory
