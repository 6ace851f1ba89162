#include "apps/evaluate/questions/table.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "mapping/base/config.h"
#include "mapping/base/files.h"

namespace loci::apps::questions {
namespace {

/// A value or a list of them.
std::vector<std::string> any_of(const Config& row, const std::string& key) {
  const YAML::Node node = row.node(key);
  if (!node) return {};
  if (node.IsSequence()) return row.require<std::vector<std::string>>(key);
  return {row.require<std::string>(key)};
}

template <class T>
std::optional<std::pair<T, T>> range(const Config& row, const std::string& key) {
  if (!row.has(key)) return std::nullopt;
  const auto values = row.require<std::vector<T>>(key);
  if (values.size() != 2) throw Error("expected the first and the last value", row.location(key));
  return std::pair(values[0], values[1]);
}

AskedQuestion read_row(const Config& row) {
  AskedQuestion asked{.memory = row.require<std::string>("memory"),
                      .sentence = row.require<std::string>("ask")};
  asked.line = static_cast<int>(row.location().line);
  asked.after = any_of(row, "after");
  asked.verdict = any_of(row, "verdict");
  if (row.has("number")) asked.number = row.require<size_t>("number");
  asked.place = any_of(row, "place");
  for (const char* key : {"objects", "places"})
    if (row.has(key))
      (key[0] == 'o' ? asked.objects : asked.places) = row.require<std::vector<std::string>>(key);
  asked.time = range<std::string>(row, "time");
  asked.duration = range<std::string>(row, "duration");
  asked.probability = range<double>(row, "probability");
  asked.text = any_of(row, "text");
  asked.reason = row.get<std::string>("reason", "");
  asked.answer = any_of(row, "answer");
  for (const std::string& other : any_of(row, "or")) asked.answer.push_back(other);
  constexpr std::array<std::string_view, 7> kAnswers = {"unknown", "gone", "not known",   "not understood",
                                                        "yes",     "no",   "not observed"};
  for (const std::string& answer : asked.answer)
    if (std::ranges::find(kAnswers, answer) == kAnswers.end())
      throw Error("the answer '" + answer + "' is none of those that a table can expect",
                  row.location(row.has("or") ? "or" : "answer"));
  row.finish();
  return asked;
}

}  // namespace

std::vector<AskedQuestion> read_table(const std::filesystem::path& file) {
  // A list at the root: the strict reader takes maps.
  const Config root = Config::parse("questions:\n" + read_file(file), file.string());
  std::vector<AskedQuestion> table;
  for (const Config& row : root.list("questions")) {
    table.push_back(read_row(row));
    --table.back().line;  // that of the key above
  }
  return table;
}

}  // namespace loci::apps::questions
