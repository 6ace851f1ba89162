#include "mapping/base/config.h"

#include <fmt/format.h>

#include <map>

#include "mapping/base/files.h"
#include "mapping/base/text/text.h"

namespace loci {
namespace {

// Far beyond what people write; aliases that expand to more are an attack.
constexpr int kMaxDepth = 64;
constexpr size_t kMaxNodes = 2'000'000;

/// Refuses a document that is too deep or, with its aliases expanded, too large, or whose keys are no names
/// or stand twice in one map.
void check_size(const YAML::Node& node, const std::string& file, int depth, size_t& nodes) {
  const FileLocation place{file, node.Mark().is_null() ? 0 : node.Mark().line + 1, {}};
  if (depth > kMaxDepth) throw Error(fmt::format("more than {} levels deep", kMaxDepth), place);
  if (++nodes > kMaxNodes)
    throw Error(fmt::format("more than {} values, aliases expanded", kMaxNodes), place);
  if (node.IsSequence())
    for (const auto& item : node) check_size(item, file, depth + 1, nodes);
  if (!node.IsMap()) return;
  std::map<std::string, int> lines;
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) throw Error("a key is not a name", place);
    const int line = entry.first.Mark().is_null() ? 0 : entry.first.Mark().line + 1;
    const auto [first, added] = lines.emplace(entry.first.Scalar(), line);
    if (!added)
      throw Error(fmt::format("the key '{}' stands twice, first in line {}", first->first, first->second),
                  {file, line, {}}, "remove one of them");
    check_size(entry.second, file, depth + 1, nodes);
  }
}

}  // namespace

Config Config::read(const std::filesystem::path& path) {
  return parse(read_file(path), path.string());
}

Config Config::parse(const std::string& text, const std::string& file) {
  try {
    YAML::Node node = YAML::Load(text);
    if (!node || node.IsNull()) node = YAML::Node(YAML::NodeType::Map);
    size_t nodes = 0;
    check_size(node, file, 0, nodes);
    return {node, file, {}};
  } catch (const YAML::Exception& error) {
    const bool is_map_below_value = error.msg == YAML::ErrorMsg::MAP_VALUE;
    throw Error("not valid YAML: " + error.msg, {file, error.mark.is_null() ? 0 : error.mark.line + 1, {}},
                is_map_below_value ? "a name with keys below it needs a value of its own: 'Name: {}'" : "");
  }
}

Config::Config(const YAML::Node& node, std::string file, std::string path)
    : node_(node), file_(std::move(file)), path_(std::move(path)) {
  if (node_ && !node_.IsMap())
    throw Error("a map of keys and values was expected here", {file_, node_.Mark().line + 1, path_});
}

YAML::Node Config::node_for(const std::string& key) const {
  known_.insert(key);
  const YAML::Node& node = node_;  // The const operator[] does not insert.
  YAML::Node child = node[key];
  return child && child.IsNull() ? YAML::Node(YAML::NodeType::Undefined) : child;
}

bool Config::has(const std::string& key) const {
  return static_cast<bool>(node_for(key));
}

Config Config::map(const std::string& key) const {
  const YAML::Node child = node_for(key);
  return {child ? child : YAML::Node(YAML::NodeType::Map), file_, location(key).key};
}

std::vector<Config> Config::list(const std::string& key) const {
  std::vector<Config> result;
  const YAML::Node child = node_for(key);
  if (!child) return result;
  if (!child.IsSequence()) throw Error("a list was expected here", location(key));
  for (size_t i = 0; i < child.size(); ++i)
    result.push_back(Config(child[i], file_, location(key).key + "[" + std::to_string(i) + "]"));
  return result;
}

std::vector<std::string> Config::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : node_) names.push_back(entry.first.as<std::string>());
  return names;
}

void Config::finish() const {
  const std::vector<std::string> candidates(known_.begin(), known_.end());
  for (const auto& entry : node_) {
    const auto key = entry.first.as<std::string>();
    if (known_.contains(key)) continue;
    const std::string nearest = did_you_mean(key, candidates);
    throw Error("unknown key '" + key + "'", {file_, entry.first.Mark().line + 1, path_},
                !nearest.empty() || candidates.empty() ? nearest : "known are " + joined(candidates, ", "));
  }
}

FileLocation Config::location(const std::string& key) const {
  FileLocation result{file_, node_ && !node_.Mark().is_null() ? node_.Mark().line + 1 : 0, path_};
  if (key.empty()) return result;
  const YAML::Node& node = node_;
  if (const YAML::Node child = node[key]; child && !child.Mark().is_null())
    result.line = child.Mark().line + 1;
  result.key = path_.empty() ? key : path_ + "." + key;
  return result;
}

}  // namespace loci
