#include <fmt/format.h>

#include "mapping/base/hash.h"
#include "mapping/base/json.h"
#include "memory/store/database.h"
#include "memory/store/schema.h"

namespace loci::memory {
namespace {

/// A query that finds what must not be; its first column is shown.
struct Rule {
  const char* sentence;
  const char* query;
  int version = 1000;  ///< of the format, from which on it holds
};

constexpr Rule kRules[] = {
    {"observation {} is chosen for more than one object",
     "SELECT observation FROM association_known WHERE known_to IS NULL AND chosen = 1 AND probability > 0 "
     "AND "
     "observation IS NOT NULL GROUP BY observation HAVING count(*) > 1"},
    {"scene {} sees one object twice",
     "SELECT scene FROM association_known WHERE known_to IS NULL AND chosen = 1 AND probability > 0 AND "
     "observation IS NOT NULL AND object IS NOT NULL GROUP BY scene, object HAVING count(*) > 1"},
    {"the explanations of observation {} are more probable than one",
     "SELECT observation FROM association_known WHERE known_to IS NULL AND observation IS NOT NULL "
     "GROUP BY observation HAVING sum(probability) > 1.000001"},
    {"association {} belongs to another scene than its observation",
     "SELECT a.id FROM association a JOIN observation o ON o.id = a.observation WHERE o.scene <> a.scene"},
    {"association {} holds at another time than its scene",
     "SELECT a.id FROM association a JOIN scene s ON s.id = a.scene WHERE a.valid_from <> s.time"},
    {"event {} is about an object whose observation is of another one",
     "SELECT e.id FROM event_known e WHERE e.known_to IS NULL AND e.probability > 0 AND e.observation IS NOT "
     "NULL AND "
     "e.object IS NOT NULL AND NOT EXISTS (SELECT 1 FROM association_known a WHERE a.known_to IS NULL AND "
     "a.observation = e.observation AND a.object = e.object AND a.chosen = 1)"},
    {"event {} happens before its object is known",
     "SELECT e.id FROM event e JOIN object o ON o.id = e.object WHERE e.valid_from < o.valid_from"},
    {"belief {} names a last sighting that lies in the future",
     "SELECT b.id FROM belief b JOIN scene s ON s.id = b.last_scene WHERE s.time > b.valid_from"},
    {"object {} was never believed to be anywhere",
     "SELECT o.id FROM object o WHERE NOT EXISTS (SELECT 1 FROM belief b WHERE b.object = o.id) AND NOT "
     "EXISTS "
     "(SELECT 1 FROM forgotten f WHERE f.object = o.id)",
     1001},
    {"scene {} has a depth thumbnail without its size",
     "SELECT id FROM scene WHERE depth IS NOT NULL AND (depth_width IS NULL OR depth_height IS NULL)"},
    {"scene {} says what other pixels are than those of its depth thumbnail",
     "SELECT s.id FROM scene s JOIN blob b ON b.id = s.kinds WHERE s.depth IS NULL OR b.size <> "
     "s.depth_width * s.depth_height",
     1005},
    {"observation {} has points without a mask that says where they are",
     "SELECT id FROM observation WHERE cloud IS NOT NULL AND (mask IS NULL OR roi_x IS NULL)", 1005},
};

/// About what can be made anew from other rows.
constexpr Rule kDerivedRules[] = {
    {"belief {} is missing among the stays",
     "SELECT b.id FROM belief b WHERE b.x IS NOT NULL AND NOT EXISTS (SELECT 1 FROM stay s WHERE s.belief = "
     "b.id)",
     1001},
    {"object {} is missing under a word that it was called",
     "SELECT DISTINCT a.object FROM association a JOIN annotation n ON n.scene = a.scene AND n.observation = "
     "a.observation WHERE a.chosen = 1 AND a.probability > 0 AND a.object IS NOT NULL AND NOT EXISTS (SELECT "
     "1 FROM "
     "object_term t WHERE t.term = n.term AND t.object = a.object)",
     1001},
    {"the words of object {} are not counted from its first sighting that was called so",
     "SELECT object FROM (SELECT term, object, since FROM object_term EXCEPT SELECT n.term, a.object, "
     "min(a.valid_from) FROM association a JOIN annotation n ON n.scene = a.scene AND n.observation = "
     "a.observation WHERE a.chosen = 1 AND a.probability > 0 AND a.object IS NOT NULL GROUP BY n.term, "
     "a.object)",
     1002},
    {"the marks of the sightings of object {} are not what its sightings say",
     "WITH derived AS (SELECT object, number, valid_from, scene FROM (SELECT object, valid_from, scene, "
     "row_number() OVER (PARTITION BY object ORDER BY valid_from, scene) AS number FROM association WHERE "
     "chosen = 1 AND observation IS NOT NULL AND probability > 0 AND object IS NOT NULL) WHERE number % 64 = "
     "1) SELECT DISTINCT object FROM (SELECT * FROM (SELECT object, number, valid_from, scene FROM "
     "sighting_mark EXCEPT SELECT * FROM derived) UNION ALL SELECT * FROM (SELECT * FROM derived EXCEPT "
     "SELECT object, number, valid_from, scene FROM sighting_mark))",
     1002},
    {"scene {} is marked with a number that is not its own",
     "WITH derived AS (SELECT number, time, id FROM (SELECT id, time, row_number() OVER (ORDER BY time, id) "
     "AS "
     "number FROM scene) WHERE number % 64 = 1) SELECT scene FROM (SELECT * FROM (SELECT scene, number, time "
     "FROM "
     "scene_mark EXCEPT SELECT id, number, time FROM derived) UNION SELECT * FROM (SELECT id, number, time "
     "FROM "
     "derived EXCEPT SELECT scene, number, time FROM scene_mark))",
     1003},
    {"the visits of object {} are not what its sightings say",
     "WITH derived AS (SELECT object, place, valid_from, scene FROM (SELECT a.object, coalesce(o.place, 0) "
     "AS "
     "place, a.valid_from, a.scene, lag(coalesce(o.place, 0)) OVER (PARTITION BY a.object ORDER BY "
     "a.valid_from, "
     "a.scene) AS place_before FROM association a JOIN observation o ON o.id = a.observation WHERE a.chosen "
     "= 1 "
     "AND a.probability > 0 AND a.object IS NOT NULL) WHERE place_before IS NOT place) SELECT DISTINCT "
     "object "
     "FROM (SELECT * FROM (SELECT object, place, valid_from, scene FROM visit EXCEPT SELECT * FROM derived) "
     "UNION "
     "ALL SELECT * FROM (SELECT * FROM derived EXCEPT SELECT object, place, valid_from, scene FROM visit))",
     1003},
    {"stay of belief {} is not where that belief was",
     "SELECT s.belief FROM stay s LEFT JOIN belief b ON b.id = s.belief WHERE b.id IS NULL OR b.x IS NULL OR "
     "abs(s.x_from - 1000 * b.x) > 1 OR abs(s.y_from - 1000 * b.y) > 1 OR abs(s.z_from - 1000 * b.z) > 1 OR "
     "s.place_from <> iif(b.status = 'gone', -1, 1) * coalesce(b.place, 0) OR s.object <> b.object OR "
     "s.since <> b.valid_from / 1000000000",
     1003},
    {"stay of belief {} does not end with the next belief",
     "SELECT s.belief FROM stay s JOIN (SELECT id, coalesce(lead(valid_from) OVER (PARTITION BY object ORDER "
     "BY "
     "valid_from, id) / 1000000000, 2147483647) AS until FROM belief) b ON b.id = s.belief WHERE s.until <> "
     "b.until",
     1002},
};

/// Only those that are counted.
void check_counts(Store::Implementation& store, std::vector<std::string>& problems) {
  std::vector<std::pair<std::string, int64_t>> counts;
  store.query("SELECT name, rows FROM row_count ORDER BY name", {},
              [&](const SqlRow& row) { counts.emplace_back(row.text("name"), row.integer("rows")); });
  for (const auto& [name, rows] : counts) {
    const int64_t found =
        store.database->execAndGet(fmt::format("SELECT count(*) FROM \"{}\"", name)).getInt64();
    if (found != rows)
      problems.push_back(fmt::format("{} has {} rows, not the {} counted", name, found, rows));
  }
}

constexpr const char* kTables[] = {"run",         "recording",   "map",        "place",
                                   "scene",       "observation", "annotation", "feature_structure",
                                   "type_system", "blob",        "object",     "association",
                                   "event",       "belief",      "visibility", "fact",
                                   "scene_log"};

void check_integrity(Store::Implementation& store, VerifyReport& report) {
  store.query("PRAGMA integrity_check", {}, [&](const SqlRow& row) {
    if (const std::string text = row.text("integrity_check"); text != "ok") report.problems.push_back(text);
  });
  store.query("PRAGMA foreign_key_check", {}, [&](const SqlRow& row) {
    report.problems.push_back(fmt::format("{} row {} refers to a {} that is not there", row.text("table"),
                                          row.is_null("rowid") ? 0 : row.integer("rowid"),
                                          row.text("parent")));
  });
}

void check_blobs(Store::Implementation& store, Progress& progress, VerifyReport& report) {
  const auto count = store.database->execAndGet("SELECT count(*) FROM blob").getInt64();
  int64_t done = 0;
  store.query("SELECT * FROM blob ORDER BY id", {}, [&](const SqlRow& row) {
    progress.check(static_cast<double>(done++) / static_cast<double>(std::max<int64_t>(1, count)),
                   "checking blobs");
    const Id id = row.integer("id");
    try {
      const std::string bytes =
          decode_bytes(row.bytes("content"), row.integer("encoding"), row.integer("size"), store.path);
      if (content_hash(bytes) != row.text("hash"))
        report.problems.push_back(fmt::format("blob {} is not what its hash says", id));
    } catch (const Error&) {
      report.problems.push_back(fmt::format("blob {} cannot be decompressed", id));
    }
  });
}

void check_rule(Store::Implementation& store, const Rule& rule, std::vector<std::string>& problems) {
  if (store.version < rule.version) return;
  SQLite::Statement query(*store.database, rule.query);
  while (query.executeStep())
    problems.push_back(fmt::format(fmt::runtime(rule.sentence), query.getColumn(0).getInt64()));
}

void check_feature_structures(Store::Implementation& store, VerifyReport& report) {
  store.query("SELECT id, encoding, content FROM feature_structure ORDER BY id", {}, [&](const SqlRow& row) {
    try {
      parse_json(decode_bytes(row.bytes("content"), row.integer("encoding"), -1, store.path),
                 "feature_structure");
    } catch (const Error&) {
      report.problems.push_back(fmt::format("feature structure {} is damaged", row.integer("id")));
    }
  });
}

}  // namespace

VerifyReport Store::verify(Progress& progress) const {
  auto& s = *implementation_;
  VerifyReport report;
  report.major = major();
  report.minor = minor();
  s.guarded([&] {
    progress.check(0, "checking the file");
    check_integrity(s, report);
    check_blobs(s, progress, report);
    check_feature_structures(s, report);
    for (const Rule& rule : kRules) check_rule(s, rule, report.problems);
    for (const Rule& rule : kDerivedRules) check_rule(s, rule, report.derived_problems);
    check_counts(s, report.derived_problems);
    report.problems.insert(report.problems.end(), report.derived_problems.begin(),
                           report.derived_problems.end());
    for (const char* table : kTables)
      report.counts.emplace_back(
          table, s.database->execAndGet(fmt::format("SELECT count(*) FROM {}", table)).getInt64());
  });
  return report;
}

void Store::derive() {
  auto& s = *implementation_;
  s.need_writable();
  s.forget_cached();
  s.transaction([&] {
    s.database->exec(kDerivation);
    s.database->exec(kCounting);
    return 0;
  });
}

}  // namespace loci::memory
