// What is forgotten on request: what must not be found afterwards.

#include <cmath>
#include "mapping/base/text/json.h"
#include "memory/store/erasure/erasure.h"

namespace loci::memory {

void Eraser::collect(const std::string& query) {
  change(fmt::format("INSERT OR IGNORE INTO temp.said {};", query));
}

void Eraser::collect_strings(const Json& json) {
  if (json.is_string())
    change("INSERT OR IGNORE INTO temp.said VALUES (?);", {sql(json.get_ref<const std::string&>())});
  if (json.is_structured())
    for (const Json& part : json) collect_strings(part);
}

void Eraser::collect_texts() {
  const std::string observation = is_gone("observation", "observation"), id = is_gone("id", "observation");
  collect(fmt::format("SELECT t.value FROM annotation a JOIN term t ON t.id = a.term WHERE {} OR {}",
                      "a." + observation, is_gone("a.scene", "scene")));
  collect(fmt::format("SELECT location FROM observation WHERE location IS NOT NULL AND {}", id));
  collect(fmt::format("SELECT value FROM fact WHERE value IS NOT NULL AND {}", is_gone("id", "fact")));
}

void Eraser::collect_numbers() {
  for (const char* column : {"x", "y"})
    for (const double number :
         db_.values<double>(fmt::format("SELECT DISTINCT {0} FROM observation WHERE {0} IS NOT NULL AND {1}",
                                        column, is_gone("id", "observation"))))
      if (std::round(number * 1e4) / 1e4 != number)  // of those that people type, others are the same
        result_.tokens.numbers.push_back(number);
}

void Eraser::remember_blobs() {
  change("INSERT OR IGNORE INTO temp.stored SELECT hash FROM blob;");
}

void Eraser::finish_tokens() {
  constexpr size_t kMinLength = 5;  // shorter ones occur by chance
  const std::string documents = stored_documents();
  for (const std::string& text : db_.values<std::string>("SELECT value FROM temp.said ORDER BY value"))
    if (text.size() >= kMinLength && documents.find(text) == std::string::npos && !is_said(text))
      result_.tokens.texts.push_back(text);
  drop_structured(result_.tokens.texts);
  result_.tokens.hashes = db_.values<std::string>(
      "SELECT hash FROM temp.stored WHERE hash NOT IN (SELECT hash FROM blob) ORDER BY hash");
  result_.erased["blob"] = static_cast<int64_t>(result_.tokens.hashes.size());
  std::erase_if(result_.tokens.numbers, [&](double number) {
    for (const char* table : {"observation", "belief", "event"})
      if (db_.value<Id>(fmt::format("SELECT id FROM {} WHERE x = ?1 OR y = ?1 LIMIT 1", table),
                        {sql(number)}))
        return true;
    return false;
  });
  std::erase_if(result_.erased, [](const auto& kind) { return kind.second == 0; });
  db_.statements.clear();
}

void Eraser::drop_structured(std::vector<std::string>& texts) {
  for (const Id id : db_.values<Id>("SELECT id FROM feature_structure ORDER BY id")) {
    if (texts.empty()) return;
    const std::string json = store_.feature_structure(id).json;
    std::erase_if(texts, [&](const std::string& text) { return json.find(text) != std::string::npos; });
  }
}

std::string Eraser::stored_documents() {
  std::string all;
  for (const Id blob : db_.values<Id>("SELECT urdf FROM map UNION SELECT sidecar FROM map WHERE sidecar IS "
                                      "NOT NULL UNION SELECT content FROM "
                                      "type_system"))
    all += store_.blob(blob).bytes;
  return all;
}

bool Eraser::is_said(const std::string& text) {
  return db_
      .value<int64_t>(
          "SELECT 1 FROM (SELECT value FROM term UNION ALL SELECT value FROM fact UNION ALL SELECT name "
          "FROM place UNION "
          "ALL SELECT class FROM place UNION ALL SELECT text FROM scene_log UNION ALL SELECT location FROM "
          "observation "
          "UNION ALL SELECT color FROM observation UNION ALL SELECT color FROM belief UNION ALL SELECT "
          "name FROM "
          "recording UNION ALL SELECT configuration FROM run UNION ALL SELECT program FROM run UNION ALL "
          "SELECT sql FROM "
          "sqlite_schema) WHERE instr(value, ?1) > 0 LIMIT 1",
          {sql(text)})
      .has_value();
}

}  // namespace loci::memory
