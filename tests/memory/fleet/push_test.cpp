// Memories arrive in PostgreSQL row for row, exactly once, whatever happens to the program.

#include <sys/wait.h>

#include <random>
#include <thread>

#include "mapping/base/stopwatch.h"
#include "memory/edits/edits.h"
#include "memory/edits/forget.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/erasure/forgotten_tokens.h"
#include "memory/store/erasure/retention.h"
#include "memory/store/rows/merge.h"
#include "tests/memory/fleet/fleet_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::RandomMemory;

class Push : public testing_support::FleetTest {
 protected:
  /// Facts, an object and a recording more.
  void add_rows(int number) {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    for (int i = 0; i < number; ++i)
      store.add_fact({.object = 1, .key = "note", .value = "note " + std::to_string(i)}, run);
    store.finish_run(run);
  }
  template <class Function>
  static std::string error_of(Function function) {
    try {
      function();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(Push, ABeliefThatFadesAtOnceIsNoDivisionByZero) {
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    SceneTransaction rows(store, run);
    BeliefRow row = store.beliefs().front();
    row.clock.supersedes = row.id;
    row.clock.known_to.reset();
    row.fade_s = 0;
    row.fade_to = 0.5;
    rows.add_belief(row);
    store.finish_run(run);
    rows.commit();
  }
  push();
  EXPECT_EQ(number("SELECT count(*) FROM loci.v_objects WHERE probability IS NULL"), 0);
  EXPECT_GT(number("SELECT count(*) FROM loci.v_objects"), 0);
}

TEST_F(Push, ReplicatesEveryRowOnce) {
  const PushResult first = push();
  EXPECT_GT(first.added_rows(), 150);
  EXPECT_THAT(first.removed, IsEmpty());
  EXPECT_EQ(first.transactions, 1);
  EXPECT_THAT(differences(file_), IsEmpty());
  EXPECT_EQ(push().transactions, 0) << "nothing is new";

  add_rows(3);
  const PushResult second = push();
  EXPECT_EQ(second.added.at("fact"), 3);
  EXPECT_EQ(second.added.at("run"), 1);
  EXPECT_EQ(second.added.count("scene"), 0U);
  EXPECT_THAT(differences(file_), IsEmpty());
  EXPECT_EQ(number("SELECT revision FROM loci.robot"), 2);
}

TEST_F(Push, CarriesForgettingAndRetention) {
  push();
  const Id object = random_->cubes[0].object;
  ASSERT_NE(object, 0);
  const ForgetResult forgotten = forget(file_, {.object = object});
  ASSERT_THAT(forgotten.tokens.texts, testing::Not(IsEmpty()));
  const PushResult result = push();
  EXPECT_GE(result.removed.at("observation"), forgotten.observations);
  EXPECT_EQ(result.added.at("forgotten"), 1) << "the tombstone travels";
  EXPECT_THAT(differences(file_), IsEmpty());
  // Nothing of it is in any column of text or bytes.
  for (const TableLayout& table : table_layouts())
    for (const TableColumn& column : table.columns)
      for (const auto& [kind, tokens] :
           {std::pair("text", forgotten.tokens.texts), {"hash", forgotten.tokens.hashes}})
        for (const std::string& token : tokens) {
          if (column.type != TableColumn::Type::text && column.type != TableColumn::Type::bytes) continue;
          const bool bytes = column.type == TableColumn::Type::bytes;
          int64_t found = 0;
          connection()->query("SELECT count(*) FROM " + table_name(table) + " WHERE position(" +
                                  (bytes ? "convert_to($1, 'UTF8')" : "$1") + " IN " + sql_name(column.name) +
                                  ") > 0",
                              {token}, [&](ResultRow row) { found = integer_of(row[0]); });
          EXPECT_EQ(found, 0) << kind << " '" << token << "' in " << table.name << "." << column.name;
        }
  for (const char* column : {"x", "y", "z"})
    for (const double number : forgotten.tokens.numbers) {
      int64_t found = 0;
      connection()->query(
          std::string("SELECT count(*) FROM loci.observation WHERE ") + column + " = $1::double precision",
          {fmt::format("{}", number)}, [&](ResultRow row) { found = integer_of(row[0]); });
      EXPECT_EQ(found, 0) << column << " " << number;
    }

  retain(file_, {.images_s = 3600.0, .crops_s = 7200.0, .reasoning_s = {}});
  EXPECT_GT(push().removed_rows(), 0);
  EXPECT_THAT(differences(file_), IsEmpty());
  EXPECT_EQ(push().transactions, 0);
}

TEST_F(Push, GoesOnAfterItWasKilledAtAnyMoment) {
  std::filesystem::remove(file_);
  random_ = std::make_unique<RandomMemory>(file_, 3, 6, 40);
  const Stopwatch whole;
  push(file_, {"home", "whole"}, "postgres", 60);
  const auto longest = std::chrono::duration<double>(whole.seconds());
  std::mt19937 draw(7);
  int killed = 0, robots = 1;  // a robot whose push was complete is followed by the next one
  const auto name = [&] { return RobotName{"home", "robot_" + std::to_string(robots)}; };
  for (int attempt = 0; killed < 30; ++attempt) {
    ASSERT_LT(attempt, 200) << "pushes are too short to be killed";
    if (attempt % 10 == 5) add_rows(40);
    if (attempt == 15) forget(file_, {.object = random_->cubes[1].object});
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      try {
        push(file_, name(), "postgres", 60);
      } catch (const std::exception&) {
        ::_exit(1);
      }
      ::_exit(0);
    }
    std::this_thread::sleep_for(longest * std::uniform_real_distribution()(draw));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
    WIFSIGNALED(status) ? ++killed : ++robots;
    // In one statement: the server may still be at work for the client that was killed.
    EXPECT_EQ(
        number("SELECT (SELECT coalesce(sum(rows), 0) FROM loci.cursor WHERE table_name = 'association') "
               "- (SELECT count(*) FROM loci.association)"),
        0)
        << "rows and cursor are committed together";
  }
  for (; robots > 0; --robots) {
    push(file_, name());
    EXPECT_THAT(differences(file_, name()), IsEmpty()) << robots;
  }
  EXPECT_EQ(number("SELECT count(*) FROM loci.robot WHERE NOT complete"), 0);
}

TEST_F(Push, OfSeveralRobotsAtOnce) {
  constexpr unsigned kRobots = 4;
  std::vector<std::filesystem::path> files;
  for (unsigned i = 0; i < kRobots; ++i) {
    files.push_back(folder_ / ("robot_" + std::to_string(i) + ".loci"));
    RandomMemory(files.back(), 10 + i);
  }
  const auto name = [](unsigned i) { return RobotName{"home", "robot_" + std::to_string(i)}; };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < 2 * kRobots; ++i)  // each twice
    threads.emplace_back([&, i] { push(files[i % kRobots], name(i % kRobots), "postgres", 200); });
  for (std::thread& thread : threads) thread.join();
  for (unsigned i = 0; i < kRobots; ++i) EXPECT_THAT(differences(files[i], name(i)), IsEmpty());
}

