// Checks of a whole memory.

#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/digest.h"
#include "memory/store/rows/row_columns.h"
#include "memory/store/run_configuration.h"

namespace loci::memory {
namespace {

/// A query for rows that must not exist; the problem names its first column.
struct Rule {
  const char* problem;
  const char* query;
};

constexpr Rule kRules[] = {
    {"observation {} is chosen for more than one object",
     "SELECT observation FROM association_known WHERE known_to IS NULL AND chosen = 1 AND probability > 0 "
     "AND "
     "observation IS NOT NULL GROUP BY observation HAVING count(*) > 1"},
    {"scene {} observes one object twice",
     "SELECT scene FROM association_known WHERE known_to IS NULL AND chosen = 1 AND probability > 0 AND "
     "observation IS NOT NULL AND object IS NOT NULL GROUP BY scene, object HAVING count(*) > 1"},
    {"the explanations of observation {} are more probable than one",
     "SELECT observation FROM association_known WHERE known_to IS NULL AND observation IS NOT NULL "
     "GROUP BY observation HAVING sum(probability) > 1.000001"},
    {"association {} belongs to another scene than its observation",
     "SELECT a.id FROM association a JOIN observation o ON o.id = a.observation WHERE o.scene <> a.scene"},
    {"association {} holds at another time than its scene",
     "SELECT a.id FROM association a JOIN scene s ON s.id = a.scene WHERE a.valid_from <> s.time"},
    {"event {} has an observation of another object",
     "SELECT e.id FROM event_known e WHERE e.known_to IS NULL AND e.probability > 0 AND e.observation IS NOT "
     "NULL AND "
     "e.object IS NOT NULL AND NOT EXISTS (SELECT 1 FROM association_known a WHERE a.known_to IS NULL AND "
     "a.observation = e.observation AND a.object = e.object AND a.chosen = 1)"},
    {"event {} happens before its object is first seen",
     "SELECT e.id FROM event e JOIN object o ON o.id = e.object WHERE e.valid_from < o.valid_from"},
    {"belief {} has a last observation in the future",
     "SELECT b.id FROM belief b JOIN scene s ON s.id = b.last_scene WHERE s.time > b.valid_from"},
    {"object {} has no belief",
     "SELECT o.id FROM object o WHERE NOT EXISTS (SELECT 1 FROM belief b WHERE b.object = o.id)"},
    {"scene {} has a depth thumbnail without its size",
     "SELECT id FROM scene WHERE depth IS NOT NULL AND (depth_width IS NULL OR depth_height IS NULL)"},
    {"scene {} has pixel kinds of another size than its depth thumbnail",
     "SELECT s.id FROM scene s JOIN blob b ON b.id = s.pixel_kinds WHERE s.depth IS NULL OR b.size <> "
     "s.depth_width * s.depth_height"},
    {"observation {} has points without a mask",
     "SELECT id FROM observation WHERE cloud IS NOT NULL AND (mask IS NULL OR roi_x IS NULL)"},
};

constexpr const char* kReportedTables[] = {"run",         "recording",   "map",        "place",
                                           "scene",       "observation", "annotation", "feature_structure",
                                           "type_system", "blob",        "object",     "association",
                                           "event",       "belief",      "visibility", "fact",
                                           "scene_log"};

void check_integrity(Store::Connection& db, std::vector<std::string>& problems) {
  for (const std::string& text : db.values<std::string>("PRAGMA integrity_check"))
    if (text != "ok") problems.push_back(text);
  db.query("PRAGMA foreign_key_check", {}, [&](const SqlRow& row) {
    problems.push_back(
        fmt::format("{} row {} refers to a {} that does not exist", row.get<std::string>("table"),
                    row.get<std::optional<Id>>("rowid").value_or(0), row.get<std::string>("parent")));
  });
}

void check_blobs(Store::Connection& db, Progress& progress, std::vector<std::string>& problems) {
  const int64_t count = query_integer(*db.database, "SELECT count(*) FROM blob");
  int64_t done = 0;
  db.query("SELECT * FROM blob ORDER BY id", {}, [&](const SqlRow& row) {
    progress.check(static_cast<double>(done++) / static_cast<double>(count), "checking blobs");
    const Id id = row.get<Id>("id");
    try {
      const std::string bytes =
          decode_bytes(row.bytes("content"), row.get<int64_t>("encoding"), row.get<int64_t>("size"), db.path);
      if (content_hash(bytes) != row.get<std::string>("hash"))
        problems.push_back(fmt::format("blob {} does not match its hash", id));
    } catch (const Error&) {
      problems.push_back(fmt::format("blob {} is damaged", id));
    }
  });
}

void check_feature_structures(Store::Connection& db, std::vector<std::string>& problems) {
  db.query("SELECT id, encoding, content FROM feature_structure ORDER BY id", {}, [&](const SqlRow& row) {
    try {
      parse_json(decode_bytes(row.bytes("content"), row.get<int64_t>("encoding"), -1, db.path),
                 "feature_structure");
    } catch (const Error&) {
      problems.push_back(fmt::format("feature structure {} is damaged", row.get<Id>("id")));
    }
  });
}

/// That every row of a table can be read.
template <class Row>
void check_rows_of(Store::Connection& db, std::vector<std::string>& problems) {
  int64_t position = 0;
  db.query(fmt::format("SELECT * FROM {}", Row::kTable), {}, [&](const SqlRow& row) {
    ++position;
    try {
      read_row<Row>(row);
    } catch (const Error& error) {
      problems.push_back(fmt::format("{} row {}: {}", Row::kTable, position, error.what()));
    }
  });
}

/// That edits can be listed and undone.
void check_configurations(Store::Connection& db, std::vector<std::string>& problems) {
  db.query("SELECT * FROM run WHERE program LIKE 'loci-memory edit%' OR program LIKE 'loci-memory fact%'", {},
           [&](const SqlRow& row) {
             try {
               configuration_of(read_row<RunRow>(row), db.path);
             } catch (const Error& error) {
               problems.push_back(fmt::format("{}: {}", error.location().key, error.message()));
             }
           });
}

void check_rows(Store::Connection& db, std::vector<std::string>& problems) {
  check_rows_of<PlaceRow>(db, problems);
  check_rows_of<SceneRow>(db, problems);
  check_rows_of<ObservationRow>(db, problems);
  check_rows_of<ObjectRow>(db, problems);
  check_rows_of<AssociationRow>(db, problems);
  check_rows_of<EventRow>(db, problems);
  check_rows_of<BeliefRow>(db, problems);
  check_rows_of<VisibilityRow>(db, problems);
  check_rows_of<FactRow>(db, problems);
}

/// That the R*Tree is one, and that the full-text index has the words of the terms: the pages of both are of
/// SQLite.
void check_search_tables(Store::Connection& db, std::vector<std::string>& problems) {
  if (const auto text = db.value<std::string>("SELECT rtreecheck('main', 'stay')"); text && *text != "ok")
    problems.push_back("table stay is damaged: " + text->substr(0, text->find('\n')));
  // An index of the same terms, to compare with.
  SQLite::Database& database = *db.database;
  const bool only_reads = query_integer(database, "PRAGMA query_only") != 0;
  database.exec(
      "PRAGMA query_only = OFF; CREATE VIRTUAL TABLE temp.fresh_text USING fts5(value);"
      "INSERT INTO temp.fresh_text (rowid, value) SELECT id, value FROM main.term;"
      "CREATE VIRTUAL TABLE temp.stored_words USING fts5vocab(main, term_text, instance);"
      "CREATE VIRTUAL TABLE temp.fresh_words USING fts5vocab(temp, fresh_text, instance)");
  if (only_reads) database.exec("PRAGMA query_only = ON");
  const auto differences = db.value<int64_t>(
      "SELECT count(*) FROM (SELECT * FROM (SELECT * FROM temp.stored_words EXCEPT SELECT * FROM "
      "temp.fresh_words) "
      "UNION ALL SELECT * FROM (SELECT * FROM temp.fresh_words EXCEPT SELECT * FROM temp.stored_words))");
  if (*differences > 0)
    problems.push_back(
        fmt::format("table term_text does not have the words of the terms ({} differ)", *differences));
  db.statements.clear();
  database.exec(
      "PRAGMA query_only = OFF; DROP TABLE temp.stored_words; DROP TABLE temp.fresh_words;"
      "DROP TABLE temp.fresh_text");
  if (only_reads) database.exec("PRAGMA query_only = ON");
}

void check_rule(Store::Connection& db, const Rule& rule, std::vector<std::string>& problems) {
  SQLite::Statement query(*db.database, rule.query);
  while (query.executeStep())
    problems.push_back(fmt::format(fmt::runtime(rule.problem), query.getColumn(0).getInt64()));
}

}  // namespace

VerifyReport Store::verify(Progress& progress) const {
  auto& db = *connection_;
  VerifyReport report;
  report.major = major();
  report.minor = minor();
  db.guarded([&] {
    progress.check(0, "checking the file");
    check_integrity(db, report.problems);
    check_blobs(db, progress, report.problems);
    check_feature_structures(db, report.problems);
    for (const Rule& rule : kRules) check_rule(db, rule, report.problems);
    for (std::string& problem : digest_problems(db)) report.problems.push_back(std::move(problem));
    check_rows(db, report.problems);
    check_configurations(db, report.problems);
    check_search_tables(db, report.problems);
    report.derived_problems = derived_problems(db);
    report.problems.insert(report.problems.end(), report.derived_problems.begin(),
                           report.derived_problems.end());
    for (const char* table : kReportedTables)
      report.counts.emplace_back(table,
                                 query_integer(*db.database, std::string("SELECT count(*) FROM ") + table));
  });
  return report;
}

}  // namespace loci::memory
