#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <initializer_list>
#include <set>
#include <string>
#include <vector>

#include "mapping/base/error.h"

namespace loci {

/// A YAML map that is read strictly: finish() refuses keys that were not asked for and names the closest
/// known key. Errors carry file, line and the path of the key.
class Config {
 public:
  /// Reads a file whose root is a map (an empty file is an empty map).
  static Config read(const std::filesystem::path& path);
  /// Parses text; `file` is for messages.
  static Config parse(const std::string& text, const std::string& file);

  bool has(const std::string& key) const;

  /// The value of a key that must be there.
  template <class T>
  T require(const std::string& key) const {
    const YAML::Node child = node_for(key);
    if (!child) throw Error("the key '" + key + "' is missing", location());
    return convert<T>(child, key);
  }

  /// The value of a key, or `fallback`.
  template <class T>
  T get(const std::string& key, const T& fallback) const {
    const YAML::Node child = node_for(key);
    return child ? convert<T>(child, key) : fallback;
  }

  /// A nested map; empty when the key is absent.
  Config map(const std::string& key) const;
  /// A nested list of maps; empty when the key is absent.
  std::vector<Config> list(const std::string& key) const;
  /// The names in this map, in the order of the file.
  std::vector<std::string> keys() const;

  /// The raw node of a key, for values that may take several forms (marks the key as known).
  YAML::Node node(const std::string& key) const { return node_for(key); }
  /// This map's own node.
  const YAML::Node& node() const { return node_; }

  /// Throws Error for the first key of this map that was not asked for.
  void finish() const;
  /// finish() for a map with these keys, before any of them is read: a misspelt key is also a missing one,
  /// and the message about the misspelling is the useful one.
  void refuse_other_keys(std::initializer_list<const char*> keys) const {
    known_.insert(keys.begin(), keys.end());
    finish();
  }

  /// Where this map begins; with a key, where that key's value is.
  FileLocation location(const std::string& key = {}) const;

  /// A Config over a node of this file, for lists and variants. `path` is the key path for messages.
  Config over(const YAML::Node& node, const std::string& path) const { return {node, file_, path}; }

 private:
  Config(const YAML::Node& node, std::string file, std::string path);
  YAML::Node node_for(const std::string& key) const;

  template <class T>
  T convert(const YAML::Node& child, const std::string& key) const {
    try {
      return child.as<T>();
    } catch (const YAML::Exception&) {
      throw Error("this value cannot be read", location(key), expected<T>());
    }
  }
  template <class T>
  static std::string expected() {
    if constexpr (std::is_same_v<T, bool>) return "expected true or false";
    if constexpr (std::is_integral_v<T>) return "expected a whole number";
    if constexpr (std::is_floating_point_v<T>) return "expected a number";
    return "expected another kind of value";
  }

  YAML::Node node_;
  std::string file_;
  std::string path_;
  mutable std::set<std::string> known_;
};

}  // namespace loci
