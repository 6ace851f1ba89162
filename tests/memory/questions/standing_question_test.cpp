// Events to wait for.

#include "memory/questions/routines/standing_question.h"

#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class StandingQuestions : public testing_support::DayFixture {
 protected:
  /// The events of the whole day, as if one had waited since its begin.
  std::vector<std::string> events_of(const std::string& text) {
    const StandingQuestion asked = parse_standing_question(text);
    std::vector<std::string> found;
    for (const Change& change :
         ask(*store_, ChangesQuestion{{}, {}, asked.object, asked.place, {}, asked.kind}).changes)
      found.push_back(to_text(change));
    return found;
  }
};

TEST_F(StandingQuestions, AreReadAsPeopleWriteThem) {
  const StandingQuestion leaves = parse_standing_question("The milk leaves the fridge");
  EXPECT_EQ(leaves.object, "milk");
  EXPECT_EQ(leaves.place, "fridge");
  EXPECT_EQ(leaves.kind, "left");
  EXPECT_EQ(parse_standing_question("anything appears").object, "");
  const StandingQuestion opens = parse_standing_question("drawer 1 opens");
  EXPECT_EQ(opens.joint, "drawer_1");
  EXPECT_EQ(opens.object, "");
  EXPECT_FALSE(parse_standing_question("door_2 closes").opens);
  for (const char* text :
       {"", "milk", "leaves the fridge", "milk leaves", "milk appears on table_1", "fribble the gromp"})
    EXPECT_THROW(parse_standing_question(text), Error) << text;
}

TEST_F(StandingQuestions, FindTheEventsOfTheDay) {
  const std::vector<std::string> all = events_of("anything appears");
  EXPECT_FALSE(all.empty());
  EXPECT_EQ(events_of("object_1 leaves table_1").size() + events_of("object_1 comes to table_1").size(),
            ask(*store_, ChangesQuestion{{}, {}, "object_1", "table_1", {}, {}}).changes.size());
}

TEST_F(StandingQuestions, OnlyWhatIsNewIsNews) {
  EventWatcher watcher({parse_standing_question("anything moves"), parse_standing_question("zebra appears")});
  watcher.begin_now(*store_);
  EXPECT_THAT(watcher.poll(*store_), IsEmpty());
}

TEST_F(StandingQuestions, WhatHappenedSinceTheMemoryWasMadeIsNewsToWhoWaitedForIt) {
  EventWatcher watcher({parse_standing_question("anything appears")});
  EXPECT_THAT(watcher.poll(*store_), testing::SizeIs(events_of("anything appears").size()));
}

TEST_F(StandingQuestions, WhatIsNotKnownYetIsNamed) {
  const auto unknown = [&](const std::string& event) {
    return EventWatcher({parse_standing_question(event)}).unknown(*store_);
  };
  EXPECT_THAT(unknown("zebra appears"), ElementsAre(HasSubstr("zebra")));
  EXPECT_THAT(unknown("object_1 leaves zebra"), ElementsAre(HasSubstr("zebra")));
  EXPECT_THAT(unknown("drawer_99 opens"), ElementsAre(HasSubstr("drawer_99")));
  EXPECT_THAT(unknown("anything moves"), IsEmpty());
}

}  // namespace
}  // namespace loci::memory
