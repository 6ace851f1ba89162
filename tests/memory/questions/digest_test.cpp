// A day in one answer.

#include "memory/questions/routines/digest.h"

#include "mapping/base/text/json.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;

class Digest : public testing_support::DayFixture {};

TEST_F(Digest, SaysWhatADayLeftBehind) {
  const DigestAnswer answer = ask(*store_, DigestQuestion{});
  EXPECT_GT(answer.scenes, 0U);
  EXPECT_FALSE(answer.changes.empty());
  EXPECT_EQ(answer.to - answer.from, 24 * 3600 * kSecond - 1);
  for (const Change& change : answer.changes)
    EXPECT_TRUE(answer.from <= change.time && change.time <= answer.to);
  for (const ObjectBelief& missing : answer.missing) EXPECT_EQ(missing.status, ObjectStatus::gone);
  for (const MisplacedObject& object : answer.misplaced) {
    EXPECT_NE(object.now.place->id, object.usual.id);
    EXPECT_GE(object.share, 0.5);
  }
  EXPECT_THAT(text(answer), HasSubstr(answer.day));
  const Json json = to_json(answer);
  EXPECT_EQ(json["changes"].size(), answer.changes.size());
  EXPECT_EQ(json["missing"].size(), answer.missing.size());
}

TEST_F(Digest, TheShortFormIsASentenceAndThreeLines) {
  const Query query{.question = "digest"};
  const Reply reply = ask(*store_, query).reply({*store_, query, {}, TimeWriter(*store_)});
  EXPECT_EQ(reply.text, text(ask(*store_, DigestQuestion{})).substr(0, reply.text.size()));
  ASSERT_FALSE(reply.evidence.empty());
  EXPECT_LE(reply.evidence.size(), kMaxEvidenceLines);
  EXPECT_THAT(reply.evidence[0], testing::AllOf(testing::StartsWith("Changed: "), HasSubstr("tea cup")));
}

TEST_F(Digest, TakesTheDayInTheMemorysZone) {
  const DigestAnswer last = ask(*store_, DigestQuestion{});
  EXPECT_EQ(ask(*store_, DigestQuestion{last.day, {}}).changes.size(), last.changes.size());
  EXPECT_EQ(ask(*store_, DigestQuestion{"today", {}}).day, last.day);
  const DigestAnswer before = ask(*store_, DigestQuestion{"yesterday", {}});
  EXPECT_EQ(before.to + 1, last.from);
  EXPECT_EQ(before.scenes, 0U);
  EXPECT_THAT(text(before), HasSubstr("Nothing was observed on"));
  EXPECT_THROW(ask(*store_, DigestQuestion{"someday", {}}), Error);
}

TEST_F(Digest, EarlierTimesOfTheDayKnowLess) {
  const DigestAnswer all = ask(*store_, DigestQuestion{});
  const DigestAnswer morning = ask(*store_, DigestQuestion{{}, at("08:30")});
  EXPECT_LT(morning.changes.size(), all.changes.size());
  EXPECT_LT(morning.scenes, all.scenes);
}

TEST_F(Digest, OfAnEmptyMemoryIsAnError) {
  const std::filesystem::path file = folder_ / "empty.loci";
  { Store::open_write(file); }
  EXPECT_THROW(ask(Store::open_read(file), Query{.question = "digest"}), Error);
}

}  // namespace
}  // namespace loci::memory