TEST_F(Push, RefusesAnotherMemoryOfARobot) {
  push();
  const std::filesystem::path other = folder_ / "other.loci";
  {
    Store made = Store::open_write(other, {.now = RandomMemory::kStart + kSecond});
    made.begin_run("test", "{}");
  }
  EXPECT_THAT(error_of([&] { push(other); }), HasSubstr("has another memory there"));
  EXPECT_THAT(differences(file_), IsEmpty());
  NoProgress silent;
  MemoryPush(other, parse_fleet_url(url()), {.name = {"home", "robot"}, .replace = true}).run(silent);
  EXPECT_THAT(differences(other), IsEmpty());
}

TEST_F(Push, RefusesAnOlderCopyThatHasWhatWasForgotten) {
  push();
  const std::filesystem::path older = folder_ / "older.loci";
  std::filesystem::copy_file(file_, older);
  forget(file_, {.object = random_->cubes[0].object});
  push();
  EXPECT_THAT(error_of([&] { push(older); }), HasSubstr("an older copy of the memory of robot 'robot'"));
  NoProgress silent;
  EXPECT_THAT(
      error_of([&] {
        MemoryPush(older, parse_fleet_url(url()), {.name = {"home", "robot"}, .replace = true}).run(silent);
      }),
      HasSubstr("merge"));
  EXPECT_THAT(differences(file_), IsEmpty());
}

