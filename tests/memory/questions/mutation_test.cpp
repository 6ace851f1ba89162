// verify notices what changes answers: one cell, row or blob of a valid memory is changed at random.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "mapping/base/math/random.h"
#include "mapping/base/text/json.h"
#include "memory/questions/contents.h"
#include "memory/questions/events.h"
#include "memory/questions/location.h"
#include "memory/questions/objects.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

class Mutation : public testing_support::DayFixture {
 protected:
  /// What people can ask, as text; the message where the memory cannot be read.
  static std::string answers(const std::filesystem::path& file) {
    std::string text;
    try {
      const Store store = Store::open_read(file);
      const TimeWriter times(store);
      for (const char* clock : {"08:00", "09:00", "09:30", "10:30"}) {
        const AsOf as_of{.at = testing_support::day_time(clock)};
        const ObjectsAnswer objects = ask(store, ObjectsQuestion{.as_of = as_of});
        text += to_json(objects).dump() + to_text(objects, times);
        for (const PlaceRow& place : store.places())
          text += to_json(ask(store, ContentsQuestion{.place = place.name, .as_of = as_of})).dump();
        for (const ObjectBelief& one : objects.objects) {
          const std::string& name = one.object.name;
          text += to_json(ask(store, WhereQuestion{.subject = name, .as_of = as_of})).dump();
          text += to_json(ask(store, HistoryQuestion{.subject = name, .as_of = as_of})).dump();
          text += to_json(ask(store, AboutQuestion{.subject = name, .as_of = as_of})).dump();
        }
      }
      for (const SceneRow& scene : store.scenes()) {
        for (const std::optional<Id>& blob : {scene.depth, scene.image, scene.pixel_kinds})
          if (blob) text += store.blob(*blob).hash + store.blob(*blob).bytes;
        for (const LogRow& line : store.log(scene.id)) text += line.text;
        for (const AnnotationRow& row : store.annotations(scene.id)) text += row.type + row.value;
      }
      for (const char* word : {"cup", "red", "mug"})
        for (const Id id : store.objects_with_text(word)) text += object_name(id);
      for (const char* view :
           {"v_objects", "v_observations", "v_events", "v_scenes", "v_place_visibility", "v_facts"})
        store.read_view(view, [&](const Json& row) { text += row.dump(); });
    } catch (const std::exception& error) {
      text += error.what();
    }
    return text;
  }

  /// Changes one cell or drops one row; what it did, or "" where there was nothing to change.
  static std::string mutate(SQLite::Database& database, Random& random) {
    const auto strings = [&](const std::string& query) {
      std::vector<std::string> result;
      SQLite::Statement rows(database, query);
      while (rows.executeStep()) result.push_back(rows.getColumn(0).getString());
      return result;
    };
    const std::vector<std::string> tables =
        strings("SELECT name FROM sqlite_schema WHERE type = 'table' AND sql NOT LIKE 'CREATE VIRTUAL%'");
    const std::string& table = tables[random.index(tables.size())];
    const int64_t rows = database.execAndGet(fmt::format("SELECT count(*) FROM \"{}\"", table)).getInt64();
    if (rows == 0) return {};
    const auto offset = static_cast<int64_t>(random.index(static_cast<size_t>(rows)));
    const std::vector<std::string> keys =
        strings(fmt::format("SELECT name FROM pragma_table_info('{}') WHERE pk > 0 ORDER BY pk", table));
    std::string key = "rowid", first = "rowid";
    if (!keys.empty())
      key = fmt::format("({})", fmt::join(keys, ", ")), first = fmt::format("{}", fmt::join(keys, ", "));
    const std::string where =
        fmt::format("WHERE {} = (SELECT {} FROM \"{}\" LIMIT 1 OFFSET {})", key, first, table, offset);
    if (random.uniform() < 0.2) {
      database.exec(fmt::format("DELETE FROM \"{}\" {}", table, where));
      return fmt::format("row {} of {} dropped", offset, table);
    }
    const std::vector<std::string> columns =
        strings(fmt::format("SELECT name FROM pragma_table_info('{}')", table));
    const std::string& column = columns[random.index(columns.size())];
    const std::string type =
        database.execAndGet(fmt::format("SELECT typeof(\"{}\") FROM \"{}\" {}", column, table, where))
            .getString();
    const std::string cell = '"' + column + '"';
    std::string value;
    if (type == "integer") value = cell + " + 1";
    if (type == "real") value = cell + " + 0.25";
    if (type == "text") value = cell + " || 'x'";
    if (type == "blob") value = fmt::format("CAST(substr({0}, 1, length({0}) - 1) || x'5A' AS BLOB)", cell);
    if (value.empty()) return {};
    database.exec(fmt::format("UPDATE OR IGNORE \"{}\" SET {} = {} {}", table, cell, value, where));
    return fmt::format("{}.{} of row {}", table, column, offset);
  }
};

TEST_F(Mutation, IsReportedByVerifyWhereItChangesAnAnswer) {
  constexpr int kMutations = 200;
  store_.reset();
  const std::string before = answers(file_);
  ASSERT_FALSE(before.empty());
  Random random(1);
  int changed = 0, reported = 0;
  std::string missed;
  const std::filesystem::path copy = folder_ / "mutated.loci";
  for (int n = 0; n < kMutations;) {
    std::filesystem::copy_file(file_, copy, std::filesystem::copy_options::overwrite_existing);
    std::string done;
    {
      SQLite::Database database(copy.string(), SQLite::OPEN_READWRITE);
      database.exec(
          "PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON; PRAGMA synchronous = OFF");
      std::vector<std::string> triggers;
      {
        SQLite::Statement all(database, "SELECT name, sql FROM sqlite_schema WHERE type = 'trigger'");
        while (all.executeStep()) triggers.push_back(all.getColumn(1).getString());
        all.reset();
        std::vector<std::string> names;
        while (all.executeStep()) names.push_back(all.getColumn(0).getString());
        all.reset();
        for (const std::string& name : names) database.exec("DROP TRIGGER " + name);
      }
      done = mutate(database, random);
      for (const std::string& trigger : triggers) database.exec(trigger);
    }
    if (done.empty()) continue;
    ++n;
    if (answers(copy) == before) continue;
    ++changed;
    bool found = true;
    try {
      NoProgress silent;
      found = !Store::open_read(copy).verify(silent).problems.empty();
    } catch (const Error&) {
    }
    reported += found ? 1 : 0;
    if (!found) missed += done + "; ";
  }
  RecordProperty("changed", changed);
  RecordProperty("reported", reported);
  EXPECT_GT(changed, kMutations / 4);
  EXPECT_GE(reported, 0.95 * changed) << reported << " of " << changed << ", missed: " << missed;
}

}  // namespace
}  // namespace loci::memory
