#include "memory/questions/names/taxonomy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mapping/base/config.h"
#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

constexpr const char* kProgram = "loci-memory taxonomy load";

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_text_list(const Json& value) {
  return value.is_array() && std::ranges::all_of(value, [](const Json& one) { return one.is_string(); });
}

}  // namespace

Taxonomy Taxonomy::read(const std::filesystem::path& path) {
  Taxonomy taxonomy;
  const Config file = Config::read(path);
  for (const std::string& name : file.keys()) {
    const Config entry = file.map(name);
    using Texts = std::vector<std::string>;
    taxonomy.concepts_[name] = {entry.get<Texts>("synonyms", {}), entry.get<Texts>("is", {}),
                                entry.get<Texts>("properties", {})};
    entry.finish();
  }
  if (taxonomy.concepts_.empty())
    throw Error("names no classes", {path.string(), 0, {}},
                "write NAME: {synonyms: [...], is: [...]} per class");
  taxonomy.check(path.string());
  return taxonomy;
}

void Taxonomy::check(const std::string& file) const {
  std::map<std::string, std::string> owner;
  for (const auto& [name, one] : concepts_) {
    owner.emplace(name, name);
    for (const std::string& synonym : one.synonyms)
      if (const auto [other, fresh] = owner.emplace(synonym, name); !fresh && other->second != name)
        throw Error(fmt::format("'{}' is a word for '{}' and for '{}'", synonym, other->second, name),
                    {file, 0, name}, "leave one of them out");
  }
  for (const auto& [name, one] : concepts_) {
    std::set<std::string> above;
    std::vector<std::string> open = one.kinds;
    while (!open.empty()) {
      const std::string kind = open.back();
      open.pop_back();
      if (kind == name)
        throw Error(fmt::format("'{}' is a kind of itself", name), {file, 0, name}, "break the cycle");
      if (!above.insert(kind).second) continue;
      if (const auto found = concepts_.find(kind); found != concepts_.end())
        open.insert(open.end(), found->second.kinds.begin(), found->second.kinds.end());
    }
  }
}

Taxonomy Taxonomy::of(const Store& store, const AsOf& as_of) {
  Taxonomy taxonomy;
  for (const RunRow& run : store.runs()) {
    if (run.program != kProgram || (as_of.known_at && run.started > *as_of.known_at)) continue;
    taxonomy.concepts_.clear();
    const Json concepts = parse_json(run.configuration, store.name());
    for (const auto& [name, one] : concepts.items()) {
      const auto texts = [&, &name = name, &one = one](const char* key) {
        if (!one.is_object() || !is_text_list(one.value(key, Json())))
          throw store.error(
              fmt::format("run {}, configuration: '{}' of '{}' is no list of texts", run.id, key, name),
              "loci-memory taxonomy replaces it");
        return one[key].get<std::vector<std::string>>();
      };
      taxonomy.concepts_[name] = {texts("synonyms"), texts("is"), texts("properties")};
    }
  }
  return taxonomy;
}

void Taxonomy::save(Store& store) const {
  store.finish_run(store.begin_run(kProgram, to_json(*this).dump()));
}

std::string Taxonomy::concept_of(const std::string& word) const {
  for (const auto& [name, one] : concepts_)
    if (name == word || contains(one.synonyms, word)) return name;
  return {};
}

std::set<std::string> Taxonomy::meanings(const std::string& word) const {
  std::set<std::string> result = {word};
  std::vector<std::string> open = {word};
  if (word.size() > 3 && word.ends_with('s')) open.push_back(word.substr(0, word.size() - 1));
  if (word.size() > 4 && word.ends_with("es")) open.push_back(word.substr(0, word.size() - 2));
  result.insert(open.begin(), open.end());
  while (!open.empty()) {
    const std::string next = open.back();
    open.pop_back();
    const std::string own = concept_of(next);
    const auto take = [&](const std::string& name) {
      if (result.insert(name).second) open.push_back(name);
    };
    if (!own.empty()) {
      take(own);
      for (const std::string& synonym : concepts_.at(own).synonyms) result.insert(synonym);
    }
    for (const auto& [name, one] : concepts_)
      if (contains(one.kinds, next) || contains(one.properties, next)) take(name);
  }
  return result;
}

Json to_json(const Taxonomy& taxonomy) {
  Json json = Json::object();
  for (const auto& [name, one] : taxonomy.concepts())
    json[name] = {{"synonyms", one.synonyms}, {"is", one.kinds}, {"properties", one.properties}};
  return json;
}

std::string to_text(const Taxonomy& taxonomy) {
  if (taxonomy.concepts().empty()) return "No taxonomy is known.\n";
  std::string text;
  for (const auto& [name, one] : taxonomy.concepts()) {
    text += name;
    if (!one.synonyms.empty()) text += fmt::format(" ({})", fmt::join(one.synonyms, ", "));
    if (!one.kinds.empty()) text += fmt::format(", a kind of {}", fmt::join(one.kinds, ", "));
    if (!one.properties.empty()) text += fmt::format(": {}", fmt::join(one.properties, ", "));
    text += "\n";
  }
  return text;
}

}  // namespace loci::memory