TEST_F(Push, ReplacesRowsThatSomebodyChanged) {
  push();
  sql("UPDATE loci.place SET name = 'elsewhere'; DELETE FROM loci.fact; UPDATE loci.scene SET time = time + "
      "1");
  EXPECT_THAT(differences(file_), testing::Not(IsEmpty()));
  EXPECT_EQ(push().transactions, 0) << "their digests are as they were";
  NoProgress silent;
  MemoryPush pusher(file_, parse_fleet_url(url()), {.name = {"home", "robot"}, .replace = true});
  EXPECT_GT(pusher.run(silent).removed.at("scene"), 0);
  EXPECT_THAT(differences(file_), IsEmpty());
  EXPECT_EQ(pusher.run(silent).transactions, 0) << "only once";
}

TEST_F(Push, TakesNamesAndTextsAsValues) {
  const RobotName hostile{"h'; DROP SCHEMA loci CASCADE; --",
                          "r\"\\ $1 %s ø 機 ); COMMIT; DELETE FROM loci.robot; --"};
  {
    Store store = Store::open_write(file_);
    store.add_fact({.object = 1, .key = "it's", .value = "\t\\N\n\"; DROP TABLE loci.scene; -- ' ø 機 \x01"},
                   store.begin_run("test", "{}"));
  }
  push();
  push(file_, hostile);
  EXPECT_THAT(differences(file_), IsEmpty());
  EXPECT_THAT(differences(file_, hostile), IsEmpty());
  EXPECT_EQ(number("SELECT count(*) FROM loci.robot"), 2);
  EXPECT_THAT(error_of([&] { push(file_, {"home", ""}); }), HasSubstr("the name of the robot is empty"));
  EXPECT_THAT(error_of([&] { push(file_, {"home", "\xff"}); }), HasSubstr("UTF-8"));
}

TEST_F(Push, SaysWhatIsWrong) {
  EXPECT_THAT(error_of([] {
                MemoryPush(std::filesystem::path("none.loci"), parse_fleet_url("postgresql:///x"),
                           {.name = {"h", "r"}});
              }),
              HasSubstr("no such memory"));
  EXPECT_THAT(error_of([&] {
                MemoryPush(file_, parse_fleet_url("postgresql://me:secret@/loci?host=/nowhere"),
                           {.name = {"h", "r"}});
              }),
              testing::AllOf(HasSubstr("postgresql://me@/loci: cannot be reached"),
                             testing::Not(HasSubstr("secret"))));
  EXPECT_THAT(error_of([&] { parse_fleet_url("postgresql:///loci?robot=%zz"); }), HasSubstr("malformed"));
  push();
  sql("UPDATE loci.version SET fleet = 2");
  EXPECT_THAT(error_of([&] { push(); }), HasSubstr("has version 2 with memory format"));
  EXPECT_THAT(error_of([&] { pull(); }), HasSubstr("has version 2"));
}

// A lost connection leaves what was committed; the next push goes on.
TEST_F(Push, LosesNothingWithItsConnection) {
  NoProgress silent;
  MemoryPush pusher(file_, parse_fleet_url(url()), {.name = {"home", "robot"}, .max_rows = 60});
  sql("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE application_name = 'loci' AND pid <> "
      "pg_backend_pid()");
  EXPECT_THAT(error_of([&] { pusher.run(silent); }), HasSubstr("the connection was lost"));
  push();
  EXPECT_THAT(differences(file_), IsEmpty());
}

TEST_F(Push, HasTheViewsOfTheFile) {
  push();
  RandomMemory(folder_ / "other.loci", 5);
  push(folder_ / "other.loci", {"home", "other"});
  const auto rounded = [](const Json& row) {
    std::string text;
    for (const auto& [column, value] : row.get<std::map<std::string, Json>>())
      text += column + "=" + (value.is_number() ? fmt::format("{:.9g}", value.get<double>()) : value.dump()) +
              " ";
    return text;
  };
  const Store store = Store::open_read(file_);
  for (const std::string view :
       {"objects", "observations", "events", "scenes", "place_visibility", "log", "facts"}) {
    std::multiset<std::string> expected, found;
    store.read_view("v_" + view, [&](const Json& row) { expected.insert(rounded(row)); });
    connection()->query(
        "SELECT (to_jsonb(v) - 'home' - 'robot')::text FROM loci.v_" + view + " v WHERE robot = 'robot'", {},
        [&](ResultRow row) { found.insert(rounded(Json::parse(text_of(row[0])))); });
    EXPECT_EQ(found, expected) << view;
  }
}

}  // namespace
}  // namespace loci::memory
