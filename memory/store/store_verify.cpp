#include <fmt/format.h>

#include "mapping/base/hash.h"
#include "mapping/base/json.h"
#include "memory/store/database.h"

namespace loci {
namespace {

/// A query that finds what must not be; its first column is shown.
struct Rule {
  const char* sentence;
  const char* query;
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
     "(SELECT 1 FROM forgotten f WHERE f.object = o.id)"},
    {"belief {} is missing among the stays",
     "SELECT b.id FROM belief b WHERE b.x IS NOT NULL AND NOT EXISTS (SELECT 1 FROM stay s WHERE s.belief = "
     "b.id)"},
    {"object {} is missing under a word that it was called",
     "SELECT DISTINCT a.object FROM association a JOIN annotation n ON n.scene = a.scene AND n.observation = "
     "a.observation WHERE a.chosen = 1 AND a.probability > 0 AND a.object IS NOT NULL AND NOT EXISTS (SELECT "
     "1 FROM "
     "object_term t WHERE t.term = n.term AND t.object = a.object)"},
    {"scene {} has a depth thumbnail without its size",
     "SELECT id FROM scene WHERE depth IS NOT NULL AND (depth_width IS NULL OR depth_height IS NULL)"},
};

constexpr const char* kTables[] = {"run",         "recording",   "map",        "place",
                                   "scene",       "observation", "annotation", "feature_structure",
                                   "type_system", "blob",        "object",     "association",
                                   "event",       "belief",      "visibility", "fact"};

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
    const bool earlier = s.version < 1001;
    for (const Rule& rule : kRules) {
      if (earlier && std::string_view(rule.query).find("forgotten") != std::string_view::npos) continue;
      if (earlier && std::string_view(rule.sentence).find("is missing") != std::string_view::npos) continue;
      SQLite::Statement query(*s.database, rule.query);
      while (query.executeStep())
        report.problems.push_back(fmt::format(fmt::runtime(rule.sentence), query.getColumn(0).getInt64()));
    }
    for (const char* table : kTables)
      report.counts.emplace_back(
          table, s.database->execAndGet(fmt::format("SELECT count(*) FROM {}", table)).getInt64());
  });
  return report;
}

}  // namespace loci
