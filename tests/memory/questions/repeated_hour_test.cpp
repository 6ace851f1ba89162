// Of a moment that clocks showed twice, every question means the same one.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/contents.h"
#include "memory/questions/presence.h"
#include "memory/questions/question.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Central Europe, 25 October 2026: at 01:00 UTC clocks are put back from three to two.
class RepeatedHour : public testing_support::TemporaryFolder {
 protected:
  /// Looks at the counter; the bowl is there, or not.
  void look(const std::vector<std::pair<std::string, bool>>& looks) {
    std::string lines;
    for (const auto& [time, there] : looks) {
      Json detections = Json::array();
      if (there)
        detections.push_back({{"position", {1, 2, 0.8}},
                              {"size", {0.2, 0.2, 0.1}},
                              {"class", {{"bowl", 0.9}}},
                              {"score", 0.9},
                              {"place", "counter_1"}});
      lines += Json{{"time", "2026-10-25T" + time + ":00Z"},
                    {"observed", {{{"place", "counter_1"}, {"fraction", 1}}}},
                    {"detections", detections}}
                   .dump() +
               "\n";
    }
    write_file_atomically(folder_ / "looks.jsonl", lines);
    NoProgress silent;
    Warnings warnings;
    ingest(folder_ / "looks.jsonl", file_, {}, {.time_zone = "Europe/Berlin"}, silent, warnings);
  }
};

TEST_F(RepeatedHour, IsTheOneThatWasObserved) {
  look({{"00:10", true}, {"00:16", true}, {"08:00", false}, {"08:05", false}});
  const Store store = Store::open_read(file_);
  EXPECT_EQ(format_time(read_moment(store, "2026-10-25 02:15").first), "2026-10-25T00:15:00Z");
  EXPECT_EQ(format_time(read_moment(store, "2026-10-25 02:15+01:00").first), "2026-10-25T01:15:00Z");
}

TEST_F(RepeatedHour, IsTheSecondWhereBothWere) {
  look({{"00:10", true}, {"00:16", true}, {"01:14", true}, {"01:16", true}, {"08:00", false}});
  const Store store = Store::open_read(file_);
  EXPECT_EQ(format_time(read_moment(store, "2026-10-25 02:15").first), "2026-10-25T01:15:00Z");
}

TEST_F(RepeatedHour, IsOneMomentForAllQuestions) {
  look({{"00:10", true}, {"00:15", true}, {"01:40", false}, {"01:50", false}, {"08:00", false}});
  const Store store = Store::open_read(file_);
  const std::string moment = "2026-10-25 02:15";
  const Query on{.question = "on", .arguments = {{"place", "counter_1"}, {"at", moment}}};
  const Query was{
      .question = "was",
      .arguments = {{"object", "bowl"}, {"place", "counter_1"}, {"from", moment}, {"to", moment}}};
  const Query was_at{.question = "was",
                     .arguments = {{"object", "bowl"}, {"place", "counter_1"}, {"at", moment}}};
  EXPECT_EQ(ask(store, on).get<ContentsAnswer>().verdict, Verdict::yes);
  for (const Query& query : {was, was_at}) {
    const WasAnswer answer = ask(store, query).get<WasAnswer>();
    EXPECT_EQ(answer.verdict, Verdict::yes);
    EXPECT_LE(answer.to - answer.from, kMinute) << "one of the two, not both";
    EXPECT_EQ(format_time(answer.to), "2026-10-25T00:15:59.999999999Z");
  }
  for (const Query& query : {on, was, was_at})
    EXPECT_THAT(find_question(query.question)->reply(store, query, ask(store, query)).notes,
                Contains(HasSubstr("clocks showed '2026-10-25 02:15' twice; 02:15+02:00 is taken")));
}

}  // namespace
}  // namespace loci::memory
