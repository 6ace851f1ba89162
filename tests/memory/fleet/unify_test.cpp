// Robots of one home that saw the same objects.

#include "memory/fleet/unify.h"
#include "memory/fleet/fleet_roles.h"
#include "memory/ingest/ingest.h"
#include "tests/memory/fleet/fleet_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class Unify : public testing_support::FleetTest {
 protected:
  /// A robot that looks at three objects, which stay where they are, at other times than the other one.
  std::filesystem::path memory_of(const std::string& robot, int first_minute,
                                  const std::filesystem::path& map = std::filesystem::path(LOCI_SOURCE_DIR) /
                                                                     "apps/samples/kitchen.urdf") {
    std::string lines;
    for (int i = 0; i < 4; ++i)
      lines += fmt::format(
          R"({{"time": "2026-05-01T08:{:02}:00Z", "observed": [{{"place": "counter_1", "fraction": 0.9}}], "detections": [)"
          R"({{"position": [1.0, 2.704, 0.946], "size": [0.09, 0.09, 0.1], "class": {{"mug": 0.9}}, "color": [2, 0.85, 0.8], "place": "counter_1"}}, )"
          R"({{"position": [1.5, 2.71, 0.95], "size": [0.2, 0.07, 0.27], "class": {{"carton": 0.9}}, "color": [30, 0.8, 0.9], "place": "counter_1"}}, )"
          R"({{"position": [2.0, 2.8, 1.03], "size": [0.08, 0.08, 0.24], "class": {{"bottle": 0.9}}, "color": [60, 0.8, 0.8], "place": "counter_1"}}]}})"
          "\n",
          first_minute + 5 * i);
    const std::filesystem::path file = folder_ / (robot + ".jsonl"), memory = folder_ / (robot + ".loci");
    write_file_atomically(file, lines);
    NoProgress silent;
    Warnings warnings;
    IngestOptions options;
    options.map = map;
    ingest(file, memory, options, {}, silent, warnings);
    push(memory, {"home", robot});
    return memory;
  }
  UnifyResult unified(const std::string& as = "unified", const std::string& role = "postgres") const {
    NoProgress silent;
    return unify(parse_fleet_url(url("", role)), {"home", as}, folder_ / "cache", silent);
  }
};

TEST_F(Unify, JoinsObjectsThatSeveralRobotsSaw) {
  const std::filesystem::path first = memory_of("first", 0), second = memory_of("second", 2);
  ASSERT_EQ(Store::open_read(first).objects().size(), 3U);
  const UnifyResult result = unified();
  EXPECT_THAT(result.robots, testing::ElementsAre("first", "second"));
  EXPECT_EQ(result.their_objects, 6);
  EXPECT_EQ(result.objects, 3);
  EXPECT_EQ(number("SELECT count(*) FROM loci.identity WHERE observations = 4"), 6)
      << "each object of each robot";
  EXPECT_EQ(Store::open_read(pull("&robot=unified")).objects().size(), 3U);
  EXPECT_THAT(differences(first, {"home", "first"}), IsEmpty()) << "their own memories stay";

  const UnifyResult again = unified();
  EXPECT_EQ(again.objects, 3);
  EXPECT_EQ(number("SELECT count(*) FROM loci.identity"), 6);
  EXPECT_THROW(unified("first"), Error) << "a robot's memory is not replaced";
}

TEST_F(Unify, NamesTheRobotThatHasAnotherMap) {
  memory_of("first", 0);
  const std::filesystem::path map = folder_ / "other.urdf";
  write_file_atomically(map, "<robot name=\"other\"><link name=\"world\"/></robot>");
  memory_of("second", 2, map);
  try {
    unified();
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("robot 'second' of home 'home' has neither a map nor a recording in "
                                        "common with 'first'"));
    EXPECT_THAT(error.hint(), testing::Not(HasSubstr("--transform")));
  }
}

TEST_F(Unify, NeedsTheRightsOfItsRobot) {
  memory_of("first", 0);
  memory_of("second", 2);
  sql("CREATE ROLE job LOGIN");
  grant_role(parse_fleet_url(url()), {"job", "home", {}});
  EXPECT_THROW(unified("unified", "job"), Error);
  grant_role(parse_fleet_url(url()), {"job", "home", "unified"});
  EXPECT_EQ(unified("unified", "job").objects, 3);
}

}  // namespace
}  // namespace loci::memory
